#include "raycast/nested_spheres_generator.hpp"

#include <cmath>
#include <stdexcept>

namespace nearpose {

std::vector<SphereOptions> nested_spheres() {
    std::vector<SphereOptions> spheres;
    for (const double radius : kNestedRadii_diameters) {
        spheres.emplace_back();
        spheres.back().radius_in_diameters = radius;
    }
    return spheres;
}

NestedSpheresGenerator::NestedSpheresGenerator(const Mesh& mesh, const std::vector<SphereOptions>& spheres) {
    if (spheres.empty()) throw std::invalid_argument("nested spheres: there must be at least one");
    for (const SphereOptions& options : spheres) {
        radii_in_diameters_.push_back(options.radius_in_diameters);
        spheres_.emplace_back(mesh, options);
    }
}

const SphereViewGenerator& NestedSpheresGenerator::sphere_of(const Pose& camera_from_object) const {
    const double distance_m = (camera_from_object * extent().centre_in_object()).norm();
    const double in_diameters = std::max(1e-9, distance_m / extent().diameter_m());
    std::size_t best = 0;
    double best_ratio = HUGE_VAL;
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
        const double ratio = std::abs(std::log(radii_in_diameters_[i] / in_diameters));
        if (!(ratio < best_ratio)) continue;  // of a NaN pose the first, which refuses it
        best_ratio = ratio;
        best = i;
    }
    return spheres_[best];
}

View NestedSpheresGenerator::generate(const Pose& camera_from_object, const PinholeCamera& camera) const {
    return sphere_of(camera_from_object).generate(camera_from_object, camera);
}

}  // namespace nearpose
