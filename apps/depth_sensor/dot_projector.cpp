#include "apps/depth_sensor/dot_projector.hpp"

#include <algorithm>
#include <cmath>

#include "apps/base/simulation_draws.hpp"

namespace nearpose::simulate {
namespace {

// As wide as the dots, as fine as the image.
PinholeCamera shadow_camera(const PinholeCamera& camera, const StereoRig& rig) {
    constexpr double kMaxSide = 4096.0;
    PinholeCamera map;
    map.fx = std::min(camera.fx, kMaxSide / rig.projector_width_tan);
    map.fy = std::min(camera.fy, kMaxSide / rig.projector_height_tan);
    map.width = std::max(1, static_cast<int>(rig.projector_width_tan * map.fx));
    map.height = std::max(1, static_cast<int>(rig.projector_height_tan * map.fy));
    map.cx = 0.5 * (map.width - 1);
    map.cy = 0.5 * (map.height - 1);
    return map;
}

}  // namespace

DotPattern::DotPattern(const StereoRig& rig, std::uint64_t seed)
    : half_width_(0.5 * rig.projector_width_tan),
      half_height_(0.5 * rig.projector_height_tan),
      squared_sigma_(rig.dot_sigma_tan * rig.dot_sigma_tan) {
    const double cell = std::sqrt(rig.projector_width_tan * rig.projector_height_tan / std::max(1, rig.dots));
    columns_ = std::max(1, static_cast<int>(std::lround(rig.projector_width_tan / cell)));
    rows_ = std::max(1, static_cast<int>(std::lround(rig.projector_height_tan / cell)));
    cell_width_ = rig.projector_width_tan / columns_;
    cell_height_ = rig.projector_height_tan / rows_;
    if (rig.dots == 0) return;
    for (int k = 0; k < columns_ * rows_; ++k) {
        RandomStream draw(seed, 0, static_cast<std::uint64_t>(k), kDotDraw);
        const double x = (k % columns_ + draw.uniform()) * cell_width_ - half_width_;
        const double y = (k / columns_ + draw.uniform()) * cell_height_ - half_height_;
        dots_.push_back({x, y, draw.uniform(0.5, 1.5)});
    }
}

double DotPattern::at(double x, double y) const {
    if (dots_.empty() || !(std::abs(x) < half_width_ && std::abs(y) < half_height_)) return 0.0;
    constexpr double kReach = 16.0;  // squared, of the profile's sigma: beyond it a dot adds less than 0.001
    const int column = static_cast<int>((x + half_width_) / cell_width_);
    const int row = static_cast<int>((y + half_height_) / cell_height_);
    double sum = 0.0;
    for (int j = std::max(0, row - 1); j <= std::min(rows_ - 1, row + 1); ++j) {
        for (int i = std::max(0, column - 1); i <= std::min(columns_ - 1, column + 1); ++i) {
            const Dot& dot = dots_[static_cast<std::size_t>(j) * columns_ + i];
            const double squared = ((x - dot.x) * (x - dot.x) + (y - dot.y) * (y - dot.y)) / squared_sigma_;
            if (squared < kReach) sum += dot.brightness * std::exp(-0.5 * squared);
        }
    }
    return sum;
}

DotProjector::DotProjector(const RenderFrom& render, const PinholeCamera& camera, const StereoRig& rig,
                           std::uint64_t seed)
    : position_in_left_(rig.projector_m, 0.0, 0.0),
      pattern_(rig, seed),
      shadow_camera_(shadow_camera(camera, rig)),
      lit_(render({Eigen::Quaterniond::Identity(), -position_in_left_}, shadow_camera_)) {}

double DotProjector::light_at(const Eigen::Vector3d& point_in_left) const {
    const Eigen::Vector3d point = point_in_left - position_in_left_;
    if (!(point.z() > 0.0)) return 0.0;
    const double pattern = pattern_.at(point.x() / point.z(), point.y() / point.z());
    return pattern > 0.0 && reaches(point) ? pattern / point.squaredNorm() : 0.0;
}

// A point is lit where one of the four surfaces seen around its direction goes on to it, or ends behind it: a depth
// alone would have to be compared with a tolerance that a slope takes from pixel to pixel.
bool DotProjector::reaches(const Eigen::Vector3d& point_in_projector) const {
    constexpr double kTolerance = 0.002;  // of the depth
    const Eigen::Vector3d ray = point_in_projector / point_in_projector.z();
    const Eigen::Vector2d uv = shadow_camera_.project(point_in_projector);
    const int first_u = static_cast<int>(std::floor(uv.x())), first_v = static_cast<int>(std::floor(uv.y()));
    for (int corner = 0; corner < 4; ++corner) {
        const int u = std::clamp(first_u + corner % 2, 0, shadow_camera_.width - 1);
        const int v = std::clamp(first_v + corner / 2, 0, shadow_camera_.height - 1);
        const std::size_t pixel = static_cast<std::size_t>(v) * shadow_camera_.width + u;
        double surface_m = lit_.depth.depth_m[pixel];
        if (surface_m == 0.0) return true;
        const Eigen::Vector3d normal = lit_.normals_in_camera[pixel].cast<double>();
        const double slope = normal.dot(ray);
        if (std::abs(slope) > 0.02) surface_m *= normal.dot(shadow_camera_.ray(u, v)) / slope;
        if (point_in_projector.z() <= (1.0 + kTolerance) * surface_m) return true;
    }
    return false;
}

}  // namespace nearpose::simulate
