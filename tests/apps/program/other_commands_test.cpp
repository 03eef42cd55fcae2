// render, evaluate and import, run as a user would.
#include <gtest/gtest.h>

#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/data_set/result_csv.hpp"
#include "tests/apps/program/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::string render(const TinyScene& scene, const std::string& pose) {
    return "render --model " + (scene.models() / "obj_000001.ply").string() + " --camera " +
           scene.file("camera.json").string() + " --pose " + scene.file(pose).string() + " --out " +
           scene.file("depth.png").string();
}

TEST(Render, GivesTheDepthOfThePose) {
    const TinyScene scene(1);
    write_pose(scene.file("pose.json"), scene.truth()[0]);
    const Outcome outcome = run_nearpose(render(scene, "pose.json"));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto expected = data_set::read_count_png(scene.scene() / "depth/000000.png");
    const auto rendered = data_set::read_count_png(scene.file("depth.png"));
    ASSERT_EQ(rendered.counts.size(), expected.counts.size());
    int differing = 0;  // by more than a rounding; a ray along an edge may fall to either side
    for (std::size_t i = 0; i < rendered.counts.size(); ++i) {
        if (std::abs(rendered.counts[i] - expected.counts[i]) > 1) ++differing;
    }
    EXPECT_LE(differing, 3);
}

TEST(Render, SaysWhatIsWrong) {
    const TinyScene scene(1);
    write_text(scene.file("pose.json"), R"({"cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 2], "cam_t_m2c": [0, 0, 400]})");
    const Outcome skewed = run_nearpose(render(scene, "pose.json"));
    EXPECT_EQ(skewed.exit_code, 1);
    EXPECT_TRUE(contains(skewed.err, "pose.json") && contains(skewed.err, "cam_R_m2c")) << skewed.err;
    write_pose(scene.file("far.json"), {Eigen::Quaterniond::Identity(), {0.0, 0.0, 8.0}});
    const Outcome far = run_nearpose(render(scene, "far.json"));
    EXPECT_EQ(far.exit_code, 1);
    EXPECT_TRUE(contains(far.err, "depth_scale")) << far.err;
    write_pose(scene.file("behind.json"), {Eigen::Quaterniond::Identity(), {0.0, 0.0, -1.0}});
    const Outcome behind = run_nearpose(render(scene, "behind.json"));
    EXPECT_EQ(behind.exit_code, 0);
    EXPECT_TRUE(contains(behind.err, "not in view")) << behind.err;
}

std::string evaluate(const TinyScene& scene) {
    return "evaluate --scene " + scene.scene().string() + " --models " + scene.models().string() +
           " --object 1 --burn-in 0 --results " + scene.file("poses.csv").string() + " ";
}

// Writes the true poses, each moved by `offset` along the camera's x axis; frame 1 is left out.
void write_results(const TinyScene& scene, int scene_id, double offset_m) {
    data_set::PoseCsvWriter writer(scene.file("poses.csv"));
    for (const int frame : {0, 2, 3}) {
        Pose pose = scene.truth()[frame];
        pose.translation.x() += offset_m;
        writer.append({scene_id, frame, 1, 0.9, pose, 0.01});
    }
    writer.close();
}

TEST(Evaluate, MeasuresWhatWasPutIn) {
    const TinyScene scene(4);
    write_results(scene, 7, 0.002);
    const Outcome outcome = run_nearpose(evaluate(scene) + "--out " + scene.file("table.csv").string() + " --plot " +
                                         scene.file("error.png").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "4 frames, 1 without a pose")) << outcome.out;
    EXPECT_TRUE(contains(outcome.out, "translation [mm]       2.000     2.000     2.000     2.000")) << outcome.out;
    EXPECT_TRUE(contains(outcome.out, "first in frame 0, for good from frame 2 on")) << outcome.out;
    EXPECT_EQ(lines_of(read_text(scene.file("table.csv")))[1], "0,2.0000,0.0000");
    EXPECT_EQ(lines_of(read_text(scene.file("table.csv")))[2], "1,,");
    EXPECT_EQ(data_set::read_png_size(scene.file("error.png")).width, 1000);
    EXPECT_EQ(run_nearpose(evaluate(scene) + "--out -").out, read_text(scene.file("table.csv")));
}

TEST(Evaluate, SaysWhatIsWrong) {
    const TinyScene scene(4);
    write_results(scene, 8, 0.0);
    const Outcome other = run_nearpose(evaluate(scene));
    EXPECT_EQ(other.exit_code, 1);
    EXPECT_TRUE(contains(other.err, "no row of scene 7, but of scene 8")) << other.err;
    EXPECT_EQ(run_nearpose(evaluate(scene) + "--scene-id 8").exit_code, 0);
    write_text(scene.file("poses.csv"), "scene_id,im_id,obj_id,score,R,t,time\n7,0,1,nan,1 0 0 0 1 0 0 0 1,0 0 1,1\n");
    EXPECT_EQ(run_nearpose(evaluate(scene)).exit_code, 1);
    write_results(scene, 7, 0.0);
    std::filesystem::remove(scene.scene() / "scene_gt.json");
    const Outcome no_truth = run_nearpose(evaluate(scene));
    EXPECT_EQ(no_truth.exit_code, 1);
    EXPECT_TRUE(contains(no_truth.err, "scene_gt.json")) << no_truth.err;
}

TEST(Import, AModelBecomesABopModel) {
    const TinyScene scene(1);
    const Outcome outcome = run_nearpose("import --model " + (scene.models() / "obj_000001.ply").string() +
                                         " --unit cm --id 3 --out " + scene.file("imported").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::is_regular_file(scene.file("imported/obj_000003.ply")));
    const auto info = data_set::read_model_info(scene.file("imported"), 3);
    EXPECT_NEAR(info.box_max_in_object_m.x(), 1.6, 1e-4);  // 160 in the file
}

TEST(Import, ARecordingGoesToANumberAndLeavesTheUsersCameraAlone) {
    const TinyScene scene(1);
    std::filesystem::create_directories(scene.file("raw"));
    write_text(scene.file("raw/part_Depth_12.5.raw"), std::string(2 * 160 * 120, '\3'));
    const std::string camera = read_text(scene.file("camera.json")) + "\n\n";  // a text of the user's own
    write_text(scene.file("camera.json"), camera);
    const std::string call = "import --realsense-raw " + scene.file("raw").string() + " --camera " +
                             scene.file("camera.json").string() + " --depth-unit-m 0.0002 --out ";
    const Outcome no_number = run_nearpose(call + scene.file("test/mine").string());
    EXPECT_EQ(no_number.exit_code, 2);
    EXPECT_TRUE(contains(no_number.err, "SET/test/NUMBER")) << no_number.err;
    EXPECT_FALSE(std::filesystem::exists(scene.file("test/mine")));
    EXPECT_EQ(run_nearpose(call + scene.file("test/000008").string()).exit_code, 0);
    EXPECT_EQ(data_set::read_count_png(scene.file("test/000008/depth/000000.png")).counts[0], 0x303);
    EXPECT_EQ(read_text(scene.file("camera.json")), camera);
}

TEST(Import, SourcesExcludeEachOther) {
    EXPECT_EQ(run_nearpose("import --tum a --open3d b --out c").exit_code, 2);
    EXPECT_EQ(run_nearpose("import --tum a --out c").exit_code, 2);
    EXPECT_EQ(run_nearpose("import --tum nowhere --camera nowhere.json --out c/test/1").exit_code, 1);
}

}  // namespace
}  // namespace nearpose::program_tests
