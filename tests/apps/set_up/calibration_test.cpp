#include "apps/set_up/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.hpp"

namespace nearpose::program {
namespace {

const Eigen::Vector3d kCentre(0.05, -0.02, 0.03);

Twist twist_of(double rx, double ry, double rz, double x, double y, double z) {
    Twist twist;
    twist << rx, ry, rz, x, y, z;
    return twist;
}

// A camera that swings about a part, and a hand-eye calibration that is off.
std::vector<Sighting> sightings_with(const Pose& given_from_camera, std::uint64_t seed) {
    RandomStream random(seed, 0, 0, RandomPurpose::kDiffusion);
    const Pose world_from_object = exp(twist_of(0.5, 0.2, -0.4, 0.02, 0.03, 0.6));
    std::vector<Sighting> sightings;
    for (int frame = 0; frame < 60; ++frame) {
        const double t = 0.04 * frame;
        const Pose camera_from_world =
            exp(twist_of(0.25 * std::sin(t), 0.25 * std::cos(1.3 * t), 0.4 * std::sin(0.7 * t),
                         0.06 * std::sin(1.1 * t), 0.05 * std::cos(0.9 * t), -0.005 * frame));
        Twist noise;
        for (int i = 0; i < 6; ++i) noise[i] = (i < 3 ? 3e-4 : 1e-4) * random.gaussian();
        Sighting sighting;
        sighting.covariance.diagonal() << Eigen::Vector3d::Constant(9e-8), Eigen::Vector3d::Constant(1e-8);
        sighting.camera_from_object = perturb_about(camera_from_world * world_from_object, noise, kCentre);
        sighting.arm_from_camera = (given_from_camera * camera_from_world).inverse();
        sightings.push_back(sighting);
    }
    return sightings;
}

TEST(PartsAtFault, AreNoneWhereTheSetUpIsAsUsual) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const auto parts = parts_at_fault(sightings_with(Pose::identity(), seed), kCentre, SetupVector::Zero(), 3.0);
        EXPECT_TRUE(parts.empty()) << parts.front();
    }
}

TEST(PartsAtFault, AreThoseThatMakeTheSightingsLikelier) {
    const Pose off = exp(twist_of(0.012, -0.008, 0.01, 0.004, -0.003, 0.005));
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const auto parts = parts_at_fault(sightings_with(off, seed), kCentre, SetupVector::Zero(), 3.0);
        EXPECT_EQ(parts, std::vector<std::string>{"hand-eye"});
    }
}

}  // namespace
}  // namespace nearpose::program
