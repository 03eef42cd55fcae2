// Views by projection of surface samples: the paper's rasteriser.
#pragma once

#include <cstdint>

#include "core/view_generator.hpp"
#include "raycast/surface_samples.hpp"

namespace nearpose {

// How samples hide each other (see fitted_buffer.hpp).
enum class RasterBuffer {
    kSplats,  // behind discs of the samples' size
    kCells,   // one is kept of each cell of the samples' size
    kAsRays,  // one is kept of each pixel of the view. Close up pixels outnumber samples, and hidden surface shows
};

struct RasterOptions {
    int num_samples = 20000;
    std::uint64_t seed = 1;
    RasterBuffer buffer = RasterBuffer::kSplats;
    // Samples on a splat or cell, on average. Of samples that fall at random six leave exp(-6) = 0.25 % of a surface
    // open; the more, the fewer points beside edges (splats) or altogether (cells).
    double coverage = 6.0;
};

// Samples of the surface, drawn once, are projected onto a depth buffer, which drops those that lie behind others.
class RasterViewGenerator : public ViewGenerator {
  public:
    // Throws std::invalid_argument for options out of range.
    explicit RasterViewGenerator(const Mesh& mesh, const RasterOptions& options = {});

    View generate(const Pose& camera_from_object, const PinholeCamera& camera) const override;
    const ModelExtent& extent() const override { return extent_; }

    // Of a splat or cell: coverage * area of the surface / samples.
    double cell_area_m2() const { return cell_area_m2_; }

  private:
    SurfaceSamples samples_;
    ModelExtent extent_;
    RasterBuffer buffer_;
    double cell_area_m2_ = 0.0;
};

}  // namespace nearpose
