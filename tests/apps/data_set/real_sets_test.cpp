// The published sets, where they are: ../shared/data from the project's root.
#include <gtest/gtest.h>

#include <algorithm>

#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/bop_masks.hpp"
#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/trajectory_tum.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;

struct PublishedSet {
    const char* name;
    std::size_t frames;
    double nearest_m;  // between which the depth of the object lies
    double farthest_m;
    std::size_t symmetries;
};

const fs::path kData = "../shared/data";

class RealSet : public testing::TestWithParam<PublishedSet> {};

TEST_P(RealSet, IsReadWhole) {
    const PublishedSet& expected = GetParam();
    const fs::path set = kData / expected.name;
    if (!fs::exists(set)) GTEST_SKIP() << set << " is not there";
    const BopScene scene = open_scene(set / "test" / "000001");
    ASSERT_EQ(scene.frames.size(), expected.frames);
    const MaskSource masks(scene, 1);
    const Frame& frame = scene.frames.back();
    EXPECT_FALSE(frame.camera_from_world);
    const DepthImage depth = load_depth(frame);
    const Mask mask = masks.load(frame).mask.value();
    // The median depth within the mask is that of the object, whose distance the true pose says.
    std::vector<float> depths;
    for (std::size_t i = 0; i < mask.value.size(); ++i) {
        if (mask.value[i] != 0 && depth.depth_m[i] > 0.0F) depths.push_back(depth.depth_m[i]);
    }
    ASSERT_GT(depths.size(), 1000U);
    std::nth_element(depths.begin(), depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2), depths.end());
    const double median_m = depths[depths.size() / 2];
    EXPECT_GT(median_m, expected.nearest_m);
    EXPECT_LT(median_m, expected.farthest_m);
    const std::map<int, Pose> truth = read_ground_truth(scene.folder, 1);
    EXPECT_EQ(truth.size(), expected.frames);
    const ModelInfo info = read_model_info(set / "models", 1);
    EXPECT_LT(std::abs(truth.at(frame.id).translation.z() - median_m), info.diameter_m);
    EXPECT_EQ(info.discrete_symmetries.size(), expected.symmetries);
    EXPECT_TRUE(fs::exists(model_path(set / "models", 1)));
}

INSTANTIATE_TEST_SUITE_P(Published, RealSet,
                         testing::Values(PublishedSet{"visp_castel", 30, 0.2, 0.4, 0},
                                         PublishedSet{"visp_castle_simu", 40, 0.25, 0.65, 0},
                                         PublishedSet{"visp_cube42", 10, 0.2, 0.35, 23},
                                         PublishedSet{"visp_rbt", 99, 0.4, 0.6, 23}),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(RealTrajectory, ARecordingOfFourDigitsIsRead) {
    const fs::path file = kData / "trajectories" / "tum_fr1_xyz_groundtruth.tum";
    if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
    EXPECT_THROW(read_tum(file), std::runtime_error);  // its quaternions are not of unit length to 1e-5
    EXPECT_GT(read_tum(file, 1e-3).size(), 1000U);
}

}  // namespace
}  // namespace nearpose::data_set
