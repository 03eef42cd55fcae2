#include "raycast/surface_samples.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace nearpose {
namespace {

// Uniform in [0, 1), addressed by (seed, index): splitmix64.
double uniform(std::uint64_t seed, std::uint64_t index) {
    std::uint64_t z = seed + (index + 1) * 0x9E3779B97F4A7C15U;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    z ^= z >> 31U;
    return static_cast<double>(z >> 11U) * 0x1.0p-53;
}

struct Corners {
    Eigen::Vector3d a, b, c;
    Eigen::Vector3d normal() const { return (b - a).cross(c - a); }  // its length is twice the area
};

Corners corners_of(const Mesh& mesh, std::size_t triangle) {
    const auto corner = [&](std::size_t k) -> Eigen::Vector3d {
        return mesh.vertices_in_object[static_cast<std::size_t>(mesh.triangles[triangle][k])].cast<double>();
    };
    return {corner(0), corner(1), corner(2)};
}

SurfaceSamples sample_cloud(const Mesh& mesh, std::size_t count) {
    if (mesh.vertex_normals_in_object.size() != mesh.vertices_in_object.size()) {
        throw std::invalid_argument("samples of a cloud need its normals");
    }
    const std::size_t num_points = mesh.vertices_in_object.size();
    const std::size_t num_samples = std::min(count, num_points);
    SurfaceSamples samples;
    for (std::size_t i = 0; i < num_samples; ++i) {
        const std::size_t point = i * num_points / num_samples;
        samples.points_in_object.push_back(mesh.vertices_in_object[point]);
        samples.normals_in_object.push_back(mesh.vertex_normals_in_object[point]);
    }
    return samples;
}

}  // namespace

SurfaceSamples sample_surface(const Mesh& mesh, int count, std::uint64_t seed) {
    if (count < 1)
        throw std::invalid_argument("the number of surface samples is " + std::to_string(count) + ", not 1 or more");
    const auto num_samples = static_cast<std::size_t>(count);
    if (mesh.is_cloud()) return sample_cloud(mesh, num_samples);

    std::vector<double> area_up_to(mesh.triangles.size());  // doubled; its scale does not matter
    double total = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        total += corners_of(mesh, t).normal().norm();
        area_up_to[t] = total;
    }
    if (!(total > 0.0) || !std::isfinite(total)) throw std::invalid_argument("samples need a mesh with an area");

    SurfaceSamples samples;
    samples.points_in_object.reserve(num_samples);
    samples.normals_in_object.reserve(num_samples);
    for (std::size_t i = 0; i < num_samples; ++i) {
        const double area = (static_cast<double>(i) + uniform(seed, 3 * i)) / count * total;
        // The first triangle whose end lies beyond; never one without area.
        const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end(), area);
        const std::size_t t = std::min(static_cast<std::size_t>(found - area_up_to.begin()), mesh.triangles.size() - 1);
        const Corners corners = corners_of(mesh, t);
        // The square root makes the density even: without it points would crowd at corner a.
        const double away_from_a = std::sqrt(uniform(seed, 3 * i + 1));
        const double towards_c = uniform(seed, 3 * i + 2);
        const Eigen::Vector3d point = (1.0 - away_from_a) * corners.a + away_from_a * (1.0 - towards_c) * corners.b +
                                      away_from_a * towards_c * corners.c;
        samples.points_in_object.emplace_back(point.cast<float>());
        samples.normals_in_object.emplace_back(corners.normal().normalized().cast<float>());
    }
    return samples;
}

}  // namespace nearpose
