#include "tests/core/analytic_part.hpp"

#include <Eigen/Cholesky>
#include <limits>

namespace nearpose::test {

std::vector<Box> asymmetric_part() {
    return {{{-0.10, -0.07, -0.03}, {0.10, 0.07, 0.03}},
            {{-0.09, -0.06, 0.03}, {-0.03, 0.01, 0.09}},
            {{0.04, 0.02, 0.03}, {0.09, 0.06, 0.05}}};
}

BoxViewGenerator::BoxViewGenerator(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
    extent_ = {boxes_[0].min, boxes_[0].max};
    for (const Box& box : boxes_) {
        extent_.box_min_in_object = extent_.box_min_in_object.cwiseMin(box.min);
        extent_.box_max_in_object = extent_.box_max_in_object.cwiseMax(box.max);
    }
}

View BoxViewGenerator::generate(const Pose& camera_from_object, const PinholeCamera& camera) const {
    const Pose object_from_camera = camera_from_object.inverse();
    View view;
    for (int pixel = 0; pixel < camera.width * camera.height; ++pixel) {
        const Eigen::Vector3d ray = camera.ray(pixel % camera.width, pixel / camera.width);
        const Eigen::Vector3d direction = object_from_camera.rotation * ray;
        Eigen::Vector3d normal;
        const double z = nearest_hit(object_from_camera.translation, direction, normal);
        if (!(z < std::numeric_limits<double>::infinity())) continue;
        view.points_in_object.push_back((object_from_camera.translation + z * direction).cast<float>());
        view.normals_in_object.push_back(normal.cast<float>());
        view.pixels.push_back(pixel);
    }
    return view;
}

double BoxViewGenerator::nearest_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                     Eigen::Vector3d& normal) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Box& box : boxes_) {
        double enter = 0.0, leave = std::numeric_limits<double>::infinity();
        int axis_of_entry = -1;
        for (int axis = 0; axis < 3; ++axis) {
            const double a = (box.min[axis] - origin[axis]) / direction[axis];
            const double b = (box.max[axis] - origin[axis]) / direction[axis];
            if (std::min(a, b) > enter) {
                enter = std::min(a, b);
                axis_of_entry = axis;
            }
            leave = std::min(leave, std::max(a, b));
        }
        if (axis_of_entry < 0 || enter > leave || enter >= nearest) continue;
        nearest = enter;
        normal = Eigen::Vector3d::Zero();
        normal[axis_of_entry] = direction[axis_of_entry] > 0.0 ? -1.0 : 1.0;
    }
    return nearest;
}

SolveResult GaussNewtonSolver::solve(const Correspondences& pairs, const Pose& camera_from_object) const {
    SolveResult result{camera_from_object, 0.0, 0.0, SolveStatus::kConverged};
    if (pairs.size() < 6) {
        result.status = SolveStatus::kTooFewPairs;
        return result;
    }
    for (int iteration = 0; iteration < 3; ++iteration) {
        Matrix6d A = 1e-3 * Matrix6d::Identity();
        Twist b = Twist::Zero();
        const Pose object_from_camera = result.camera_from_object.inverse();
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            const Eigen::Vector3d p = pairs.points_in_object[k].cast<double>();
            const Eigen::Vector3d n = pairs.normals_in_object[k].cast<double>();
            const double r = n.dot(p - object_from_camera * pairs.points_in_camera[k].cast<double>());
            const double sigma = pairs.sigmas_m[k];
            const double weight = 1.0 / (sigma * sigma) / (1.0 + r * r / (4.0 * sigma * sigma));
            Twist J;
            J << p.cross(n), n;
            A += weight * J * J.transpose();
            b -= weight * r * J;
        }
        result.camera_from_object = result.camera_from_object * exp(A.ldlt().solve(b));
    }
    return result;
}

PinholeCamera small_camera() {
    return {160, 120, 150.0, 150.0, 79.5, 59.5};
}

DepthImage render(const ViewGenerator& part, const Pose& pose, const PinholeCamera& camera, float wall_m, Mask* mask) {
    const std::size_t pixels = static_cast<std::size_t>(camera.width) * camera.height;
    DepthImage image{camera.width, camera.height, std::vector<float>(pixels, wall_m)};
    if (mask) *mask = {camera.width, camera.height, std::vector<std::uint8_t>(pixels, 0)};
    const View view = part.generate(pose, camera);
    for (std::size_t k = 0; k < view.size(); ++k) {
        image.depth_m[view.pixels[k]] = static_cast<float>((pose * view.points_in_object[k].cast<double>()).z());
        if (mask) mask->value[view.pixels[k]] = 255;
    }
    return image;
}

}  // namespace nearpose::test
