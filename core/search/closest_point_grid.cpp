#include "core/search/closest_point_grid.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace nearpose {
namespace {

// object_from_camera in single precision, as the grid's points are.
struct ObjectFromCamera {
    explicit ObjectFromCamera(const Pose& camera_from_object) {
        const Pose object_from_camera = camera_from_object.inverse();
        rotation = object_from_camera.rotation_matrix().cast<float>();
        translation = object_from_camera.translation.cast<float>();
    }
    Eigen::Matrix3f rotation;
    Eigen::Vector3f translation;
};

// The normal equations of one point-to-plane step. Unknowns are the turn about the model's centre [rad] and the shift,
// in units of scale_m.
struct PointToPlaneEquations {
    Eigen::Matrix<float, 6, 6> A;
    Eigen::Matrix<float, 6, 1> b = Eigen::Matrix<float, 6, 1>::Zero();
};

PointToPlaneEquations linearise(const ClosestPointGrid& grid, const Pose& camera_from_object,
                                const std::vector<OrientedPoint>& measured, double gate_m, double scale_m,
                                const AlignmentOptions& options) {
    const ObjectFromCamera object_from_camera(camera_from_object);
    const Eigen::Vector3f centre = grid.centre_in_object().cast<float>();
    const auto gate = static_cast<float>(gate_m);
    const auto scale = static_cast<float>(scale_m);
    PointToPlaneEquations equations;
    equations.A = static_cast<float>(options.damping_points) * Eigen::Matrix<float, 6, 6>::Identity();
    for (const OrientedPoint& oriented : measured) {
        const Eigen::Vector3f point = object_from_camera.rotation * oriented.point + object_from_camera.translation;
        const OrientedPoint* surface = grid.nearest(point);
        if (surface == nullptr) continue;
        const Eigen::Vector3f& normal = surface->normal;
        const float off = normal.dot(point - surface->point);
        if (std::abs(off) > gate ||
            normal.dot(object_from_camera.rotation * oriented.normal) < options.min_normal_cosine)
            continue;
        // A twist of the object moves the measured point the other way in the object's frame.
        Eigen::Matrix<float, 6, 1> row;
        const Eigen::Vector3f arm = point - centre;
        row << (arm.y() * normal.z() - arm.z() * normal.y()) / scale,
            (arm.z() * normal.x() - arm.x() * normal.z()) / scale,
            (arm.x() * normal.y() - arm.y() * normal.x()) / scale, normal;
        equations.A.selfadjointView<Eigen::Lower>().rankUpdate(row);
        equations.b += off / scale * row;
    }
    return equations;
}

}  // namespace

ClosestPointGrid::ClosestPointGrid(const ViewGenerator& views, const ClosestPointGridOptions& options)
    : centre_in_object_(views.extent().centre_in_object()) {
    const ModelExtent& extent = views.extent();
    const double voxel_m = options.voxel_diameters * extent.diameter_m();
    reach_m_ = options.reach_voxels * voxel_m;
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant((options.reach_voxels + 0.5) * voxel_m);
    origin_in_object_ = (extent.box_min_in_object - margin).cast<float>();
    voxels_per_m_ = static_cast<float>(1.0 / voxel_m);
    const Eigen::Vector3d size = (extent.box_max_in_object - extent.box_min_in_object + 2.0 * margin) / voxel_m;
    size_ = size.array().ceil().cast<int>() + 1;
    voxels_.assign(static_cast<std::size_t>(size_.x()) * size_.y() * size_.z(), -1);
    insert(surface_seen_all_around(views, options.views));
    propagate(options.reach_voxels);
}

// The first sample in each voxel stands for it.
void ClosestPointGrid::insert(const std::vector<OrientedPoint>& surface) {
    for (const OrientedPoint& oriented : surface) {
        const Eigen::Vector3i voxel = ((oriented.point - origin_in_object_) * voxels_per_m_).cast<int>();
        if (voxel.minCoeff() < 0 || ((size_ - voxel).array() <= 0).any()) continue;
        int& sample = voxels_[index_of(voxel)];
        if (sample >= 0) continue;
        sample = static_cast<int>(samples_.size());
        samples_.push_back(oriented);
    }
}

// Each round the samples reach one voxel farther. The outermost voxels stay empty, so that all others have neighbours.
void ClosestPointGrid::propagate(int rounds) {
    for (int round = 0; round < rounds; ++round) {
        const std::vector<int> before = voxels_;
        for (int z = 1; z + 1 < size_.z(); ++z)
            for (int y = 1; y + 1 < size_.y(); ++y)
                for (int x = 1; x + 1 < size_.x(); ++x) take_nearest_of_neighbours({x, y, z}, before);
    }
}

// Of its own sample and those of its six neighbours in the round `before`, a voxel keeps the one nearest to its middle.
void ClosestPointGrid::take_nearest_of_neighbours(const Eigen::Vector3i& voxel, const std::vector<int>& before) {
    constexpr float kFar = 1e30F;
    const Eigen::Vector3f middle = origin_in_object_ + (voxel.cast<float>().array() + 0.5F).matrix() / voxels_per_m_;
    const std::size_t here = index_of(voxel), row = size_.x(), layer = row * size_.y();
    int& best = voxels_[here];
    float least = best < 0 ? kFar : (samples_[best].point - middle).squaredNorm();
    for (const std::size_t neighbour : {here - 1, here + 1, here - row, here + row, here - layer, here + layer}) {
        const int other = before[neighbour];
        if (other < 0) continue;
        const float distance = (samples_[other].point - middle).squaredNorm();
        if (distance >= least) continue;
        least = distance;
        best = other;
    }
}

double inlier_share(const ClosestPointGrid& grid, const Pose& camera_from_object,
                    const std::vector<OrientedPoint>& measured, std::size_t count, double tolerance_m,
                    const InlierOptions& options) {
    const ObjectFromCamera object_from_camera(camera_from_object);
    const auto tolerance = static_cast<float>(tolerance_m);
    const float max_squared_m2 =
        options.max_distance_tolerances * options.max_distance_tolerances * tolerance * tolerance;
    const std::size_t end = std::min(count, measured.size());
    int inliers = 0;
    for (std::size_t k = 0; k < end; ++k) {
        const Eigen::Vector3f point = object_from_camera.rotation * measured[k].point + object_from_camera.translation;
        const OrientedPoint* surface = grid.nearest(point);
        if (surface == nullptr) continue;
        const Eigen::Vector3f off = point - surface->point;
        const float along_normal = surface->normal.dot(off);
        inliers += std::abs(along_normal) < tolerance && off.squaredNorm() < max_squared_m2 &&
                   surface->normal.dot(object_from_camera.rotation * measured[k].normal) > options.min_normal_cosine;
    }
    return end > 0 ? static_cast<double>(inliers) / static_cast<double>(end) : 0.0;
}

Pose align_to_surface(const ClosestPointGrid& grid, const Pose& camera_from_object,
                      const std::vector<OrientedPoint>& measured, int rounds, double tolerance_m,
                      const AlignmentOptions& options) {
    const double scale_m = options.scale_reaches * grid.reach_m();
    Pose pose = camera_from_object;
    for (int round = 0; round < rounds; ++round) {
        const double gate_m = options.gate_tolerances * tolerance_m * (rounds - round + 1);
        const PointToPlaneEquations equations = linearise(grid, pose, measured, gate_m, scale_m, options);
        const Eigen::Matrix<float, 6, 1> solved = equations.A.selfadjointView<Eigen::Lower>().ldlt().solve(equations.b);
        // The turn comes out in rad, the shift in units of the scale.
        Twist twist;
        twist << solved.head<3>().cast<double>(), scale_m * solved.tail<3>().cast<double>();
        if (!twist.allFinite()) return pose;
        pose = perturb_about(pose, twist, grid.centre_in_object());
    }
    return pose;
}

}  // namespace nearpose
