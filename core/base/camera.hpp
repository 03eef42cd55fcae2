// The pinhole camera and grids of its pixels.
//
// Camera axes: x right, y down, z forward. Pixel (u, v) has its centre at integer coordinates and is the ray
// ((u - cx) / fx, (v - cy) / fy, 1); depth is z along the axis, not the range along the ray.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace nearpose {

struct PinholeCamera {
    int width = 0;              // [pixels]
    int height = 0;             // [pixels]
    double fx = 0.0, fy = 0.0;  // focal lengths [pixels]
    double cx = 0.0, cy = 0.0;  // principal point [pixels]

    // Direction of pixel (u, v) with z = 1; times a depth it is the point in camera coordinates [m].
    Eigen::Vector3d ray(double u, double v) const { return {(u - cx) / fx, (v - cy) / fy, 1.0}; }
    // Pixel coordinates of a point in camera coordinates; the point must lie in front of the camera (z > 0).
    Eigen::Vector2d project(const Eigen::Vector3d& point_in_camera) const {
        return {fx * point_in_camera.x() / point_in_camera.z() + cx,
                fy * point_in_camera.y() / point_in_camera.z() + cy};
    }
    // Row-major index of the pixel whose square holds (u, v), -1 outside the image.
    int pixel_at(double u, double v) const {
        // The comparison comes before the conversion: an int cannot hold every double.
        if (!(u > -0.5 && v > -0.5 && u < width - 0.5 && v < height - 0.5)) return -1;
        return static_cast<int>(v + 0.5) * width + static_cast<int>(u + 0.5);
    }
};

// Every `stride`-th pixel of an image from (first_u, first_v) on: grid pixel (i, j) is the image pixel
// (first_u + i * stride, first_v + j * stride). Views are cast on such grids, so that each of their rays is the ray of
// one measured pixel and nothing is interpolated.
struct PixelGrid {
    int first_u = 0, first_v = 0;
    int stride = 1;
    int width = 0, height = 0;  // [grid pixels]

    bool operator==(const PixelGrid&) const = default;
    int size() const { return width * height; }
    int image_u(int index) const { return first_u + index % width * stride; }
    int image_v(int index) const { return first_v + index / width * stride; }
};

// A rectangle of pixels, first included, last excluded.
struct PixelBox {
    int first_u = 0, first_v = 0, last_u = 0, last_v = 0;
    bool empty() const { return last_u <= first_u || last_v <= first_v; }
};

// The grid of at most about `max_pixels` pixels, of equal spacing in u and v, that covers `box`.
PixelGrid grid_over(const PixelBox& box, int max_pixels);

// The camera whose pixels are the pixels of `grid`.
PinholeCamera camera_of(const PixelGrid& grid, const PinholeCamera& camera);

// Throws std::invalid_argument naming the field where a size is not in 1..16384, a focal length is not positive, or a
// number is not finite.
void validate(const PinholeCamera& camera);

}  // namespace nearpose
