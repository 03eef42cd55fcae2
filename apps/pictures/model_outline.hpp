// The lines of a model as a camera sees it: its silhouette, edges behind which it goes on deeper, and creases.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::pictures {

enum class Edge : std::uint8_t { kNone, kCrease, kOutline };

// One value a pixel of the part of `camera`'s image that holds the model.
struct OutlineImage {
    int first_u = 0, first_v = 0;  // of that part in the image [pixels]
    int width = 0, height = 0;     // 0 where the model is not in view
    std::vector<Edge> edges;       // row-major
};

OutlineImage find_outline(const EmbreeScene& model, const Pose& camera_from_object, const PinholeCamera& camera);

}  // namespace nearpose::pictures
