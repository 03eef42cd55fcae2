// The camera's motion and the intrinsics as other tools write them.
#include <gtest/gtest.h>

#include <cmath>

#include "apps/data_set/bop_pose.hpp"
#include "tests/apps/data_set/scene_files.hpp"

namespace nearpose::data_set {
namespace {

using namespace testing_files;

class Motion : public SceneFiles {
  protected:
    static std::string moved(const std::string& rotation, const std::string& translation = "[1, 2, 3]") {
        return kK + ", \"cam_R_w2c\": " + rotation + ", \"cam_t_w2c\": " + translation;
    }
    const std::string good_ = moved("[1, 0, 0, 0, 1, 0, 0, 0, 1]");
};

TEST_F(Motion, OfOneFrameThatCannotBeUsedCostsThatFramesMotionAlone) {
    const std::string one = "[1, 0, 0, 0, 1, 0, 0, 0, 1]";
    for (const std::string& bad :
         {moved("null"), moved("[null, 0, 0, 0, 1, 0, 0, 0, 1]"), moved("[NaN, 0, 0, 0, 1, 0, 0, 0, 1]"),
          moved(one, "[0, -Infinity, 0]"), kK + ", \"cam_R_w2c\": " + one, kK + ", \"cam_t_w2c\": [0, 0, 0]",
          moved("[1, 0, 0, 0, 1.03, 0, 0, 0, 1]"), moved("[1, 0, 0, 0, 1, 0, 0, 0, -1]"),
          moved("[0, 0, 0, 0, 0, 0, 0, 0, 0]"), moved("[1e200, 0, 0, 0, 1, 0, 0, 0, 1]"),
          moved("[1, 0, 0, 0, 1, 0, 0, 0]")}) {
        const BopScene scene = open({good_, bad, good_});
        EXPECT_TRUE(scene.frames[0].camera_from_world && scene.frames[2].camera_from_world) << bad;
        EXPECT_FALSE(scene.frames[1].camera_from_world) << bad;
        expect_notice(scene.notices, {"scene_camera.json: 1", "_w2c", "without the camera's motion"});
    }
}

TEST_F(Motion, ThatCannotBeUsedInManyFramesIsSaidOnce) {
    const BopScene scene = open({moved("null"), good_, moved("null")});
    expect_notice(scene.notices, {"0/cam_R_w2c", "the same in 1 more frame (the last: 2)"});
}

TEST_F(Motion, OfFewDigitsIsMadeARotation) {
    // Off the nearest by less than a thousandth: the rounding of a file. By up to a hundredth: said.
    BopScene scene = open({moved("[0.7071, -0.7071, 0, 0.7071, 0.7071, 0, 0, 0, 1]")});
    EXPECT_NEAR(scene.frames[0].camera_from_world->rotation_matrix()(0, 0), std::sqrt(0.5), 1e-12);
    EXPECT_TRUE(scene.notices.all().empty());
    scene = open({moved("[0.7141, -0.7141, 0, 0.7141, 0.7141, 0, 0, 0, 1.008]")});
    EXPECT_NEAR(scene.frames[0].camera_from_world->rotation_matrix()(0, 0), std::sqrt(0.5), 1e-12);
    expect_notice(scene.notices, {"0/cam_R_w2c", "off a rotation by 0.0080", "nearest"});
}

TEST_F(Motion, AndIntrinsicsMayBeNestedOrText) {
    const BopScene scene = open({R"("cam_K": [["500", 0, 1.5], [0, "501", 1.25], [0, 0, 1]], "depth_scale": "0.5",
            "cam_R_w2c": [[0, -1, 0], [1, 0, 0], [0, 0, 1]], "cam_t_w2c": [[1000], [0], [0]])"});
    EXPECT_EQ(scene.frames[0].camera.fy, 501.0);
    EXPECT_EQ(scene.frames[0].camera.cx, 1.5);
    EXPECT_EQ(scene.frames[0].depth_scale_mm, 0.5);
    const Eigen::Vector3d moved = *scene.frames[0].camera_from_world * Eigen::Vector3d(1, 0, 0);
    EXPECT_LT((moved - Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
}

TEST_F(Motion, OfGroundTruthIsNotGuessed) {
    const JsonFile file = JsonFile::from_text(R"({"R": [1, 0, 0, 0, 1.008, 0, 0, 0, 1], "t": [0, 0, 0]})", "gt.json");
    expect_error([&] { read_bop_pose(file.root(), "R", "t"); }, {"gt.json", "R", "not a rotation"});
}

TEST_F(Motion, IntrinsicsMayHoldARoundingButNoSkew) {
    const auto with = [](const std::string& matrix) { return "\"depth_scale\": 1, \"cam_K\": " + matrix; };
    EXPECT_EQ(open({with("[500, 1e-14, 1.5, 0, 501, 1.25, 0, 0, 1.0000000000000002]")}).frames[0].camera.fx, 500.0);
    expect_error([&] { open({with("[500, 0.3, 1.5, 0, 501, 1.25, 0, 0, 1]")}); },
                 {"0/cam_K", "skew of 0.3 pixels", "rectify"});
}

TEST_F(Motion, ADepthScaleThatIsMissingIsMillimetres) {
    const BopScene scene = open({R"("cam_K": [500, 0, 1.5, 0, 501, 1.25, 0, 0, 1])"});
    EXPECT_EQ(scene.frames[0].depth_scale_mm, 1.0);
    EXPECT_FLOAT_EQ(load_depth(scene.frames[0]).depth_m[0], 0.001F);  // 1 count
    expect_notice(scene.notices, {"scene_camera.json: 0", "no depth_scale", "millimetres"});
}

}  // namespace
}  // namespace nearpose::data_set
