// One cell of the comparison of views: from settings to named numbers.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "apps/scenes/scenario.hpp"
#include "apps/view_quality/view_quality.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::compare {

// The camera looks at a point of the upper face from the sweep scenario's line of sight.
struct ViewCell {
    std::string views = "raycast";  // one of program::view_names
    // Of the rasteriser, on the whole surface. The images that view spheres store get the resolution that puts as many
    // points on a square metre that faces the camera; ray casting has no samples.
    int view_samples = 20000;
    double distance_mm = 400.0;  // of the camera from the aimed point of the surface
    std::uint64_t seed = 1;      // of the line of sight: the same as that of a sweep of this seed
    int max_rays = 64 * 48;
    int viewpoints = 642;                  // of each view sphere
    double sphere_radius_diameters = 2.0;  // of "sphere"
    int timed_views = 200;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const ViewCell& cell);

struct NamedNumber {
    std::string name;
    double value = 0.0;
};

// A part with all that the cells of its comparison share. Generators are built when they are first asked for, and
// kept. May be used from several threads at once.
class ViewBench {
  public:
    ViewBench(const Mesh& mesh, const simulate::Part& part, const PinholeCamera& image_camera);

    ViewQuality quality(const ViewCell& cell) const;

    // points_per_view, pixels_per_view, wrong_percent, hidden_percent, missing_percent, mean_distance_mm,
    // distance_95_mm, max_distance_mm, cpu_ms_per_200_views, raycast_cpu_ms_per_200_views, cpu_ratio_to_raycast; the
    // last three only where the time was taken, and none for a line of sight that meets nothing.
    std::vector<NamedNumber> numbers(const ViewCell& cell) const;

    // The generator that `cell` is about.
    std::shared_ptr<const ViewGenerator> generator(const ViewCell& cell) const;

    // Side of the images that a sphere of this radius stores to be as dense as `view_samples` of the surface [pixels].
    int sphere_image_size(int view_samples, double radius_diameters) const;

  private:
    using Key = std::tuple<std::string, int, int, double>;  // views, samples, viewpoints, radius; 0 where it has none
    std::shared_ptr<const ViewGenerator> make_generator(const ViewCell& cell) const;

    Mesh mesh_;
    simulate::Part part_;
    PinholeCamera image_camera_;
    EmbreeScene truth_;
    double area_m2_ = 0.0;
    mutable std::mutex mutex_;
    mutable std::map<Key, std::shared_ptr<const ViewGenerator>> generators_;
};

}  // namespace nearpose::compare
