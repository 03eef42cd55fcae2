#include "tests/bench/naive/pipeline.hpp"

namespace nearpose::bench::naive {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr double kDiffusion_rad = 0.03;
constexpr double kDiffusionDiameters = 0.008;

SeenSurface thinned_surface(const SeenSurface& seen, int count) {
    return {thinned(seen.points_in_object, count), thinned(seen.normals_in_object, count)};
}

}  // namespace

std::vector<Pair> nearest_pairs(const SeenSurface& seen, const Pose& camera_from_object, const CloudIndex& cloud,
                                double max_distance_m) {
    std::vector<Pair> pairs;
    for (std::size_t k = 0; k < seen.points_in_object.size(); ++k) {
        const Eigen::Vector3d point_in_object = seen.points_in_object[k].cast<double>();
        const Eigen::Vector3f query = (camera_from_object * point_in_object).cast<float>();
        const int index = cloud.nearest(query, static_cast<float>(max_distance_m));
        if (index < 0) continue;
        pairs.push_back({point_in_object, seen.normals_in_object[k].cast<double>(),
                         cloud.points()[static_cast<std::size_t>(index)].cast<double>()});
    }
    return pairs;
}

double overlap_scaled_error(const std::vector<Pair>& pairs, std::size_t num_seen, const Pose& camera_from_object,
                            double max_distance_m) {
    const auto m = static_cast<double>(num_seen), n = static_cast<double>(pairs.size());
    if (pairs.empty()) return (m + 1.0) * max_distance_m * max_distance_m;
    double sum_m2 = 0.0;
    for (const Pair& pair : pairs)
        sum_m2 += (camera_from_object * pair.point_in_object - pair.point_in_camera).squaredNorm();
    return m / n * (sum_m2 / n);
}

Registered register_pose(const Pose& camera_from_object, const SingleRayViews& views, const PinholeCamera& camera,
                         const CloudIndex& cloud, const RegistrationOptions& options, const RandomStream& random) {
    Registered result{camera_from_object, 0.0};
    const SeenSurface seen = thinned_surface(views.generate(camera_from_object, camera), options.max_view_points);
    std::vector<Pair> pairs;
    for (int round = 0; round < options.rounds; ++round) {
        pairs = nearest_pairs(seen, result.camera_from_object, cloud, options.max_distance_m);
        if (options.hypotheses > 0)
            pairs = sample_consensus(pairs, options.hypotheses, options.consensus_distance_m, random);
        if (pairs.size() >= 3) result.camera_from_object = solve_point_to_point(pairs, result.camera_from_object);
    }
    result.epsilon_m2 =
        overlap_scaled_error(pairs, seen.points_in_object.size(), result.camera_from_object, options.max_distance_m);
    return result;
}

Pipeline::Pipeline(const Mesh& mesh, const PinholeCamera& camera, const Pose& start, int num_particles)
    : views_(mesh), extent_(extent_of(mesh)), camera_(camera) {
    particles_.poses.assign(static_cast<std::size_t>(num_particles), start);
    particles_.negative_log_weights.assign(static_cast<std::size_t>(num_particles), 0.0);
}

Pose Pipeline::update(const DepthImage& depth, const Mask& mask, const Pose& now_from_before) {
    ++step_;
    const CloudIndex cloud(thinned(back_project(depth, mask, camera_), kMaxCloudPoints));
    if (effective_sample_size(particles_.negative_log_weights) < 0.5 * particles_.size())
        particles_ = systematic_resample(particles_, particles_.size(), kSeed, step_);
    propagate(particles_, now_from_before);
    diffuse(particles_, {kDiffusion_rad, kDiffusionDiameters * extent_.diameter_m()}, extent_.centre_in_object(), kSeed,
            step_);
    const RegistrationOptions options;
    const PinholeCamera coarse = quarter_camera(camera_);
    const double variance_m2 = options.max_distance_m * options.max_distance_m;
    std::vector<double> likelihoods;
    for (int i = 0; i < particles_.size(); ++i) {
        Pose& pose = particles_.poses[static_cast<std::size_t>(i)];
        const RandomStream random(kSeed, step_, static_cast<std::uint64_t>(i), RandomPurpose::kSampleConsensus);
        const Registered moved = register_pose(pose, views_, coarse, cloud, options, random);
        pose = moved.camera_from_object;
        likelihoods.push_back(moved.epsilon_m2 / (2.0 * variance_m2));
    }
    update_weights(particles_, likelihoods);
    return particles_.poses[static_cast<std::size_t>(map_index(particles_.negative_log_weights))];
}

}  // namespace nearpose::bench::naive
