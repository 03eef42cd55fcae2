#include "apps/report/depth_picture.hpp"

#include <algorithm>
#include <cmath>

#include "apps/pictures/model_outline.hpp"

namespace nearpose::report {
namespace {

constexpr int kMaxWidth = 320;  // of the depth [pixels]
constexpr int kLinesFiner = 2;

// Nearly all measurements of the object, or of everything where nothing is known of it.
void choose_range(const Observation& observation, DepthPicture& picture) {
    std::vector<float> depths_m;
    for (const PixelState wanted : {PixelState::kCandidate, PixelState::kBackground}) {
        for (std::size_t i = 0; i < observation.states().size() && depths_m.size() < 4'000'000; ++i) {
            if (observation.states()[i] == wanted) depths_m.push_back(observation.depth_m()[i]);
        }
        if (!depths_m.empty()) break;
    }
    if (depths_m.empty()) depths_m = {0.0F, 1.0F};
    const auto rank = [&](double fraction) {
        const auto place =
            depths_m.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(depths_m.size() - 1));
        std::nth_element(depths_m.begin(), place, depths_m.end());
        return static_cast<double>(*place);
    };
    const double low_m = rank(0.01), high_m = rank(0.99);
    const double margin_m = std::max(0.05 * (high_m - low_m), 0.002);
    picture.near_m = std::max(0.0, low_m - margin_m);
    picture.far_m = high_m + margin_m;
}

std::uint8_t grey_of(double depth_m, const DepthPicture& picture) {
    const double fraction = (depth_m - picture.near_m) / (picture.far_m - picture.near_m);
    return static_cast<std::uint8_t>(std::lround(1.0 + 254.0 * std::clamp(fraction, 0.0, 1.0)));
}

// The middle one of the measurements in a block of `factor` x `factor` pixels; 0 where most of them are missing.
float block_depth_m(const Observation& observation, int factor, int block_u, int block_v) {
    std::vector<float> depths_m;
    for (int v = block_v * factor; v < (block_v + 1) * factor; ++v) {
        for (int u = block_u * factor; u < (block_u + 1) * factor; ++u) {
            const float depth_m = observation.depth_m()[static_cast<std::size_t>(v) * observation.camera().width + u];
            if (depth_m > 0.0F) depths_m.push_back(depth_m);
        }
    }
    if (2 * depths_m.size() < static_cast<std::size_t>(factor) * factor) return 0.0F;
    const auto middle = depths_m.begin() + static_cast<std::ptrdiff_t>(depths_m.size() / 2);
    std::nth_element(depths_m.begin(), middle, depths_m.end());
    return *middle;
}

void draw_mask(const Mask& mask, GreyPicture& lines) {
    const auto inside = [&](int x, int y) {
        const int u = std::min(x * mask.width / lines.width, mask.width - 1);
        const int v = std::min(y * mask.height / lines.height, mask.height - 1);
        return mask.value[static_cast<std::size_t>(v) * mask.width + u] != 0;
    };
    for (int y = 0; y < lines.height; ++y) {
        for (int x = 0; x < lines.width; ++x) {
            std::uint8_t& value = lines.grey[static_cast<std::size_t>(y) * lines.width + x];
            if (!inside(x, y)) {
                value |= kLineBackground;
                continue;
            }
            const bool border = (x > 0 && !inside(x - 1, y)) || (x + 1 < lines.width && !inside(x + 1, y)) ||
                                (y > 0 && !inside(x, y - 1)) || (y + 1 < lines.height && !inside(x, y + 1));
            if (border) value |= kLineMaskBorder;
        }
    }
}

void draw_model(const EmbreeScene& model, const Pose& pose, const PinholeCamera& camera, double scale,
                GreyPicture& lines) {
    const PinholeCamera fine{lines.width,
                             lines.height,
                             camera.fx * scale,
                             camera.fy * scale,
                             (camera.cx + 0.5) * scale - 0.5,
                             (camera.cy + 0.5) * scale - 0.5};
    const pictures::OutlineImage outline = pictures::find_outline(model, pose, fine);
    for (int v = 0; v < outline.height; ++v) {
        for (int u = 0; u < outline.width; ++u) {
            const pictures::Edge edge = outline.edges[static_cast<std::size_t>(v) * outline.width + u];
            if (edge == pictures::Edge::kNone) continue;
            lines.grey[static_cast<std::size_t>(outline.first_v + v) * lines.width + outline.first_u + u] |=
                edge == pictures::Edge::kOutline ? kLineOutline : kLineCrease;
        }
    }
}

}  // namespace

DepthPicture depth_picture(const Observation& observation, const std::optional<Mask>& mask, const EmbreeScene& model,
                           const std::optional<Pose>& camera_from_object) {
    const PinholeCamera& camera = observation.camera();
    const int factor = (camera.width + kMaxWidth - 1) / kMaxWidth;
    DepthPicture picture;
    choose_range(observation, picture);
    picture.depth = {std::max(1, camera.width / factor), std::max(1, camera.height / factor), {}};
    for (int v = 0; v < picture.depth.height; ++v) {
        for (int u = 0; u < picture.depth.width; ++u) {
            const bool there = (u + 1) * factor <= camera.width && (v + 1) * factor <= camera.height;
            const float depth_m = there ? block_depth_m(observation, factor, u, v) : 0.0F;
            picture.depth.grey.push_back(depth_m > 0.0F ? grey_of(depth_m, picture) : std::uint8_t{0});
        }
    }
    picture.lines = {kLinesFiner * picture.depth.width, kLinesFiner * picture.depth.height, {}};
    picture.lines.grey.assign(static_cast<std::size_t>(picture.lines.width) * picture.lines.height, 0);
    if (mask) draw_mask(*mask, picture.lines);
    if (camera_from_object && is_valid(*camera_from_object)) {
        draw_model(model, *camera_from_object, camera, static_cast<double>(kLinesFiner) / factor, picture.lines);
    }
    return picture;
}

}  // namespace nearpose::report
