#include "core/world/still_world.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.hpp"
#include "tests/core/world/sightings_of.hpp"

namespace nearpose {
namespace {

constexpr int kFrames = 40;

// Errors of the set-up: focal length, columns, rows, depth scale.
struct World {
    Eigen::Vector4d setup = Eigen::Vector4d::Zero();
    Twist hand_eye = Twist::Zero();
    Twist velocity = Twist::Zero();  // of the part, a frame
    double late_frames = 0.0;
    std::uint64_t seed = 0;  // of the fits' noise; 0: none
};

Sightings sightings_in(const World& world) {
    RandomStream random(world.seed, 0, 0, RandomPurpose::kDiffusion);
    const auto seen = [&](int frame) {
        const Pose truth = approach(frame) * perturb_about(kWorldFromObject, frame * world.velocity, kCentre);
        JointFit fit = fit_at(truth);
        fit.setup_effect = effect_at(truth);
        Twist off = fit.setup_effect * world.setup;
        for (int i = 0; world.seed != 0 && i < 6; ++i) off[i] += random.gaussian() * std::sqrt(fit.covariance(i, i));
        const Twist motion =
            frame > 0 ? Twist(log(approach(frame - 1) * approach(frame).inverse())) : Twist(Twist::Zero());
        const Twist arm = world.hand_eye - world.late_frames * motion;
        fit.camera_from_object = perturb_about(truth, off + from_camera_twist(truth, kCentre) * arm, kCentre);
        return fit;
    };
    return sightings_of(kFrames, seen, [](const Pose& m) { return m; });
}

TEST(StillWorld, APartThatStandsInAGoodSetUpSeemsToStand) {
    const StillWorld world = compare_causes(sightings_in({}).kept, kCentre);
    EXPECT_EQ(world.sightings, kFrames);
    EXPECT_EQ(world.cause, Cause::kNone);
    EXPECT_EQ(world.error_bound_m, 0.0);
}

TEST(StillWorld, EachErrorIsToldFromTheOthers) {
    struct Case {
        Cause cause;
        World world;
    };
    std::vector<Case> cases(5);
    cases[0].cause = Cause::kPrincipalPoint, cases[0].world.setup[kImageColumns] = 12.0;
    cases[1].cause = Cause::kDepthScale, cases[1].world.setup[kDepthScaleError] = 0.03;
    cases[2].cause = Cause::kTimeOffset, cases[2].world.late_frames = 2.0;
    cases[3].cause = Cause::kHandEyeRotation, cases[3].world.hand_eye[0] = 0.03;
    cases[4].cause = Cause::kObjectMotion, cases[4].world.velocity[3] = 0.002;
    for (const Case& fault : cases) {
        const StillWorld world = compare_causes(sightings_in(fault.world).kept, kCentre);
        EXPECT_STREQ(to_string(world.cause), to_string(fault.cause));
    }
}

TEST(StillWorld, TheBoundHoldsTheErrorThatTheSetUpCauses) {
    World world;
    world.setup[kImageColumns] = 12.0;
    const Sightings sightings = sightings_in(world);
    const double error_m = (effect_at(approach(kFrames - 1) * kWorldFromObject) * world.setup).tail<3>().norm();
    const StillWorld found = compare_causes(sightings.kept, kCentre);
    EXPECT_GT(found.error_bound_m, error_m);
    EXPECT_LT(found.error_bound_m, 3.0 * error_m);
}

TEST(StillWorld, NoiseIsNoCause) {
    int believed = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        World world;
        world.seed = seed;
        believed += compare_causes(sightings_in(world).kept, kCentre).cause != Cause::kNone;
    }
    EXPECT_EQ(believed, 0);
}

TEST(StillWorld, OnlyWhatWasSeenSinceAMoveCounts) {
    Sightings sightings = sightings_in({});
    sightings.kept[30].moved = true;
    for (int k = 30; k < kFrames; ++k)
        sightings.kept[k].camera_from_object.translation += Eigen::Vector3d(0.02, 0.0, 0.0);
    EXPECT_EQ(compare_causes(sightings.kept, kCentre).sightings, 10);
    sightings.kept[38].moved = true;
    EXPECT_TRUE(compare_causes(sightings.kept, kCentre).evidence.empty()) << "too few";
}

}  // namespace
}  // namespace nearpose
