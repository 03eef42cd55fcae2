// render, run as a user would.
#include <gtest/gtest.h>

#include "apps/data_set/png_file.hpp"
#include "tests/apps/support/contains.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

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

}  // namespace
}  // namespace nearpose::program_tests
