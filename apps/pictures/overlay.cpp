#include "apps/pictures/overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/pictures/canvas.hpp"
#include "apps/pictures/model_outline.hpp"

namespace nearpose::pictures {
namespace {

constexpr int kUsualWidth = 640;    // smaller images are enlarged to about this [pixels]
constexpr int kCaptionHeight = 30;  // [pixels]
constexpr int kSupersampling = 2;   // of the outline, so that its lines are smooth
constexpr Color kMissing{22, 24, 30}, kHatch{38, 42, 52}, kCaption{16, 18, 24}, kCaptionText{235, 238, 242};
constexpr Color kEstimated{70, 255, 90}, kPredicted{255, 180, 0}, kHalo{0, 0, 0};

struct DepthRange {
    float near_m = 0.0F, far_m = 1.0F;
};

// Of nearly all measurements of the object: single stray pixels do not darken the picture.
DepthRange shown_range(const Observation& observation) {
    std::vector<float> depths_m;
    for (std::size_t i = 0; i < observation.depth_m().size(); ++i) {
        if (observation.states()[i] == PixelState::kCandidate) depths_m.push_back(observation.depth_m()[i]);
    }
    if (depths_m.empty()) return {};
    const auto rank = [&](double fraction) {
        const auto place =
            depths_m.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(depths_m.size() - 1));
        std::nth_element(depths_m.begin(), place, depths_m.end());
        return *place;
    };
    const float near_m = rank(0.02), far_m = rank(0.98);
    return {near_m, std::max(far_m, near_m + 0.005F)};
}

// From pale gold (near) over rose and violet to deep blue (far).
Color ramp(double fraction) {
    constexpr std::array<Color, 5> kStops = {
        {{255, 240, 205}, {246, 183, 134}, {205, 112, 122}, {122, 68, 128}, {48, 42, 96}}};
    const double place = std::clamp(fraction, 0.0, 1.0) * (kStops.size() - 1.0);
    const auto below = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
    const double t = place - static_cast<double>(below);
    const auto mix = [&](std::uint8_t a, std::uint8_t b) {
        return static_cast<std::uint8_t>(std::lround((1.0 - t) * a + t * b));
    };
    const Color &a = kStops[below], &b = kStops[below + 1];
    return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

Color scaled(Color color, double factor) {
    const auto scale = [&](std::uint8_t value) { return static_cast<std::uint8_t>(std::lround(factor * value)); };
    return {scale(color.red), scale(color.green), scale(color.blue)};
}

Color pixel_color(const Observation& observation, const DepthRange& range, int pixel) {
    const float depth_m = observation.depth_m()[pixel];
    const Color color = ramp((depth_m - range.near_m) / (range.far_m - range.near_m));
    // As if lit from the camera, so that edges and bores show.
    const Eigen::Vector3f normal = observation.normal_at(pixel, 2);
    const double light = normal.isZero() ? 0.75 : 0.45 + 0.55 * std::abs(normal.z());
    if (observation.states()[pixel] == PixelState::kCandidate) return scaled(color, light);
    const double grey = 0.35 * light * (0.3 * color.red + 0.6 * color.green + 0.1 * color.blue) + 20.0;
    const auto value = static_cast<std::uint8_t>(std::lround(grey));
    return {value, value, value};
}

void draw_depth(Canvas& canvas, const Observation& observation, int scale) {
    const DepthRange range = shown_range(observation);
    const int width = observation.camera().width, height = observation.camera().height;
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            const int pixel = v * width + u;
            const bool missing = observation.states()[pixel] == PixelState::kNoDepth;
            const Color color = missing ? kMissing : pixel_color(observation, range, pixel);
            for (int y = v * scale; y < (v + 1) * scale; ++y) {
                for (int x = u * scale; x < (u + 1) * scale; ++x) {
                    canvas.blend(x, y, missing && (x + y) % 10 < 2 ? kHatch : color);
                }
            }
        }
    }
}

// Draws the edges of at least `least` as lines about `line_width` canvas pixels wide.
void draw_edges(Canvas& canvas, const OutlineImage& outline, Edge least, double line_width, Color color,
                double opacity) {
    const int reach = std::max(0, static_cast<int>(std::lround(0.5 * kSupersampling * line_width)) - 1);
    std::vector<std::uint8_t> covered(outline.edges.size(), 0);
    for (int v = 0; v < outline.height; ++v) {
        for (int u = 0; u < outline.width; ++u) {
            if (outline.edges[static_cast<std::size_t>(v) * outline.width + u] < least) continue;
            for (int y = std::max(0, v - reach); y <= std::min(outline.height - 1, v + reach); ++y) {
                for (int x = std::max(0, u - reach); x <= std::min(outline.width - 1, u + reach); ++x) {
                    if ((x - u) * (x - u) + (y - v) * (y - v) > reach * reach + 1) continue;
                    covered[static_cast<std::size_t>(y) * outline.width + x] = 1;
                }
            }
        }
    }
    // Each canvas pixel is covered by the fine pixels in it.
    const int columns = canvas.width(), rows = canvas.height();
    std::vector<std::uint8_t> count(static_cast<std::size_t>(columns) * rows, 0);
    for (int v = 0; v < outline.height; ++v) {
        for (int u = 0; u < outline.width; ++u) {
            const int x = (outline.first_u + u) / kSupersampling, y = (outline.first_v + v) / kSupersampling;
            const std::uint8_t value = covered[static_cast<std::size_t>(v) * outline.width + u];
            if (value != 0 && x < columns && y < rows) ++count[static_cast<std::size_t>(y) * columns + x];
        }
    }
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const int fine = count[static_cast<std::size_t>(y) * columns + x];
            if (fine > 0) canvas.blend(x, y, color, opacity * fine / (kSupersampling * kSupersampling));
        }
    }
}

// The camera whose pixels are `factor` times as fine.
PinholeCamera finer(const PinholeCamera& camera, int factor) {
    return {camera.width * factor, camera.height * factor,           camera.fx * factor,
            camera.fy * factor,    (camera.cx + 0.5) * factor - 0.5, (camera.cy + 0.5) * factor - 0.5};
}

// The object's axes at the centre of its box: x red, y green, z blue.
void draw_object_axes(Canvas& canvas, const ModelExtent& extent, const Pose& camera_from_object,
                      const PinholeCamera& camera) {
    constexpr double kLengthDiameters = 0.18;
    constexpr std::array<Color, 3> kColors = {{{255, 70, 70}, {80, 220, 80}, {90, 150, 255}}};
    const Eigen::Vector3d centre = camera_from_object * extent.centre_in_object();
    if (centre.z() < 2.0 * kLengthDiameters * extent.diameter_m()) return;
    const Eigen::Vector2d origin = camera.project(centre);
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d tip_in_object =
            extent.centre_in_object() + kLengthDiameters * extent.diameter_m() * Eigen::Vector3d::Unit(axis);
        const Eigen::Vector2d tip = camera.project(camera_from_object * tip_in_object);
        canvas.polyline({origin, tip}, 5.0, kHalo, 0.6);
        canvas.polyline({origin, tip}, 3.0, kColors[axis]);
        const Eigen::Vector2d beyond = tip + 9.0 * (tip - origin).normalized();
        if ((tip - origin).norm() > 6.0) {
            canvas.text(beyond + Eigen::Vector2d(0.0, 4.0), std::string(1, "xyz"[axis]), 10.0, kColors[axis],
                        Align::kCentre);
        }
    }
}

void draw_model(Canvas& canvas, const EmbreeScene& model, const Pose& camera_from_object, const PinholeCamera& camera,
                Color color) {
    const OutlineImage outline = find_outline(model, camera_from_object, finer(camera, kSupersampling));
    draw_edges(canvas, outline, Edge::kCrease, 1.0, color, 0.65);
    draw_edges(canvas, outline, Edge::kOutline, 4.0, kHalo, 0.45);
    draw_edges(canvas, outline, Edge::kOutline, 2.0, color, 1.0);
    draw_object_axes(canvas, model.extent(), camera_from_object, camera);
}

}  // namespace

void write_overlay(const std::filesystem::path& path, const Observation& observation, const EmbreeScene& model,
                   const std::optional<Pose>& camera_from_object, const OverlayText& text) {
    const PinholeCamera& camera = observation.camera();
    const int scale = std::max(1, (kUsualWidth + camera.width / 2) / camera.width);
    const PinholeCamera shown = finer(camera, scale);
    Canvas canvas(shown.width, shown.height + kCaptionHeight, kCaption);
    draw_depth(canvas, observation, scale);
    if (camera_from_object && is_valid(*camera_from_object)) {
        draw_model(canvas, model, *camera_from_object, shown, text.estimated ? kEstimated : kPredicted);
    }
    canvas.fill_rectangle(-0.5, shown.height - 0.5, shown.width, shown.height + kCaptionHeight, kCaption);
    canvas.text({10.0, shown.height + 20.0}, text.caption, 11.0, kCaptionText);
    canvas.save(path);
}

}  // namespace nearpose::pictures
