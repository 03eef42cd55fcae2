#include "core/search/hypothesis_pruning.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "core/search/pair_hypotheses.hpp"
#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const PinholeCamera kCamera{320, 240, 300.0, 300.0, 159.5, 119.5};
const Pose kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 0.4, 0.2).normalized())),
                  {0.03, -0.01, 0.55}};

// A pose at the truth has support. One that floats before the wall lies in free space: the camera looked through it.
TEST(ModelScore, PositiveAtTheTruthAndNegativeInFreeSpace) {
    const PointPairTable pairs(kPart);
    Mask mask;
    const Observation observation = make_observation(test::render(kPart, kTruth, kCamera, 0.8F, &mask), kCamera, {});
    const SurfelGrid surfels = surfels_of(observation, pairs, {}, 1, 1);
    const PruningContext context{.surface = pairs.surface(),
                                 .surfels = surfels,
                                 .camera = kCamera,
                                 .measured = systematic_sample(surfels, 256),
                                 .model = pairs.points(),
                                 .tolerance_m = 0.01,
                                 .diameter_m = pairs.diameter_m()};
    const std::size_t all = pairs.points().size();
    EXPECT_GT(model_score(context, kTruth, all, context.tolerance_m), 0.0);
    Pose beside = kTruth;
    beside.translation.x() -= 1.5 * pairs.diameter_m() * 0.5;
    beside.translation.z() -= 0.1;
    EXPECT_LT(model_score(context, beside, all, context.tolerance_m), 0.0);
    Pose behind_camera = kTruth;
    behind_camera.translation.z() = -1.0;
    EXPECT_EQ(model_score(context, behind_camera, all, context.tolerance_m), 0.0);
}

TEST(SearchOptions, NameTheFieldThatIsOutOfBounds) {
    EXPECT_NO_THROW(validate(SearchOptions{}));
    SearchOptions options;
    options.pruning.stages[1].kept = 0;
    try {
        validate(options);
        FAIL() << "accepted";
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("search.pruning.stages[1].kept"), std::string::npos) << error.what();
    }
    options = {};
    options.point_pair_table.angle_cells = 26;
    EXPECT_THROW(validate(options), std::invalid_argument) << "narrower than a bin of cosines";
}

}  // namespace
}  // namespace nearpose
