#include "apps/pictures/canvas.hpp"

#include <agg_conv_stroke.h>
#include <agg_conv_transform.h>
#include <agg_ellipse.h>
#include <agg_gsv_text.h>
#include <agg_path_storage.h>
#include <agg_pixfmt_rgb.h>
#include <agg_rasterizer_scanline_aa.h>
#include <agg_renderer_base.h>
#include <agg_renderer_scanline.h>
#include <agg_scanline_u.h>
#include <agg_trans_affine.h>

#include <algorithm>
#include <cmath>

#include "apps/data_set/png_file.hpp"

namespace nearpose::pictures {
namespace {

constexpr double kCentre = 0.5;  // AGG has pixel centres at half numbers

// Fills the area that `path` encloses, antialiased.
template <typename Path>
void fill(std::vector<std::uint8_t>& rgb, int width, int height, Path& path, Color color, double opacity) {
    agg::rendering_buffer buffer(rgb.data(), static_cast<unsigned>(width), static_cast<unsigned>(height), 3 * width);
    agg::pixfmt_rgb24 pixels(buffer);
    agg::renderer_base<agg::pixfmt_rgb24> renderer(pixels);
    agg::rasterizer_scanline_aa<> rasterizer;
    rasterizer.clip_box(0.0, 0.0, width, height);
    rasterizer.add_path(path);
    agg::scanline_u8 scanline;
    const auto alpha = static_cast<unsigned>(std::lround(255.0 * std::clamp(opacity, 0.0, 1.0)));
    agg::render_scanlines_aa_solid(rasterizer, scanline, renderer,
                                   agg::rgba8(color.red, color.green, color.blue, alpha));
}

// Lines far outside the picture would overflow AGG's fixed-point coordinates before they are clipped.
Eigen::Vector2d bounded(const Eigen::Vector2d& point) {
    return point.cwiseMax(-1e5).cwiseMin(1e5);
}

}  // namespace

Canvas::Canvas(int width, int height, Color background) : width_(width), height_(height) {
    rgb_.resize(std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (std::size_t i = 0; i < rgb_.size(); i += 3) {
        rgb_[i] = background.red;
        rgb_[i + 1] = background.green;
        rgb_[i + 2] = background.blue;
    }
}

void Canvas::blend(int x, int y, Color color, double opacity) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    std::uint8_t* pixel = &rgb_[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + x)];
    const auto mix = [&](std::uint8_t& below, std::uint8_t above) {
        below = static_cast<std::uint8_t>(std::lround(std::lerp(double{1} * below, double{1} * above, opacity)));
    };
    mix(pixel[0], color.red);
    mix(pixel[1], color.green);
    mix(pixel[2], color.blue);
}

void Canvas::fill_rectangle(double left, double top, double right, double bottom, Color color, double opacity) {
    agg::path_storage path;
    path.move_to(left + kCentre, top + kCentre);
    path.line_to(right + kCentre, top + kCentre);
    path.line_to(right + kCentre, bottom + kCentre);
    path.line_to(left + kCentre, bottom + kCentre);
    path.close_polygon();
    fill(rgb_, width_, height_, path, color, opacity);
}

void Canvas::fill_polygon(const std::vector<Eigen::Vector2d>& corners, Color color, double opacity) {
    if (corners.size() < 3) return;
    agg::path_storage path;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Eigen::Vector2d corner = bounded(corners[i]);
        if (i == 0) path.move_to(corner.x() + kCentre, corner.y() + kCentre);
        if (i > 0) path.line_to(corner.x() + kCentre, corner.y() + kCentre);
    }
    path.close_polygon();
    fill(rgb_, width_, height_, path, color, opacity);
}

void Canvas::polyline(const std::vector<Eigen::Vector2d>& points, double line_width, Color color, double opacity) {
    if (points.size() < 2) return;
    agg::path_storage path;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector2d point = bounded(points[i]);
        if (i == 0) path.move_to(point.x() + kCentre, point.y() + kCentre);
        if (i > 0) path.line_to(point.x() + kCentre, point.y() + kCentre);
    }
    agg::conv_stroke<agg::path_storage> stroke(path);
    stroke.width(line_width);
    stroke.line_join(agg::round_join);
    stroke.line_cap(agg::round_cap);
    fill(rgb_, width_, height_, stroke, color, opacity);
}

void Canvas::disc(const Eigen::Vector2d& centre, double radius, Color color) {
    agg::ellipse circle(centre.x() + kCentre, centre.y() + kCentre, radius, radius, 24);
    fill(rgb_, width_, height_, circle, color, 1.0);
}

void Canvas::text(const Eigen::Vector2d& at, const std::string& text, double size, Color color, Align align) {
    const double width = align == Align::kLeft ? 0.0 : text_width(text, size);
    const double left = at.x() - (align == Align::kCentre ? 0.5 * width : width);
    agg::gsv_text glyphs;
    glyphs.flip(true);  // y runs down
    glyphs.size(size);
    glyphs.start_point(left + kCentre, at.y() + kCentre);
    glyphs.text(text.c_str());
    agg::conv_stroke<agg::gsv_text> stroke(glyphs);
    stroke.width(size / 7.5);
    stroke.line_join(agg::round_join);
    stroke.line_cap(agg::round_cap);
    fill(rgb_, width_, height_, stroke, color, 1.0);
}

void Canvas::vertical_text(const Eigen::Vector2d& at, const std::string& text, double size, Color color) {
    agg::gsv_text glyphs;
    glyphs.flip(true);
    glyphs.size(size);
    glyphs.start_point(-0.5 * text_width(text, size), 0.0);
    glyphs.text(text.c_str());
    agg::trans_affine upwards =
        agg::trans_affine_rotation(-0.5 * agg::pi) * agg::trans_affine_translation(at.x() + kCentre, at.y() + kCentre);
    agg::conv_transform<agg::gsv_text> turned(glyphs, upwards);
    agg::conv_stroke<agg::conv_transform<agg::gsv_text>> stroke(turned);
    stroke.width(size / 7.5);
    stroke.line_join(agg::round_join);
    stroke.line_cap(agg::round_cap);
    fill(rgb_, width_, height_, stroke, color, 1.0);
}

double Canvas::text_width(const std::string& text, double size) {
    agg::gsv_text glyphs;
    glyphs.size(size);
    glyphs.text(text.c_str());
    return glyphs.text_width();
}

void Canvas::save(const std::filesystem::path& path) const {
    data_set::write_rgb_png(path, width_, height_, rgb_);
}

}  // namespace nearpose::pictures
