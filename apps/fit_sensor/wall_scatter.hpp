// What the pixels of a wall's frames depart from its planes by.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "apps/fit_sensor/noise_figures.hpp"
#include "apps/fit_sensor/sensor_fit.hpp"

namespace nearpose::simulate {

// Frames that show the wall from one pose.
struct WallPose {
    std::vector<std::size_t> frames;
    WallPlane plane;  // of the first of them
};

struct Wall {
    std::span<const WallFrame> frames;
    PixelBox region;
    std::vector<WallPlane> planes;  // one a frame
    std::vector<WallPose> poses;
    bool separated = false;

    int width() const { return region.last_u - region.first_u; }
    int size() const { return width() * (region.last_v - region.first_v); }
    const PinholeCamera& camera(const WallPose& pose) const { return frames[pose.frames.front()].camera; }
    Eigen::Vector3d ray(const PinholeCamera& camera, int pixel) const {
        return camera.ray(region.first_u + pixel % width(), region.first_v + pixel / width());
    }
    double depth_m(const WallFrame& frame, int pixel) const {
        const int u = region.first_u + pixel % width(), v = region.first_v + pixel / width();
        return frame.depth.depth_m[static_cast<std::size_t>(v) * frame.camera.width + u];
    }
};

// Sums over the pixels of all poses.
struct Measured {
    std::vector<NoiseCell> cells;
    std::vector<WallGroup> groups;
    std::array<double, kLags> row_products{}, column_products{};  // of neighbours' deviations
    double squares = 0.0;                                         // of as many deviations
    double bias_square_sum = 0.0;
    double bias_pixels = 0.0;
};

// The cells have no `effective` yet. `sensor` tells what is an outlier.
Measured measure(const Wall& wall, const WallSensor& sensor);

}  // namespace nearpose::simulate
