// Rays at the model's depth steps, against a search through all pairs of rays.
#include "core/evidence/model_edges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

const test::BoxViewGenerator kPart(test::asymmetric_part());
const PinholeCamera kCamera = test::small_camera();
const Pose kPose{Eigen::Quaterniond(Eigen::AngleAxisd(2.6, Eigen::Vector3d(1.0, 0.2, 0.1).normalized())), {0, 0, 0.45}};

TEST(ModelEdges, AreWhereTheModelEndsOrDepartsFromTheTangentPlane) {
    const Observation observation = make_observation(test::render(kPart, kPose, kCamera, 0.9F, nullptr), kCamera, {});
    const ObservedGrid observed = observe(observation, grid_over({0, 0, 160, 120}, 5000));
    const View view = kPart.generate(kPose, observed.camera);
    constexpr int kReach = 2;
    constexpr double kSigmas = 1.5;
    const std::vector<char> at_step = rays_at_steps(view, observed, kReach, kSigmas);
    int marked = 0;
    for (std::size_t k = 0; k < view.size(); ++k) {
        const int u = view.pixels[k] % observed.grid.width, v = view.pixels[k] / observed.grid.width;
        int inside = 0, coplanar = 0;  // of the eight directions
        for (int dv = -kReach; dv <= kReach; dv += kReach)
            for (int du = -kReach; du <= kReach; du += kReach)
                inside += u + du >= 0 && v + dv >= 0 && u + du < observed.grid.width && v + dv < observed.grid.height;
        for (std::size_t j = 0; j < view.size(); ++j) {
            const int du = std::abs(view.pixels[j] % observed.grid.width - u);
            const int dv = std::abs(view.pixels[j] / observed.grid.width - v);
            if ((du != 0 && du != kReach) || (dv != 0 && dv != kReach)) continue;
            const double off_m = view.normals_in_object[k].dot(view.points_in_object[j] - view.points_in_object[k]);
            coplanar += std::abs(off_m) <= kSigmas * observed.sigma_m[view.pixels[k]];
        }
        EXPECT_EQ(at_step[k] != 0, coplanar < inside) << u << ' ' << v;
        marked += at_step[k];
    }
    EXPECT_GT(marked, 50);
    EXPECT_LT(marked, static_cast<int>(view.size()) - 50);
    const std::vector<char> none = rays_at_steps(view, observed, 0, kSigmas);
    EXPECT_EQ(std::count(none.begin(), none.end(), 0), static_cast<std::ptrdiff_t>(view.size()));
}

}  // namespace
}  // namespace nearpose
