#include "core/base/camera.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace nearpose {

PixelGrid grid_over(const PixelBox& box, int max_pixels) {
    const int width = box.last_u - box.first_u;
    const int height = box.last_v - box.first_v;
    if (width <= 0 || height <= 0 || max_pixels < 1) return {};
    const double pixels = static_cast<double>(width) * height;
    const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / max_pixels))));
    // Half a stride in from the edge, so that each grid pixel stands in the middle of the square of pixels that it
    // represents.
    return {box.first_u + (stride - 1) / 2, box.first_v + (stride - 1) / 2, stride, std::max(1, width / stride),
            std::max(1, height / stride)};
}

PinholeCamera camera_of(const PixelGrid& grid, const PinholeCamera& camera) {
    const double stride = grid.stride;
    return {grid.width,
            grid.height,
            camera.fx / stride,
            camera.fy / stride,
            (camera.cx - grid.first_u) / stride,
            (camera.cy - grid.first_v) / stride};
}

void validate(const PinholeCamera& camera) {
    const auto refuse = [](const std::string& field, double value, const std::string& bound) {
        throw std::invalid_argument("camera: " + field + " is " + std::to_string(value) + ", but must be " + bound);
    };
    constexpr int kMaxSide = 16384;
    if (camera.width < 1 || camera.width > kMaxSide) refuse("width", camera.width, "in 1..16384 pixels");
    if (camera.height < 1 || camera.height > kMaxSide) refuse("height", camera.height, "in 1..16384 pixels");
    if (!(camera.fx > 0.0) || !std::isfinite(camera.fx)) refuse("fx", camera.fx, "positive and finite");
    if (!(camera.fy > 0.0) || !std::isfinite(camera.fy)) refuse("fy", camera.fy, "positive and finite");
    if (!std::isfinite(camera.cx)) refuse("cx", camera.cx, "finite");
    if (!std::isfinite(camera.cy)) refuse("cy", camera.cy, "finite");
}

}  // namespace nearpose
