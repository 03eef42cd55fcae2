#include "core/evidence/likelihood.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const PinholeCamera kCamera = test::small_camera();
const Pose kTruth{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX())), {0.0, 0, 0.45}};
const PixelGrid kGrid = grid_over({0, 0, 160, 120}, 3000);

PixelCost cost_at(const Pose& pose, const Observation& observation, const PixelCostOptions& options = {}) {
    const ObservedGrid observed = observe(observation, kGrid);
    return pixel_cost(kPart.generate(pose, observed.camera), pose, observed, options);
}

Observation observe_part(bool with_mask, float wall_m = 0.8F) {
    Mask mask;
    const DepthImage image = test::render(kPart, kTruth, kCamera, wall_m, &mask);
    return make_observation(image, kCamera, with_mask ? std::optional(mask) : std::nullopt);
}

Pose shifted(double x, double y, double z) {
    Pose pose = kTruth;
    pose.translation += Eigen::Vector3d(x, y, z);
    return pose;
}

TEST(OverlapMse, IsThePapersFormula) {
    Correspondences pairs;
    for (const double error : {0.001, 0.002, 0.003}) {
        pairs.points_in_object.emplace_back(0, 0, 0);
        pairs.points_in_camera.emplace_back(static_cast<float>(error), 0, 0);
    }
    // m / n * MSE = 12 / 3 * (1 + 4 + 9) / 3 mm^2
    EXPECT_NEAR(overlap_scaled_mse(pairs, Pose::identity(), 12, 0.03), 4.0 * 14.0 / 3.0 * 1e-6, 1e-12);
}

TEST(OverlapMse, NothingMatchedIsWorseThanAnythingMatched) {
    Correspondences one;
    one.points_in_object.emplace_back(0, 0, 0);
    one.points_in_camera.emplace_back(0.03F, 0, 0);  // at the gate
    EXPECT_GT(overlap_scaled_mse({}, Pose::identity(), 100, 0.03),
              overlap_scaled_mse(one, Pose::identity(), 100, 0.03));
}

TEST(PixelCost, IsZeroAtTheTruthAndCountsEveryPixel) {
    const PixelCost cost = cost_at(kTruth, observe_part(true));
    EXPECT_LT(cost.cost, 1e-4);
    EXPECT_EQ(cost.agreeing, cost.judged);
    EXPECT_EQ(cost.missing_model + cost.free_space_violations + cost.occluded, 0);
}

TEST(PixelCost, ASmallErrorInDepthCostsItsSquare) {
    const Observation observation = observe_part(true);
    const double sigma_m = observation.sigma_m(0.45);
    // Seen face on, moved by half a sigma: r^2 / truncation^2 = 0.25 / 9, but for the towers' own distance and sigma.
    // A few rays at the outline meet another surface.
    const PixelCost cost = cost_at(shifted(0, 0, 0.5 * sigma_m), observation);
    const int others = cost.judged - cost.agreeing;
    EXPECT_LT(others, 0.05 * cost.judged);
    EXPECT_NEAR((cost.cost * cost.judged - others) / cost.agreeing, 0.25 / 9.0, 0.006);
}

TEST(PixelCost, ModelOverSeenBackgroundAndMissingModelCostFully) {
    const Observation observation = observe_part(true);
    const PixelCost cost = cost_at(shifted(0.3, 0, 0), observation);  // beside the object
    EXPECT_GT(cost.free_space_violations, 50);
    EXPECT_GT(cost.missing_model, 50);
    EXPECT_NEAR(cost.cost, 1.0, 1e-9);
}

TEST(PixelCost, ModelBehindTheBackgroundMayBeOccluded) {
    const Observation observation = observe_part(true);
    const Pose behind_wall = shifted(0.5, 0, 1.0);
    const PixelCost cost = cost_at(behind_wall, observation);
    EXPECT_GT(cost.occluded, 15);
    const double occluded = 0.3 * cost.occluded, missing = cost.missing_model;
    EXPECT_NEAR(cost.cost, (occluded + missing) / cost.judged, 1e-9);
}

TEST(PixelCost, PixelsWithoutDepthAreNotJudged) {
    DepthImage image = test::render(kPart, kTruth, kCamera, 0.8F, nullptr);
    Mask mask;
    test::render(kPart, kTruth, kCamera, 0.8F, &mask);
    for (std::size_t pixel = 0; pixel < image.depth_m.size(); pixel += 2) image.depth_m[pixel] = 0.0F;
    const PixelCost holes = cost_at(kTruth, make_observation(image, kCamera, mask));
    EXPECT_LT(holes.cost, 1e-4);
    std::fill(image.depth_m.begin(), image.depth_m.end(), 0.0F);
    const PixelCost nothing = cost_at(kTruth, make_observation(image, kCamera, mask));
    EXPECT_EQ(nothing.judged, 0);
    EXPECT_EQ(nothing.cost, 1.0);
}

TEST(PixelCost, WithoutAMaskTheTruthIsStillTheMinimum) {
    const Observation observation = observe_part(false);
    const double truth = cost_at(kTruth, observation).cost;
    for (const auto& [x, y, z] : {std::array{0.01, 0.0, 0.0},
                                  {0.0, 0.02, 0.0},
                                  {0.0, 0.0, 0.01},
                                  {0.0, 0.0, -0.01},
                                  {0.3, 0.0, 0.0},
                                  {0.0, 0.0, 1.0}})
        EXPECT_LT(truth, cost_at(shifted(x, y, z), observation).cost) << x << " " << y << " " << z;
}

TEST(PixelCost, TurnedByHalfATurnIsWorse) {
    for (const bool with_mask : {true, false}) {
        const Observation observation = observe_part(with_mask);
        const Pose turned = kTruth * exp((Twist() << 0, 0, M_PI, 0, 0, 0).finished());
        EXPECT_GT(cost_at(turned, observation).cost, cost_at(kTruth, observation).cost + 0.05);
    }
}

TEST(PixelCost, WithoutAMaskDeepFreeSpaceViolationsCostMore) {
    const Observation open = observe_part(false), segmented = observe_part(true);
    const Pose beside = shifted(0.2, 0, 0);  // before the wall, which is 0.35 to 0.44 m behind
    PixelCostOptions options;
    const PixelCost shallow = cost_at(beside, open, options);
    ASSERT_GT(shallow.free_space_violations, 100);
    const auto more_than_shallow = [&](double free_space_depth_m) {
        options.free_space_depth_m = free_space_depth_m;
        const PixelCost cost = cost_at(beside, open, options);
        EXPECT_EQ(cost.free_space_violations, shallow.free_space_violations);
        return cost.cost * cost.judged - shallow.cost * shallow.judged;
    };
    const double all = (options.free_space_cost - 1.0) * shallow.free_space_violations;
    EXPECT_NEAR(more_than_shallow(0.45), 0.0, 1e-9) << "no violation is so deep";
    EXPECT_NEAR(more_than_shallow(0.05), all, 0.02 * all) << "nearly all are twice as deep as that";
    const double some = more_than_shallow(0.25);  // by 0.4 to 0.76 of it
    EXPECT_GT(some, 0.4 * all);
    EXPECT_LT(some, 0.76 * all);
    EXPECT_EQ(cost_at(beside, segmented, options).cost, cost_at(beside, segmented).cost)
        << "a mask makes depth irrelevant";
}

// A plate, such as a gripper's palm, occludes most of the part. No pose with a face in the plate explains as much as
// the true pose: what of the model reaches beyond the plate's edge would occlude the background that is seen there.
TEST(PixelCost, APartBehindAPlateExplainsMoreThanOneAlignedWithThePlate) {
    constexpr float kPlate_m = 0.30F;
    DepthImage image = test::render(kPart, kTruth, kCamera, 0.8F, nullptr);
    for (int v = 20; v < 100; ++v)
        for (int u = 10; u < 84; ++u) image.depth_m[static_cast<std::size_t>(v) * image.width + u] = kPlate_m;
    const Observation observation = make_observation(image, kCamera, std::nullopt);
    PixelCostOptions options;
    const auto best_on_plate = [&] {
        double best = 0.0;
        for (const double front_m : {0.36, 0.40, 0.42})  // of the towers and of the base
            for (double x = -0.1; x < 0.1; x += 0.01)
                for (double y = -0.06; y < 0.07; y += 0.02)
                    best = std::max(best, cost_at(shifted(x, y, kPlate_m - front_m), observation, options).gain);
        return best;
    };
    EXPECT_GT(best_on_plate(), cost_at(kTruth, observation, options).gain) << "otherwise this is no trap";
    options.free_space_depth_m = 0.05 * kPart.extent().diameter_m();
    EXPECT_LT(best_on_plate(), cost_at(kTruth, observation, options).gain);
}

// However large the face is.
TEST(PixelCost, AFaceAlignedWithALargerPlaneExplainsNothing) {
    constexpr float kWall_m = 0.3F;
    const Observation wall = make_observation(
        DepthImage{kCamera.width, kCamera.height,
                   std::vector<float>(static_cast<std::size_t>(kCamera.width * kCamera.height), kWall_m)},
        kCamera, {});
    const View view = kPart.generate(kTruth, kCamera);
    float nearest_m = 1.0F;
    for (const Eigen::Vector3f& point : view.points_in_object)
        nearest_m = std::min(nearest_m, static_cast<float>((kTruth * point.cast<double>()).z()));
    PixelCostOptions options;
    options.with_outline = true;
    const PixelCost aligned = cost_at(shifted(0, 0, kWall_m - nearest_m), wall, options);
    EXPECT_GT(aligned.agreeing, 50);
    EXPECT_GT(aligned.coplanar_share(), 0.9);
    const double within = aligned.gain - (options.unexplained_cost - options.outline_cost) * aligned.coplanar;
    EXPECT_LT(within, 0.25 * options.unexplained_cost * aligned.agreeing);
    EXPECT_LT(aligned.gain, 0.0);
    const PixelCost truth = cost_at(kTruth, observe_part(false), options);
    EXPECT_LT(truth.coplanar_share(), 0.1);
    EXPECT_GT(truth.gain, 0.45 * truth.agreeing) << "an object that stands out keeps what it explains";
}

// The view of a rasteriser: the nearest sample in each pixel, of samples five times as dense as the pixels. With
// `every` above 1, in one of so many pixels only.
View rasterised(const Pose& camera_from_object, const PinholeCamera& camera, int every) {
    constexpr int kDensity = 5;
    const PinholeCamera fine{kDensity * camera.width, kDensity * camera.height,   kDensity * camera.fx,
                             kDensity * camera.fy,    kDensity * camera.cx + 2.0, kDensity * camera.cy + 2.0};
    const View samples = kPart.generate(camera_from_object, fine);
    std::map<int, std::pair<double, std::size_t>> nearest;  // depth [m] and sample, by pixel
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const int u = samples.pixels[k] % fine.width / kDensity, v = samples.pixels[k] / fine.width / kDensity;
        const double depth_m = (camera_from_object * samples.points_in_object[k].cast<double>()).z();
        const auto [entry, is_new] = nearest.try_emplace(v * camera.width + u, depth_m, k);
        if (!is_new && depth_m < entry->second.first) entry->second = {depth_m, k};
    }
    View view;
    for (const auto& [pixel, sample] : nearest) {
        if ((pixel % camera.width + pixel / camera.width) % every != 0) continue;
        view.points_in_object.push_back(samples.points_in_object[sample.second]);
        view.normals_in_object.push_back(samples.normals_in_object[sample.second]);
        view.pixels.push_back(pixel);
    }
    return view;
}

TEST(PixelCost, SamplesAreComparedOnThePixelsRays) {
    const Pose tilted = kTruth * exp((Twist() << 0.6, 0.4, 0, 0, 0, 0).finished());
    const DepthImage image = test::render(kPart, tilted, kCamera, 0.8F, nullptr);
    const ObservedGrid observed = observe(make_observation(image, kCamera, {}), kGrid);
    View view = rasterised(tilted, observed.camera, 1);
    EXPECT_LT(pixel_cost(view, tilted, observed, {}).agreement(), 0.5)
        << "the nearest sample of a pixel lies before its ray's point";
    view.of_samples = true;
    EXPECT_GT(pixel_cost(view, tilted, observed, {}).agreement(), 0.8) << "all but the pixels that an edge crosses";
}

TEST(PixelCost, GapsBetweenSamplesAreNoOutline) {
    const ObservedGrid observed = observe(observe_part(false), kGrid);
    View view = rasterised(kTruth, observed.camera, 4);
    PixelCostOptions options;
    options.with_outline = true;
    EXPECT_GT(pixel_cost(view, kTruth, observed, options).coplanar_share(), 0.8) << "gaps look like an outline";
    view.of_samples = true;
    EXPECT_LT(pixel_cost(view, kTruth, observed, options).coplanar_share(), 0.2);
}

TEST(Likelihood, LiesBetweenCertainAndIgnorant) {
    // Epsilon of a chance match within the gate, 3/5 gate^2, with no sensor noise, is half a unit of log-likelihood.
    EXPECT_NEAR(negative_log_likelihood(0.6 * 0.03 * 0.03, 0.0, 0.03), 0.5, 1e-12);
    PixelCost cost;
    cost.cost = 0.1;
    PixelCostOptions options;
    EXPECT_NEAR(negative_log_likelihood(cost, options),
                0.5 * options.independent_rays * options.truncation_sigmas * options.truncation_sigmas * 0.1, 1e-12);
}

TEST(PixelCost, AgreementHardlyCountsRaysAtStepsAndCountsDeepContradictionsTwice) {
    PixelCost cost;
    cost.agreeing = 80;
    cost.contradicted = 20;
    EXPECT_DOUBLE_EQ(cost.agreement(), 0.8);
    cost.mixed_agreeing = 40.0;
    cost.mixed_contradicted = 18.0;
    EXPECT_DOUBLE_EQ(cost.agreement(), 40.0 / 42.0);
    EXPECT_DOUBLE_EQ(cost.inlier_ratio(), 0.8) << "that one counts all rays alike";
    cost.deep = 2.0;
    EXPECT_DOUBLE_EQ(cost.agreement(), 40.0 / 44.0);
}

TEST(PixelCost, ContradictionsDeepInFreeSpaceAreDeepAndShallowOnesAreNot) {
    ObservationOptions sharp;
    sharp.sensor.edge_pixels = 0.0;  // so that rays at steps count like all others
    const Observation observation =
        make_observation(test::render(kPart, kTruth, kCamera, 0.8F, nullptr), kCamera, {}, sharp);
    PixelCostOptions options;
    options.free_space_depth_m = 0.02;
    const PixelCost shallow = cost_at(shifted(0, 0, -0.015), observation, options);
    const PixelCost deep = cost_at(shifted(0, 0, -0.06), observation, options);
    EXPECT_GT(shallow.contradicted, 100);
    EXPECT_LT(shallow.deep, 0.15 * shallow.contradicted) << "towers stand before the wall";
    EXPECT_GT(deep.deep, 0.9 * deep.contradicted) << "twice 20 mm before the surface, all count twice";
    EXPECT_LE(deep.deep, deep.contradicted);
}

TEST(PixelCost, AtTheModelsStepsASensorThatMixesIsNotBelieved) {
    const Observation observation = observe_part(true);  // noise-free, so it is taken for one that mixes
    ASSERT_EQ(observation.shared_noise(), 1.0);
    const PixelCost cost = cost_at(kTruth, observation);
    EXPECT_GT(cost.mixed_agreeing, 0.1 * cost.agreeing);
    EXPECT_LT(cost.mixed_agreeing, 0.9 * cost.agreeing);
    EXPECT_EQ(cost.mixed_contradicted, 0.0);
    EXPECT_EQ(cost.agreement(), 1.0);
}

}  // namespace
}  // namespace nearpose
