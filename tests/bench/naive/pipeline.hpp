// The whole frame as one writes it first: for each particle a view of single rays, then rounds of one FLANN call a
// point, sample consensus and one residual block a pair; weighed with the paper's overlap-scaled mean squared error.
#pragma once

#include "core/base/depth_image.hpp"
#include "core/base/random.hpp"
#include "core/filter/particles.hpp"
#include "tests/bench/naive/cloud.hpp"
#include "tests/bench/naive/least_squares.hpp"
#include "tests/bench/naive/single_ray_views.hpp"

namespace nearpose::bench::naive {

// The seen points are thinned to 500 (nearpose's own views have 230 to 470 on the approach): with all of the 2,700 to
// 8,500 that 160 x 120 rays give, every later step would be ten times as slow again.
struct RegistrationOptions {
    int rounds = 3;
    int hypotheses = 200;          // of the sample consensus; 0: none
    int max_view_points = 500;     // of a view
    double max_distance_m = 0.03;  // of a pair; the paper's
    double consensus_distance_m = 0.01;
};

struct Registered {
    Pose camera_from_object;
    double epsilon_m2 = 0.0;  // the overlap-scaled mean squared error
};

// Pairs of the seen points with the cloud's nearest.
std::vector<Pair> nearest_pairs(const SeenSurface& seen, const Pose& camera_from_object, const CloudIndex& cloud,
                                double max_distance_m);
// The paper's m / n * MSE over n pairs of m seen points [m^2].
double overlap_scaled_error(const std::vector<Pair>& pairs, std::size_t num_seen, const Pose& camera_from_object,
                            double max_distance_m);

Registered register_pose(const Pose& camera_from_object, const SingleRayViews& views, const PinholeCamera& camera,
                         const CloudIndex& cloud, const RegistrationOptions& options, const RandomStream& random);

class Pipeline {
  public:
    // Particles spread around `start` (camera_from_object).
    Pipeline(const Mesh& mesh, const PinholeCamera& camera, const Pose& start, int num_particles);

    // The pose with the smallest weight.
    Pose update(const DepthImage& depth, const Mask& mask, const Pose& now_from_before);

  private:
    SingleRayViews views_;
    ModelExtent extent_;
    PinholeCamera camera_;
    ParticleSet particles_;
    std::uint64_t step_ = 0;
};

inline constexpr int kMaxCloudPoints = 2000;

}  // namespace nearpose::bench::naive
