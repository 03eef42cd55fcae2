#include "core/filter/association.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace nearpose {
namespace {

void append(Correspondences& pairs, const View& view, std::size_t k, const Eigen::Vector3f& measured, double sigma_m) {
    pairs.points_in_object.push_back(view.points_in_object[k]);
    pairs.normals_in_object.push_back(view.normals_in_object[k]);
    pairs.points_in_camera.push_back(measured);
    pairs.sigmas_m.push_back(static_cast<float>(sigma_m));
}

void reserve(Correspondences& pairs, std::size_t count) {
    pairs.points_in_object.reserve(count);
    pairs.normals_in_object.reserve(count);
    pairs.points_in_camera.reserve(count);
    pairs.sigmas_m.reserve(count);
}

Correspondences select(const Correspondences& pairs, const std::vector<char>& keep) {
    Correspondences kept;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        if (!keep[k]) continue;
        kept.points_in_object.push_back(pairs.points_in_object[k]);
        kept.normals_in_object.push_back(pairs.normals_in_object[k]);
        kept.points_in_camera.push_back(pairs.points_in_camera[k]);
        kept.sigmas_m.push_back(pairs.sigmas_m[k]);
        if (!pairs.normals_in_camera.empty()) kept.normals_in_camera.push_back(pairs.normals_in_camera[k]);
    }
    return kept;
}

// The rigid motion of three pairs; false where the triple is too flat to define one.
bool motion_of_triple(const Correspondences& pairs, const int (&triple)[3], double min_sine,
                      Eigen::Isometry3d& camera_from_object) {
    Eigen::Matrix3d model, measured;
    for (int c = 0; c < 3; ++c) {
        model.col(c) = pairs.points_in_object[triple[c]].cast<double>();
        measured.col(c) = pairs.points_in_camera[triple[c]].cast<double>();
    }
    const Eigen::Vector3d a = model.col(1) - model.col(0), b = model.col(2) - model.col(0);
    if (!(a.cross(b).norm() > min_sine * a.norm() * b.norm())) return false;
    camera_from_object.matrix() = Eigen::umeyama(model, measured, false);
    return camera_from_object.matrix().allFinite();
}

}  // namespace

Correspondences associate_nearest(const View& view, const Pose& camera_from_object, const Observation& observation,
                                  double max_distance_m) {
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = camera_from_object.translation.cast<float>();
    std::vector<Eigen::Vector3f> queries(view.size());
    for (std::size_t k = 0; k < view.size(); ++k) queries[k] = rotation * view.points_in_object[k] + translation;
    const std::vector<PointIndex::Neighbour> neighbours =
        observation.index().nearest(queries, static_cast<float>(max_distance_m));
    Correspondences pairs;
    reserve(pairs, view.size());
    for (std::size_t k = 0; k < view.size(); ++k) {
        const int index = neighbours[k].index;
        if (index < 0) continue;
        const Eigen::Vector3f& measured = observation.points_in_camera()[index];
        append(pairs, view, k, measured, observation.sensor().sigma_m(measured.z()));
        pairs.normals_in_camera.push_back(observation.normals_in_camera()[index]);
    }
    return pairs;
}

Correspondences associate_projective(const View& view, const Pose& camera_from_object, const Observation& observation,
                                     double max_distance_m, double extra_sigma_m) {
    const PinholeCamera& camera = observation.camera();
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = camera_from_object.translation.cast<float>();
    const double extra_m2 = extra_sigma_m * extra_sigma_m;
    Correspondences pairs;
    reserve(pairs, view.size());
    for (std::size_t k = 0; k < view.size(); ++k) {
        const Eigen::Vector3f point_in_camera = rotation * view.points_in_object[k] + translation;
        if (!(point_in_camera.z() > 0.0F)) continue;
        const Eigen::Vector2d uv = camera.project(point_in_camera.cast<double>());
        const int pixel = camera.pixel_at(uv.x(), uv.y());
        if (pixel < 0 || observation.states()[pixel] != PixelState::kCandidate) continue;
        const float depth_m = observation.depth_m()[pixel];
        if (std::abs(depth_m - point_in_camera.z()) > max_distance_m) continue;
        const double normal_z = rotation.row(2).dot(view.normals_in_object[k]);
        const double variance_m2 =
            observation.sensor().variance_along_normal_m2(observation.sigma_m(depth_m), depth_m, normal_z, camera.fx);
        append(pairs, view, k, observation.point_at(pixel).cast<float>(), std::sqrt(variance_m2 + extra_m2));
    }
    return pairs;
}

Correspondences reject_by_normal(const Correspondences& pairs, const Pose& camera_from_object, double max_angle_rad) {
    if (pairs.normals_in_camera.size() != pairs.size()) return pairs;
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const auto min_cosine = static_cast<float>(std::cos(max_angle_rad));
    std::vector<char> keep(pairs.size());
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const Eigen::Vector3f& measured = pairs.normals_in_camera[k];
        keep[k] = measured.isZero() || measured.dot(rotation * pairs.normals_in_object[k]) >= min_cosine;
    }
    return select(pairs, keep);
}

Correspondences reject_by_sample_consensus(const Correspondences& pairs, const SampleConsensusOptions& options,
                                           RandomStream random) {
    const int count = static_cast<int>(pairs.size());
    if (count < 4) return pairs;
    const auto limit_m2 = static_cast<float>(options.max_distance_m * options.max_distance_m);
    std::vector<char> best(count, 1), support(count);
    int best_count = -1;
    for (int draw = 0; draw < options.draws; ++draw) {
        const int triple[3] = {random.below(count), random.below(count), random.below(count)};
        Eigen::Isometry3d motion;
        if (!motion_of_triple(pairs, triple, options.min_sine, motion)) continue;
        const Eigen::Isometry3f camera_from_object = motion.cast<float>();
        int supporters = 0;
        for (int k = 0; k < count; ++k) {
            const Eigen::Vector3f moved = camera_from_object * pairs.points_in_object[k];
            support[k] = (moved - pairs.points_in_camera[k]).squaredNorm() <= limit_m2;
            supporters += support[k];
        }
        if (supporters > best_count) {
            best_count = supporters;
            best = support;
        }
    }
    return select(pairs, best);
}

}  // namespace nearpose
