#include "apps/data_set/bop_writer.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/bop_masks.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/json_file.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

FrameRecord full_record(int id) {
    FrameRecord record;
    record.id = id;
    record.camera = {4, 3, 500.1, 501.2, 1.53, 1.04};
    record.depth_scale_mm = 0.1;
    record.camera_from_world = exp((Twist() << 0.1 * id, 0.2, 0.3, 0.4, 0.5, 0.6).finished());
    record.timestamp_s = 1305031098.6659 + id;
    ObjectTruth truth;
    truth.object_id = 7;
    truth.camera_from_object = exp((Twist() << 1.1, 0.2, -0.3 * id, 0.04, 0.05, 0.3).finished());
    truth.silhouette_pixels = 40;
    truth.visible_pixels = 10;
    truth.measured_pixels = 9;
    truth.silhouette_box = {-2, -1, 8, 5};
    record.objects = {truth};
    return record;
}

TEST(BopWriter, AWholeSceneComesBack) {
    const fs::path scene_folder = new_folder() / "set" / "test" / "000002";
    const DepthImage depth{4, 3, std::vector<float>(12, 0.25F)};
    Mask mask{4, 3, std::vector<std::uint8_t>(12, 0)};
    mask.value[5] = 1;
    BopSceneWriter writer(scene_folder);
    for (const int id : {3, 11}) {
        FrameRecord record = full_record(id);
        record.objects[0].visible_box = box_of(mask);
        writer.add_frame(record, depth, {mask}, {mask});
    }
    EXPECT_FALSE(fs::exists(scene_folder / "scene_camera.json"));  // not before it is whole
    writer.finish();

    const BopScene scene = open_scene(scene_folder);
    EXPECT_EQ(scene.id, 2);
    ASSERT_EQ(scene.frames.size(), 2U);
    const FrameRecord expected = full_record(11);
    const Frame& frame = scene.frames[1];
    EXPECT_EQ(frame.id, 11);
    EXPECT_EQ(frame.camera.fx, 500.1);
    EXPECT_EQ(frame.camera.cy, 1.04);
    EXPECT_EQ(frame.depth_scale_mm, 0.1);
    EXPECT_EQ(frame.stamp_s, *expected.timestamp_s);
    EXPECT_LT(log(frame.camera_from_world->inverse() * *expected.camera_from_world).norm(), 1e-12);
    EXPECT_FLOAT_EQ(load_depth(frame).depth_m[3], 0.25F);
    const Mask read = *MaskSource(scene, 7).load(frame).mask;
    EXPECT_EQ(read.value[5], 255);
    EXPECT_EQ(read.value[4], 0);
    EXPECT_TRUE(fs::exists(mask_path(scene_folder, 11, 0, false)));
    const Pose truth = read_ground_truth(scene_folder, 7).at(11);
    EXPECT_LT(log(truth.inverse() * expected.objects[0].camera_from_object).norm(), 1e-12);
    EXPECT_EQ(read_camera_json(camera_json_path(scene_folder)).depth_scale_mm, 0.1);
}

TEST(BopWriter, TruthInfoAndTargetsHaveTheToolkitsKeys) {
    const fs::path folder = new_folder();
    FrameRecord record = full_record(3);
    record.objects.push_back({});
    write_scene_gt_info(folder / "scene_gt_info.json", {record});
    const JsonFile info(folder / "scene_gt_info.json");
    const JsonValue object = info.root().at("3").elements().at(0);
    EXPECT_EQ(object.at("px_count_all").integer(), 40);
    EXPECT_EQ(object.at("px_count_valid").integer(), 9);
    EXPECT_EQ(object.at("px_count_visib").integer(), 10);
    EXPECT_EQ(object.at("visib_fract").number(), 0.25);
    EXPECT_EQ(object.at("bbox_obj").numbers(), (std::vector<double>{-2, -1, 8, 5}));
    EXPECT_EQ(object.at("bbox_visib").numbers(), (std::vector<double>{-1, -1, -1, -1}));
    EXPECT_EQ(info.root().at("3").elements().at(1).at("visib_fract").number(), 0.0);  // of nothing, nothing

    write_test_targets(folder / "targets.json", {{1, 2, 3, 4}, {5, 6, 7, 8}});
    const JsonFile targets(folder / "targets.json");
    ASSERT_EQ(targets.root().elements().size(), 2U);
    const JsonValue target = targets.root().elements()[0];
    EXPECT_EQ(target.at("scene_id").integer(), 1);
    EXPECT_EQ(target.at("im_id").integer(), 2);
    EXPECT_EQ(target.at("obj_id").integer(), 3);
    EXPECT_EQ(target.at("inst_count").integer(), 4);
}

TEST(BopWriter, ABoxHoldsItsPixels) {
    Mask mask{5, 4, std::vector<std::uint8_t>(20, 0)};
    EXPECT_EQ(box_of(mask).width, -1);
    mask.value[1 * 5 + 3] = 1;
    mask.value[2 * 5 + 1] = 1;
    const BopBox box = box_of(mask);
    EXPECT_EQ(box.u, 1);
    EXPECT_EQ(box.v, 1);
    EXPECT_EQ(box.width, 2);  // from pixel to pixel, as bop_toolkit's calc_2d_bbox
    EXPECT_EQ(box.height, 1);
}

TEST(BopWriter, MixedAndImpossibleScenesAreRefused) {
    const fs::path set = new_folder();
    const fs::path scene = write_small_scene(set);
    expect_error([&] { BopSceneWriter writer(scene); }, {"000005", "a scene already"});
    BopSceneWriter writer(set / "test" / "000006");
    FrameRecord record = full_record(0);
    record.camera.width = 5;
    expect_error([&] { writer.add_frame(record); }, {"camera.json", "another image size"});
    writer.add_frame(full_record(0));
    EXPECT_THROW(writer.add_frame(full_record(0)), std::invalid_argument);
    EXPECT_THROW(writer.add_frame(full_record(1), DepthImage{3, 3, std::vector<float>(9)}), std::invalid_argument);
    EXPECT_THROW(BopSceneWriter(set / "test" / "000007").finish(), std::invalid_argument);
    FrameRecord bad = full_record(1);
    bad.camera_from_world->translation.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(write_scene_camera(set / "a.json", {bad}), std::invalid_argument);
    EXPECT_FALSE(fs::exists(set / "a.json"));
    expect_error([] { write_scene_camera("/dev/full", {full_record(1)}); }, {"/dev/full", "No space left"});
}

TEST(BopWriter, ADecimalCommaChangesNothing) {
    const CommaLocale locale;
    if (!locale.ok()) GTEST_SKIP() << "no locale with a decimal comma on this machine";
    const fs::path scene = write_small_scene(new_folder());
    EXPECT_EQ(open_scene(scene).frames[0].camera.cy, 1.25);
    EXPECT_EQ(read_camera_json(camera_json_path(scene)).depth_scale_mm, 0.5);
}

}  // namespace
}  // namespace nearpose::data_set
