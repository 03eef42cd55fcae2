// Stored views from spheres of several radii: four degrees of freedom, as the paper describes such stores.
#pragma once

#include <vector>

#include "raycast/sphere_view_generator.hpp"

namespace nearpose {

// Radii [diameters] from as close as a sphere around the whole object can be, in steps of ratio 1.5, so that no camera
// between is off by more than 1.22.
inline constexpr double kNestedRadii_diameters[] = {0.6, 0.9, 1.35, 2.0};
// The options of one sphere for each of these radii; everything else as by default.
std::vector<SphereOptions> nested_spheres();

// Views stored from a single radius have the wrong perspective wherever the camera is nearer or farther. Here the
// sphere whose radius is nearest to the camera's distance (by ratio) gives the view. Distance, yaw, pitch and roll are
// then right to the steps between stored views; the object's offset from the optical axis is not taken into account.
class NestedSpheresGenerator : public ViewGenerator {
  public:
    // One sphere for each entry, at least one. Throws std::invalid_argument.
    NestedSpheresGenerator(const Mesh& mesh, const std::vector<SphereOptions>& spheres);

    View generate(const Pose& camera_from_object, const PinholeCamera& camera) const override;
    const ModelExtent& extent() const override { return spheres_.front().extent(); }

    // Which sphere a pose gets its view from.
    const SphereViewGenerator& sphere_of(const Pose& camera_from_object) const;

  private:
    std::vector<double> radii_in_diameters_;
    std::vector<SphereViewGenerator> spheres_;
};

}  // namespace nearpose
