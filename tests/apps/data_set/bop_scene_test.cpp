#include "apps/data_set/bop_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/bop_writer.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/png_file.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

const std::string kK = R"("cam_K": [500, 0, 1.5, 0, 501, 1.25, 0, 0, 1], "depth_scale": 0.5)";

Pose turned(double angle_rad, const Eigen::Vector3d& translation_m) {
    const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 3).normalized();
    return {Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis)), translation_m};
}

double distance(const Pose& a, const Pose& b) {
    return log(a.inverse() * b).norm();
}

class Scene : public testing::Test {
  protected:
    const fs::path scene_ = write_small_scene(new_folder());

    void set_camera(const std::string& json) { write_text(scene_ / "scene_camera.json", json); }
    void expect_refused(const std::string& json, const std::vector<std::string>& parts) {
        set_camera(json);
        expect_error([&] { open_scene(scene_); }, parts);
    }
};

TEST_F(Scene, FramesHaveWhatTheFilesSay) {
    const BopScene scene = open_scene(scene_);
    EXPECT_EQ(scene.id, 5);
    ASSERT_EQ(scene.frames.size(), 3U);
    const Frame& frame = scene.frames[2];
    EXPECT_EQ(frame.id, 2);
    EXPECT_EQ(frame.camera.width, 4);
    EXPECT_EQ(frame.camera.height, 3);
    EXPECT_EQ(frame.camera.fy, 501.0);
    EXPECT_EQ(frame.camera.cy, 1.25);
    EXPECT_EQ(frame.depth_scale_mm, 0.5);
    EXPECT_DOUBLE_EQ(frame.stamp_s, 2.0 / 30.0);
    EXPECT_FALSE(frame.camera_from_world);
    EXPECT_FALSE(now_from_before(scene.frames[1], scene.frames[0]));
    EXPECT_FLOAT_EQ(load_depth(frame).depth_m[0], 0.0015F);  // 3 counts of 0.5 mm
}

TEST_F(Scene, FramesAreInNumericOrderAndTakenByNumber) {
    set_camera("{\"10\": {" + kK + "}, \"9\": {" + kK + "}, \"2\": {" + kK + "}}");
    const BopScene scene = open_scene(scene_);
    ASSERT_EQ(scene.frames.size(), 3U);
    EXPECT_EQ(scene.frames[0].id, 2);
    EXPECT_EQ(scene.frames[1].id, 9);
    EXPECT_EQ(scene.frames[2].id, 10);
    EXPECT_EQ(scene.frames[2].depth.filename(), "000010.png");
    SceneOptions options;
    options.first_frame = 3;
    options.last_frame = 9;
    ASSERT_EQ(open_scene(scene_, options).frames.size(), 1U);
    options.last_frame = 8;
    expect_error([&] { open_scene(scene_, options); }, {"scene_camera.json", "no frame"});
}

TEST_F(Scene, TheSceneNumberIsTheFoldersOrIsGiven) {
    EXPECT_EQ(open_scene(scene_ / ".").id, 5);
    const fs::path named = scene_.parent_path() / "approach";
    fs::rename(scene_, named);
    const BopScene scene = open_scene(named);
    EXPECT_EQ(scene.id, 0);
    ASSERT_EQ(scene.notices.all().size(), 1U);
    EXPECT_NE(to_text(scene.notices.all()[0]).find("--scene-id"), std::string::npos);
    SceneOptions options;
    options.scene_id = 7;
    EXPECT_EQ(open_scene(named, options).id, 7);
}

TEST_F(Scene, StampsComeFromTheFileOrFromTheFrameRate) {
    SceneOptions options;
    options.frames_per_second = 10.0;
    EXPECT_DOUBLE_EQ(open_scene(scene_, options).frames[2].stamp_s, 0.2);
    set_camera("{\"0\": {" + kK + ", \"timestamp\": 12.5}, \"1\": {" + kK + ", \"timestamp\": 12.75}}");
    const BopScene scene = open_scene(scene_);
    EXPECT_TRUE(scene.has_timestamps);
    EXPECT_TRUE(scene.time_notices.all().empty());
    EXPECT_EQ(scene.frames[1].stamp_s, 12.75);
}

TEST_F(Scene, TheControlTakesThenToNow) {
    // A point fixed in the world, seen in both frames: the control maps its older coordinates to its newer ones.
    const Pose before = turned(0.3, {0.1, 0.2, 0.3});
    const Pose now = turned(-0.2, {0.0, -0.1, 0.5});
    std::vector<FrameRecord> records(2);
    for (int i = 0; i < 2; ++i) {
        records[static_cast<std::size_t>(i)].id = i;
        records[static_cast<std::size_t>(i)].camera = {4, 3, 500.0, 500.0, 1.5, 1.0};
        records[static_cast<std::size_t>(i)].camera_from_world = i == 0 ? before : now;
    }
    write_scene_camera(scene_ / "scene_camera.json", records);
    const BopScene scene = open_scene(scene_);
    const std::optional<Pose> control = now_from_before(scene.frames[1], scene.frames[0]);
    ASSERT_TRUE(control);
    const Eigen::Vector3d point_in_world(0.4, -0.7, 1.1);
    EXPECT_LT((*control * (before * point_in_world) - now * point_in_world).norm(), 1e-14);
}

TEST_F(Scene, MotionIsInMillimetresAndRowMajor) {
    set_camera("{\"0\": {" + kK + R"(, "cam_R_w2c": [0, -1, 0, 1, 0, 0, 0, 0, 1], "cam_t_w2c": [1000, 0, 0]}})");
    const Frame frame = open_scene(scene_).frames[0];
    EXPECT_LT((*frame.camera_from_world * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
}

TEST_F(Scene, BadCamerasAreRefusedByName) {
    expect_refused("{\"7\": {\"depth_scale\": 1}}", {"scene_camera.json", "7", "no intrinsics", "cam_K"});
    expect_refused(R"({"7": {"cam_K": [500, 0, 0, 0, 500, 0, 1.5, 1.2, 1], "depth_scale": 1}})",
                   {"7/cam_K", "column-major"});
    expect_refused(R"({"7": {"cam_K": [-5, 0, 1, 0, 5, 1, 0, 0, 1], "depth_scale": 1}})", {"7/cam_K", "focal"});
    expect_refused(R"({"7": {"cam_K": [5, 0, 1, 0, 5, 1, 0, 0, 1], "depth_scale": 0}})", {"7/depth_scale", "positive"});
    expect_refused("{\"7\": {" + kK + ", \"dist_coeffs\": [0, 0.1]}}", {"7/dist_coeffs", "distortion"});
    expect_refused("{\"7\": ", {"scene_camera.json", "not JSON"});
    expect_refused("{}", {"scene_camera.json", "no frame"});
    fs::remove(scene_ / "scene_camera.json");
    expect_error([&] { open_scene(scene_); }, {"scene_camera.json", "No such file"});
    expect_error([&] { open_scene(scene_ / "none"); }, {"none", "not a folder"});
}

TEST_F(Scene, ABrokenImageConcernsItsFrameOnly) {
    write_text(depth_path(scene_, 0), "\x89PNG");
    write_count_png(depth_path(scene_, 2), {3, 3, std::vector<std::uint16_t>(9, 1)});
    for (const bool has_camera_json : {true, false}) {
        if (!has_camera_json) fs::remove(camera_json_path(scene_));
        const BopScene scene = open_scene(scene_);
        expect_error([&] { load_depth(scene.frames[0]); }, {"000000.png"});
        EXPECT_EQ(load_depth(scene.frames[1]).width, 4);
        expect_error([&] { load_depth(scene.frames[2]); }, {"000002.png", "3 x 3", "4 x 3"});
    }
    fs::remove(depth_path(scene_, 0));
    expect_error([&] { load_depth(open_scene(scene_).frames[0]); }, {"000000.png", "No such file"});
}

TEST_F(Scene, TheImageSizeIsTheCamerasOrTheUsualOne) {
    write_count_png(depth_path(scene_, 0), {3, 3, std::vector<std::uint16_t>(9, 1)});
    fs::remove(camera_json_path(scene_));
    EXPECT_EQ(open_scene(scene_).frames[0].camera.width, 4);  // most images have 4 x 3
    write_camera_json(camera_json_path(scene_), {8, 6, 1.0, 1.0, 0.0, 0.0}, 1.0);
    expect_error([&] { open_scene(scene_); }, {"camera.json", "8 x 6", "4 x 3"});
    fs::remove(camera_json_path(scene_));
    for (int id = 0; id < 3; ++id) fs::remove(depth_path(scene_, id));
    expect_error([&] { open_scene(scene_); }, {"depth", "image size"});
}

TEST_F(Scene, GroundTruthComesBack) {
    std::vector<FrameRecord> records(2);
    records[1].id = 4;
    records[1].objects.resize(2);
    records[1].objects[1].object_id = 9;
    records[1].objects[1].camera_from_object = turned(2.0, {0.01, 0.02, 0.3});
    write_scene_gt(scene_ / "scene_gt.json", records);
    const std::map<int, Pose> truth = read_ground_truth(scene_, 9);
    ASSERT_EQ(truth.size(), 1U);
    EXPECT_LT(distance(truth.at(4), records[1].objects[1].camera_from_object), 1e-12);
    expect_error([&] { read_ground_truth(scene_, 3); }, {"scene_gt.json", "object 3"});

    // Of two copies the first counts, or the one that is asked for.
    records[1].objects.push_back(records[1].objects[1]);
    records[1].objects[2].camera_from_object = turned(1.0, {0.05, 0.0, 0.4});
    records[1].objects[2].silhouette_pixels = 8;
    records[1].objects[2].visible_pixels = 2;
    write_scene_gt(scene_ / "scene_gt.json", records);
    write_scene_gt_info(scene_ / "scene_gt_info.json", records);
    const auto pose_at = [&](std::optional<int> index) { return read_ground_truth(scene_, 9, index).at(4); };
    EXPECT_LT(distance(pose_at({}), records[1].objects[1].camera_from_object), 1e-12);
    EXPECT_LT(distance(pose_at(2), records[1].objects[2].camera_from_object), 1e-12);
    EXPECT_EQ(read_visible_fractions(scene_, 9, 2).at(4), 0.25);
    expect_error([&] { read_ground_truth(scene_, 9, 0); }, {"scene_gt.json", "object 9 at index 0"});  // another part
    expect_error([&] { read_ground_truth(scene_, 9, 3); }, {"scene_gt.json", "object 9 at index 3"});
}

TEST(CameraJson, ComesBack) {
    const fs::path file = new_folder() / "camera.json";
    const PinholeCamera camera{640, 480, 476.0536193848, 476.0534973145, 311.4845581055, 246.2832336426};
    write_camera_json(file, camera, 0.124987);
    const CameraFile back = read_camera_json(file);
    EXPECT_EQ(back.camera.fx, camera.fx);
    EXPECT_EQ(back.camera.fy, camera.fy);
    EXPECT_EQ(back.camera.cx, camera.cx);
    EXPECT_EQ(back.camera.cy, camera.cy);
    EXPECT_EQ(back.camera.width, 640);
    EXPECT_EQ(back.camera.height, 480);
    EXPECT_EQ(back.depth_scale_mm, 0.124987);
}

TEST(CameraJson, TakesAMatrixAndRefusesWhatItCannotUse) {
    const fs::path file = new_folder() / "camera.json";
    const auto refused = [&](const std::string& json, const std::vector<std::string>& parts) {
        write_text(file, json);
        expect_error([&] { read_camera_json(file); }, parts);
    };
    write_text(file,
               R"({"cam_K": [500, 0, 320, 0, 501, 240, 0, 0, 1], "width": 640, "height": 480, "D": [0, 0, 0, 0, 0]})");
    EXPECT_EQ(read_camera_json(file).camera.fy, 501.0);
    EXPECT_FALSE(read_camera_json(file).depth_scale_mm);
    refused(R"({"width": 640, "height": 480})", {"camera.json", "no intrinsics"});
    refused(R"({"fx": 5, "fy": 5, "cx": 1, "cy": 1, "height": 480})", {"camera.json", "width"});
    refused(R"({"fx": 5, "fy": 5, "cx": 1, "cy": 1, "width": 20000, "height": 480})", {"camera.json", "16384"});
    refused(R"({"fx": 0, "fy": 5, "cx": 1, "cy": 1, "width": 2, "height": 4})", {"camera.json", "fx"});
    refused(R"({"fx": 5, "fy": 5, "cx": 1, "cy": 1, "width": 2, "height": 4, "k1": 0.01})", {"k1", "distortion"});
    refused(R"({"fx": 6, "cam_K": [5, 0, 1, 0, 5, 1, 0, 0, 1], "width": 2, "height": 4})", {"fx", "contradicts"});
}

}  // namespace
}  // namespace nearpose::data_set
