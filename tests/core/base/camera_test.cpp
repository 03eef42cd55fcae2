#include "core/base/camera.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace nearpose {
namespace {

const PinholeCamera kCamera{640, 480, 600.0, 610.0, 321.5, 238.25};

TEST(Camera, ProjectUndoesRay) {
    for (const auto& [u, v] : {std::pair{0.0, 0.0}, {639.0, 479.0}, {321.5, 238.25}, {12.25, 400.75}})
        EXPECT_LT((kCamera.project(0.37 * kCamera.ray(u, v)) - Eigen::Vector2d(u, v)).norm(), 1e-10);
}

TEST(Camera, PixelCentresAreWholeNumbers) {
    EXPECT_EQ(kCamera.pixel_at(0.0, 0.0), 0);
    EXPECT_EQ(kCamera.pixel_at(-0.49, 0.49), 0) << "the nearest centre, not the floor";
    EXPECT_EQ(kCamera.pixel_at(0.51, 0.0), 1);
    EXPECT_EQ(kCamera.pixel_at(639.49, 479.49), 640 * 480 - 1);
    EXPECT_EQ(kCamera.pixel_at(639.5, 0.0), -1);
    EXPECT_EQ(kCamera.pixel_at(-0.5, 0.0), -1);
    EXPECT_EQ(kCamera.pixel_at(1e300, 0.0), -1);
    EXPECT_EQ(kCamera.pixel_at(std::numeric_limits<double>::quiet_NaN(), 0.0), -1);
}

TEST(Camera, GridPixelsAreImagePixelsWithTheSameRay) {
    const PixelGrid grid = grid_over({100, 50, 420, 290}, 500);
    const PinholeCamera grid_camera = camera_of(grid, kCamera);
    EXPECT_LE(grid.size(), 500);
    EXPECT_GT(grid.size(), 350);
    for (int index = 0; index < grid.size(); ++index) {
        const Eigen::Vector3d expected = kCamera.ray(grid.image_u(index), grid.image_v(index));
        EXPECT_LT((grid_camera.ray(index % grid.width, index / grid.width) - expected).norm(), 1e-12);
        EXPECT_TRUE(grid.image_u(index) >= 100 && grid.image_u(index) < 420);
        EXPECT_TRUE(grid.image_v(index) >= 50 && grid.image_v(index) < 290);
    }
}

TEST(Camera, GridOfSmallAndEmptyBoxes) {
    EXPECT_EQ(grid_over({5, 5, 5, 9}, 100).size(), 0);
    EXPECT_EQ(grid_over({5, 5, 8, 9}, 100).size(), 12) << "no more rays than pixels";
    EXPECT_GE(grid_over({0, 0, 640, 1}, 10).size(), 1);
}

TEST(Camera, ValidationNamesTheField) {
    EXPECT_NO_THROW(validate(kCamera));
    PinholeCamera camera = kCamera;
    camera.fx = std::numeric_limits<double>::quiet_NaN();
    try {
        validate(camera);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("fx"), std::string::npos);
    }
    camera = kCamera;
    camera.width = 0;
    EXPECT_THROW(validate(camera), std::invalid_argument);
    camera.width = 70000;
    EXPECT_THROW(validate(camera), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose
