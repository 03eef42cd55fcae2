#include "core/search/sampling.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/random.hpp"

namespace nearpose {

ParticleSet sample_on_sphere(const Observation& observation, const ModelExtent& extent, int count, std::uint64_t seed,
                             std::uint64_t step) {
    const Eigen::Vector3d centre_in_camera =
        observation.mean_distance_m() * observation.centroid_in_camera().normalized();
    ParticleSet particles;
    for (int i = 0; i < count; ++i) {
        RandomStream random(seed, step, static_cast<std::uint64_t>(i), RandomPurpose::kStart);
        const Eigen::Quaterniond rotation = random.rotation();
        particles.poses.push_back({rotation, centre_in_camera - rotation * extent.centre_in_object()});
    }
    particles.negative_log_weights.assign(particles.poses.size(), 0.0);
    return particles;
}

ParticleSet sample_around(const Pose& camera_from_object, const Diffusion& spread, const ModelExtent& extent, int count,
                          std::uint64_t seed, std::uint64_t step) {
    ParticleSet particles;
    particles.poses.assign(count, camera_from_object);
    particles.negative_log_weights.assign(count, 0.0);
    diffuse(particles, spread, extent.centre_in_object(), seed, step);
    if (count > 0) particles.poses[0] = camera_from_object;
    return particles;
}

ParticleSet sample_on_surface(const Observation& observation, const std::vector<OrientedPoint>& model, int count,
                              std::uint64_t seed, std::uint64_t step, std::uint64_t first_stream) {
    std::vector<int> oriented;  // measured points whose normal is known
    for (std::size_t p = 0; p < observation.normals_in_camera().size(); ++p)
        if (!observation.normals_in_camera()[p].isZero()) oriented.push_back(static_cast<int>(p));
    ParticleSet particles;
    if (model.empty() || oriented.empty()) return particles;
    for (int i = 0; i < count; ++i) {
        RandomStream random(seed, step, first_stream + static_cast<std::uint64_t>(i), RandomPurpose::kStart);
        const int measured = oriented[random.below(static_cast<int>(oriented.size()))];
        const OrientedPoint& point = model[random.below(static_cast<int>(model.size()))];
        particles.poses.push_back(
            pose_aligning(point, {observation.points_in_camera()[measured], observation.normals_in_camera()[measured]},
                          random.uniform(0.0, 2.0 * M_PI)));
    }
    particles.negative_log_weights.assign(particles.poses.size(), 0.0);
    return particles;
}

Pose shift_to_seen_surface(const Pose& camera_from_object, const Observation& observation, const ViewGenerator& views,
                           const PinholeCamera& view_camera) {
    const View view = views.generate(camera_from_object, view_camera);
    if (view.size() == 0) return camera_from_object;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& point : view.points_in_object) sum += point.cast<double>();
    const Eigen::Vector3d seen_in_camera = camera_from_object * (sum / static_cast<double>(view.size()));
    Pose shifted = camera_from_object;
    shifted.translation += observation.centroid_in_camera() - seen_in_camera;
    return shifted;
}

}  // namespace nearpose
