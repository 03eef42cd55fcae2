// The depth image of a frame as the page shows it: two grey PNGs that the page colours.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/depth_image.hpp"
#include "core/base/pose.hpp"
#include "core/observation/observation.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::report {

struct GreyPicture {
    int width = 0, height = 0;  // [pixels]
    std::vector<std::uint8_t> grey;
};

struct DepthPicture {
    double near_m = 0.0, far_m = 0.0;  // what 1 and 255 stand for
    GreyPicture depth;                 // at most 320 wide; 0: no measurement
    GreyPicture lines;                 // twice as fine; bits of kLine...
};

inline constexpr std::uint8_t kLineCrease = 1, kLineOutline = 2;  // of the model at the estimate
inline constexpr std::uint8_t kLineMaskBorder = 4, kLineBackground = 8;

DepthPicture depth_picture(const Observation& observation, const std::optional<Mask>& mask, const EmbreeScene& model,
                           const std::optional<Pose>& camera_from_object);

}  // namespace nearpose::report
