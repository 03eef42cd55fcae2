// Views by projection of surface samples: the paper's rasteriser.
#pragma once

#include <cstdint>

#include "core/view_generator.hpp"
#include "raycast/surface_samples.hpp"

namespace nearpose {

struct RasterOptions {
    int num_samples = 20000;
    std::uint64_t seed = 1;
};

// Samples of the surface, drawn once, are projected onto a depth buffer of the camera's image, and each pixel keeps the
// nearest. Where the camera is close, pixels outnumber samples, and what lies behind shows through the gaps.
class RasterViewGenerator : public ViewGenerator {
  public:
    explicit RasterViewGenerator(const Mesh& mesh, const RasterOptions& options = {});

    View generate(const Pose& camera_from_object, const PinholeCamera& camera) const override;
    const ModelExtent& extent() const override { return extent_; }

  private:
    SurfaceSamples samples_;
    ModelExtent extent_;
};

}  // namespace nearpose
