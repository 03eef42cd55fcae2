#include "tests/bench/naive/point_to_plane.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

namespace nearpose::bench::naive {
namespace {

// The measured points of one image.
class Measured {
  public:
    Measured(const DepthImage& depth, const Mask* mask, const PinholeCamera& camera)
        : depth_(depth), mask_(mask), camera_(camera) {}

    // Nothing without depth there, or beside the mask.
    std::optional<Eigen::Vector3d> at(int u, int v) const {
        if (u < 0 || v < 0 || u >= camera_.width || v >= camera_.height) return std::nullopt;
        const auto pixel = static_cast<std::size_t>(v * camera_.width + u);
        const double depth_m = depth_.depth_m[pixel];
        if (!(depth_m > 0.0) || (mask_ != nullptr && mask_->value[pixel] == 0)) return std::nullopt;
        return depth_m * camera_.ray(u, v);
    }

    std::optional<Eigen::Vector3d> partner_of(const Eigen::Vector3d& point, const PlaneFitOptions& options) const {
        if (!(point.z() > 0.0)) return std::nullopt;
        const Eigen::Vector2d place = camera_.project(point);
        if (camera_.pixel_at(place.x(), place.y()) < 0) return std::nullopt;
        const int u = static_cast<int>(std::lround(place.x())), v = static_cast<int>(std::lround(place.y()));
        if (options.pairing == Pairing::kNearest) return nearest_around(u, v, point, options.gate_m);
        const std::optional<Eigen::Vector3d> measured = at(u, v);
        return measured && (*measured - point).norm() <= options.gate_m ? measured : std::nullopt;
    }

  private:
    // All pixels that a point within the gate can fall into.
    std::optional<Eigen::Vector3d> nearest_around(int u, int v, const Eigen::Vector3d& point, double gate_m) const {
        const int reach = static_cast<int>(std::ceil(gate_m * camera_.fx / point.z()));
        std::optional<Eigen::Vector3d> best;
        double best_m = gate_m;
        for (int dv = -reach; dv <= reach; ++dv) {
            for (int du = -reach; du <= reach; ++du) {
                const std::optional<Eigen::Vector3d> measured = at(u + du, v + dv);
                if (!measured || (*measured - point).norm() > best_m) continue;
                best = measured;
                best_m = (*measured - point).norm();
            }
        }
        return best;
    }

    const DepthImage& depth_;
    const Mask* mask_;
    const PinholeCamera& camera_;
};

struct Equations {
    Matrix6d matrix = Matrix6d::Zero();  // of the twist, in object axes
    Twist right = Twist::Zero();
    double cost = 0.0;  // mean over the model's points; one without a partner costs what one at the gate does
};

Equations equations_at(const Pose& pose, const SeenSurface& seen, const Measured& measured,
                       const PlaneFitOptions& options) {
    const auto cauchy = [&](double residual_m) { return std::log1p(std::pow(residual_m / options.scale_m, 2)); };
    Equations equations;
    for (std::size_t k = 0; k < seen.points_in_object.size(); ++k) {
        const Eigen::Vector3d point_in_object = seen.points_in_object[k].cast<double>();
        const Eigen::Vector3d normal_in_object = seen.normals_in_object[k].cast<double>();
        const Eigen::Vector3d point = pose * point_in_object;
        const std::optional<Eigen::Vector3d> partner = measured.partner_of(point, options);
        if (!partner) {
            equations.cost += cauchy(options.gate_m);
            continue;
        }
        const double residual_m = (pose.rotation * normal_in_object).dot(*partner - point);
        Twist row;
        row << point_in_object.cross(normal_in_object), normal_in_object;
        const double weight = 1.0 / (1.0 + std::pow(residual_m / options.scale_m, 2));
        equations.matrix += weight * row * row.transpose();
        equations.right += weight * residual_m * row;
        equations.cost += cauchy(residual_m);
    }
    equations.cost /= std::max<double>(1.0, static_cast<double>(seen.points_in_object.size()));
    return equations;
}

Pose stepped(const Pose& pose, const Equations& equations, double damping) {
    Matrix6d damped = equations.matrix;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-12;  // where nothing was paired
    return pose * exp(damped.ldlt().solve(equations.right));
}

}  // namespace

Pose fit_point_to_plane(const Pose& start, const SingleRayViews& views, const DepthImage& depth, const Mask* mask,
                        const PinholeCamera& camera, const PlaneFitOptions& options) {
    const Measured measured(depth, mask, camera);
    Pose pose = start;
    double damping = 1e-3;
    SeenSurface seen;
    Equations equations;
    for (int round = 0; round < options.rounds; ++round) {
        if (round % options.rounds_a_view == 0) {
            seen = views.generate(pose, quarter_camera(camera));
            equations = equations_at(pose, seen, measured, options);
        }
        const Pose next = stepped(pose, equations, damping);
        const Equations there = equations_at(next, seen, measured, options);
        const bool better = there.cost <= equations.cost;
        damping = better ? std::max(1e-6, 0.3 * damping) : 10.0 * damping;
        if (!better) continue;
        pose = next;
        equations = there;
    }
    return pose;
}

double explained_share(const Pose& camera_from_object, const SingleRayViews& views, const DepthImage& depth,
                       const Mask& mask, const PinholeCamera& camera, double within_m) {
    const PinholeCamera coarse = quarter_camera(camera);
    const int stride = camera.width / coarse.width;
    const SeenSurface seen = views.generate(camera_from_object, coarse);
    const Measured measured(depth, &mask, camera);
    int with_depth = 0, explained = 0;
    for (int v = 0; v < coarse.height; ++v)
        for (int u = 0; u < coarse.width; ++u) with_depth += measured.at(u * stride, v * stride) ? 1 : 0;
    for (std::size_t k = 0; k < seen.points_in_object.size(); ++k) {
        const Eigen::Vector3d point = camera_from_object * seen.points_in_object[k].cast<double>();
        const Eigen::Vector2d place = camera.project(point);
        const std::optional<Eigen::Vector3d> there =
            measured.at(static_cast<int>(std::lround(place.x())), static_cast<int>(std::lround(place.y())));
        if (!there) continue;
        const Eigen::Vector3d normal = camera_from_object.rotation * seen.normals_in_object[k].cast<double>();
        explained += std::abs(normal.dot(*there - point)) <= within_m ? 1 : 0;
    }
    return with_depth > 0 ? explained / static_cast<double>(with_depth) : 0.0;
}

}  // namespace nearpose::bench::naive
