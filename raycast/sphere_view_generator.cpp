#include "raycast/sphere_view_generator.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "raycast/embree_scene.hpp"
#include "raycast/point_splat.hpp"

namespace nearpose {
namespace {

void validate(const SphereOptions& options) {
    const auto refuse = [](const std::string& field, double value, const std::string& bound) {
        throw std::invalid_argument("view sphere: " + field + " is " + std::to_string(value) + ", but must be " +
                                    bound);
    };
    if (options.num_viewpoints < 1 || options.num_viewpoints > 100'000) {
        refuse("num_viewpoints", options.num_viewpoints, "in 1..100000");
    }
    if (!(options.radius_in_diameters > 0.5 && options.radius_in_diameters <= 100.0)) {
        refuse("radius_in_diameters", options.radius_in_diameters, "above 0.5 (outside of the object) and up to 100");
    }
    if (options.image_size < 2 || options.image_size > 1024)
        refuse("image_size", options.image_size, "in 2..1024 pixels");
}

// Directions spread evenly over the sphere: heights in equal steps, each turned by the golden angle against the last.
std::vector<Eigen::Vector3d> even_directions(int count) {
    const double golden_angle_rad = std::acos(-1.0) * (3.0 - std::sqrt(5.0));
    std::vector<Eigen::Vector3d> directions;
    for (int i = 0; i < count; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / count;
        const double radius = std::sqrt(1.0 - z * z);
        directions.emplace_back(radius * std::cos(golden_angle_rad * i), radius * std::sin(golden_angle_rad * i), z);
    }
    return directions;
}

// The smallest square image that holds the box's sphere seen from `radius_in_diameters`.
PinholeCamera camera_around_object(const SphereOptions& options) {
    const double sine = 0.5 / options.radius_in_diameters;  // of half the angle under which the sphere is seen
    const double slope = sine / std::sqrt(1.0 - sine * sine);
    const double focal = 0.5 * options.image_size / slope;
    const double centre = 0.5 * (options.image_size - 1);
    return {options.image_size, options.image_size, focal, focal, centre, centre};
}

// camera_from_object of a camera at `distance_m` from `centre_in_object` along `direction`, which looks at the centre.
Pose look_at(const Eigen::Vector3d& centre_in_object, const Eigen::Vector3d& direction, double distance_m) {
    Pose pose;
    pose.rotation = Eigen::Quaterniond::FromTwoVectors(-direction, Eigen::Vector3d::UnitZ()).normalized();
    pose.translation = Eigen::Vector3d(0.0, 0.0, distance_m) - pose.rotation * centre_in_object;
    return pose;
}

}  // namespace

SphereViewGenerator::SphereViewGenerator(const Mesh& mesh, const SphereOptions& options) {
    validate(options);
    const EmbreeScene scene(mesh);
    extent_ = scene.extent();
    camera_ = camera_around_object(options);
    directions_ = even_directions(options.num_viewpoints);
    for (const Eigen::Vector3d& direction : directions_) {
        poses_.push_back(
            look_at(extent_.centre_in_object(), direction, options.radius_in_diameters * extent_.diameter_m()));
        RayHits hits = scene.cast(poses_.back(), camera_);
        views_.push_back({std::move(hits.points_in_object), std::move(hits.normals_in_object)});
    }
}

int SphereViewGenerator::nearest_view(const Pose& camera_from_object) const {
    const Eigen::Vector3d to_camera = camera_from_object.inverse().translation - extent_.centre_in_object();
    std::size_t best = 0;
    for (std::size_t i = 1; i < directions_.size(); ++i) {
        if (directions_[i].dot(to_camera) > directions_[best].dot(to_camera)) best = i;
    }
    return static_cast<int>(best);
}

View SphereViewGenerator::generate(const Pose& camera_from_object, const PinholeCamera& camera) const {
    // nearest_points checks the pose; a NaN direction chooses the first view and harms nothing.
    const SurfaceSamples& view = views_[static_cast<std::size_t>(nearest_view(camera_from_object))];
    return nearest_points(view, camera_from_object, camera);
}

}  // namespace nearpose
