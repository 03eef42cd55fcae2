// A picture to draw on. Coordinates are pixels with the pixel's centre at integers, x right, y down.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace nearpose::pictures {

struct Color {
    std::uint8_t red = 0, green = 0, blue = 0;
};

enum class Align { kLeft, kCentre, kRight };

class Canvas {
  public:
    Canvas(int width, int height, Color background);

    int width() const { return width_; }
    int height() const { return height_; }

    // All drawing is clipped to the picture; opacity is in 0..1.
    void blend(int x, int y, Color color, double opacity = 1.0);
    void fill_rectangle(double left, double top, double right, double bottom, Color color, double opacity = 1.0);
    void fill_polygon(const std::vector<Eigen::Vector2d>& corners, Color color, double opacity = 1.0);
    void polyline(const std::vector<Eigen::Vector2d>& points, double line_width, Color color, double opacity = 1.0);
    void disc(const Eigen::Vector2d& centre, double radius, Color color);
    // ASCII text whose baseline runs through `at`; `size` is the height of capitals [pixels].
    void text(const Eigen::Vector2d& at, const std::string& text, double size, Color color, Align align = Align::kLeft);
    // Reads upwards; `at` is the middle of its baseline.
    void vertical_text(const Eigen::Vector2d& at, const std::string& text, double size, Color color);
    static double text_width(const std::string& text, double size);

    // Throws std::runtime_error naming the file.
    void save(const std::filesystem::path& path) const;

  private:
    int width_, height_;
    std::vector<std::uint8_t> rgb_;  // row-major
};

}  // namespace nearpose::pictures
