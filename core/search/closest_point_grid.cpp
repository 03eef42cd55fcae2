#include "core/search/closest_point_grid.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace nearpose {
namespace {

constexpr double kVoxelDiameters = 1.0 / 80.0;
constexpr int kReachVoxels = 5;
constexpr float kSameSide = 0.7F;  // cosine between the normals of what may be one surface

std::vector<OrientedPoint> surface_of(const ViewGenerator& views) {
    constexpr int kDirections = 128, kSide = 64;
    std::vector<OrientedPoint> surface;
    for (const Eigen::Vector3d& direction : directions_all_around(kDirections)) {
        const View view = view_from(views, direction, kSide);
        for (std::size_t k = 0; k < view.size(); ++k)
            surface.push_back({view.points_in_object[k], view.normals_in_object[k]});
    }
    return surface;
}

}  // namespace

ClosestPointGrid::ClosestPointGrid(const ViewGenerator& views) : centre_in_object_(views.extent().centre_in_object()) {
    const ModelExtent& extent = views.extent();
    const double voxel_m = kVoxelDiameters * extent.diameter_m();
    reach_m_ = kReachVoxels * voxel_m;
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant((kReachVoxels + 0.5) * voxel_m);
    origin_in_object_ = (extent.box_min_in_object - margin).cast<float>();
    voxels_per_m_ = static_cast<float>(1.0 / voxel_m);
    const Eigen::Vector3d size = (extent.box_max_in_object - extent.box_min_in_object + 2.0 * margin) / voxel_m;
    size_ = size.array().ceil().cast<int>() + 1;
    voxels_.assign(static_cast<std::size_t>(size_.x()) * size_.y() * size_.z(), -1);
    put_in(surface_of(views));
    spread(kReachVoxels);
}

// The first sample in each voxel stands for it.
void ClosestPointGrid::put_in(const std::vector<OrientedPoint>& surface) {
    for (const OrientedPoint& point_of_model : surface) {
        const Eigen::Vector3i voxel = ((point_of_model.point - origin_in_object_) * voxels_per_m_).cast<int>();
        if (voxel.minCoeff() < 0 || ((size_ - voxel).array() <= 0).any()) continue;
        int& sample = voxels_[index_of(voxel)];
        if (sample >= 0) continue;
        sample = static_cast<int>(samples_.size());
        samples_.push_back(point_of_model);
    }
}

// Each round every voxel takes over from its neighbours the sample that is nearest to it.
void ClosestPointGrid::spread(int rounds) {
    const auto middle = [&](const Eigen::Vector3i& voxel) -> Eigen::Vector3f {
        return origin_in_object_ + (voxel.cast<float>().array() + 0.5F).matrix() / voxels_per_m_;
    };
    for (int round = 0; round < rounds; ++round) {
        const std::vector<int> before = voxels_;
        for (int z = 1; z + 1 < size_.z(); ++z) {
            for (int y = 1; y + 1 < size_.y(); ++y) {
                for (int x = 1; x + 1 < size_.x(); ++x) {
                    const Eigen::Vector3i voxel(x, y, z);
                    const Eigen::Vector3f here = middle(voxel);
                    int& best = voxels_[index_of(voxel)];
                    float least = best < 0 ? 1e30F : (samples_[best].point - here).squaredNorm();
                    for (int axis = 0; axis < 3; ++axis) {
                        for (const int side : {-1, 1}) {
                            Eigen::Vector3i beside = voxel;
                            beside[axis] += side;
                            const int other = before[index_of(beside)];
                            if (other < 0) continue;
                            const float distance = (samples_[other].point - here).squaredNorm();
                            if (distance >= least) continue;
                            least = distance;
                            best = other;
                        }
                    }
                }
            }
        }
    }
}

double inlier_share_on(const ClosestPointGrid& field, const Pose& camera_from_object,
                       const std::vector<OrientedPoint>& measured, std::size_t count, double tolerance_m) {
    const Pose object_from_camera = camera_from_object.inverse();
    const Eigen::Matrix3f rotation = object_from_camera.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = object_from_camera.translation.cast<float>();
    const auto tolerance = static_cast<float>(tolerance_m);
    const std::size_t end = std::min(count, measured.size());
    int on_surface = 0;
    for (std::size_t k = 0; k < end; ++k) {
        const Eigen::Vector3f point = rotation * measured[k].point + translation;
        const OrientedPoint* surface = field.nearest(point);
        if (surface == nullptr) continue;
        const Eigen::Vector3f off = point - surface->point;
        const float along = surface->normal.dot(off);
        on_surface += std::abs(along) < tolerance && off.squaredNorm() < 4.0F * tolerance * tolerance &&
                      surface->normal.dot(rotation * measured[k].normal) > kSameSide;
    }
    return end > 0 ? static_cast<double>(on_surface) / static_cast<double>(end) : 0.0;
}

Pose aligned_to_surface(const ClosestPointGrid& field, const Pose& camera_from_object,
                        const std::vector<OrientedPoint>& measured, int rounds, double tolerance_m) {
    constexpr float kAlike = 0.5F;                 // cosine: while the pose is still off
    constexpr double kDamping = 1.0;               // points
    const double scale_m = 4.0 * field.reach_m();  // lengths in it weigh as turns
    Pose pose = camera_from_object;
    for (int round = 0; round < rounds; ++round) {
        const Pose object_from_camera = pose.inverse();
        const Eigen::Matrix3f rotation = object_from_camera.rotation_matrix().cast<float>();
        const Eigen::Vector3f translation = object_from_camera.translation.cast<float>();
        const double gate_m = 0.5 * tolerance_m * (rounds - round + 1);  // narrower from round to round
        const Eigen::Vector3f centre = field.centre_in_object().cast<float>();
        const auto gate = static_cast<float>(gate_m);
        Eigen::Matrix<float, 6, 6> A = static_cast<float>(kDamping) * Eigen::Matrix<float, 6, 6>::Identity();
        Eigen::Matrix<float, 6, 1> b = Eigen::Matrix<float, 6, 1>::Zero();
        for (const OrientedPoint& point_of_model : measured) {
            const Eigen::Vector3f point = rotation * point_of_model.point + translation;
            const OrientedPoint* surface = field.nearest(point);
            if (surface == nullptr) continue;
            const Eigen::Vector3f& normal = surface->normal;
            const float off = normal.dot(point - surface->point);
            if (std::abs(off) > gate || normal.dot(rotation * point_of_model.normal) < kAlike) continue;
            // Moving the object by a twist moves the measured point the other way in the object's frame.
            Eigen::Matrix<float, 6, 1> row;
            const Eigen::Vector3f arm = point - centre;
            const float scale = static_cast<float>(scale_m);
            row << (arm.y() * normal.z() - arm.z() * normal.y()) / scale,
                (arm.z() * normal.x() - arm.x() * normal.z()) / scale,
                (arm.x() * normal.y() - arm.y() * normal.x()) / scale, normal;
            A.selfadjointView<Eigen::Lower>().rankUpdate(row);
            b += off / static_cast<float>(scale_m) * row;
        }
        const Eigen::Matrix<float, 6, 1> solved = A.selfadjointView<Eigen::Lower>().ldlt().solve(b);
        // The unknowns are the turn and the shift in units of the scale, as the rows are.
        Twist twist;
        twist << solved.head<3>().cast<double>(), scale_m * solved.tail<3>().cast<double>();
        if (!twist.allFinite()) return pose;
        pose = perturb_about(pose, twist, field.centre_in_object());
    }
    return pose;
}

}  // namespace nearpose
