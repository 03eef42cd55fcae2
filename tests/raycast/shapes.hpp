// Meshes with closed forms, poses and cameras for the tests of this folder.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::test {

// Centred at the origin, with half sides `half` [m]; normals by winding point outwards.
inline Mesh make_box(const Eigen::Vector3f& half) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.vertices_in_object.emplace_back(((i & 1) != 0 ? 1.0F : -1.0F) * half.x(),
                                             ((i & 2) != 0 ? 1.0F : -1.0F) * half.y(),
                                             ((i & 4) != 0 ? 1.0F : -1.0F) * half.z());
    }
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

// Latitudes and longitudes; its facets lie within radius * (pi / rows)^2 / 2 of the sphere.
inline Mesh make_sphere(double radius_m, int rows) {
    Mesh mesh;
    const int columns = 2 * rows;
    for (int i = 0; i <= rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            const double theta = M_PI * i / rows, phi = M_PI * j / rows;
            mesh.vertices_in_object.emplace_back(Eigen::Vector3d(radius_m * std::sin(theta) * std::cos(phi),
                                                                 radius_m * std::sin(theta) * std::sin(phi),
                                                                 radius_m * std::cos(theta))
                                                     .cast<float>());
        }
    }
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            const int a = i * columns + j, b = i * columns + (j + 1) % columns;
            mesh.triangles.push_back({a, a + columns, b});
            mesh.triangles.push_back({b, a + columns, b + columns});
        }
    }
    return mesh;
}

// The square |x|, |y| <= half [m] in z = 0.
inline Mesh make_square(float half) {
    Mesh mesh;
    mesh.vertices_in_object = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

inline PinholeCamera small_camera() {
    return {64, 48, 60.0, 61.0, 31.3, 23.8};
}

// A pose with a random rotation that puts the object's origin at `origin_in_camera` [m].
inline Pose random_pose(std::mt19937& random, const Eigen::Vector3d& origin_in_camera) {
    const auto draw = [&random] { return static_cast<double>(random()) / 4294967295.0 - 0.5; };
    Pose pose;
    do {
        pose.rotation.coeffs() = Eigen::Vector4d(draw(), draw(), draw(), draw());
    } while (pose.rotation.norm() < 0.1);
    pose.rotation.normalize();
    pose.translation = origin_in_camera;
    return pose;
}

// The depth at which a ray through pixel `pixel` meets the box or sphere first, 0 if it misses. Both are at the origin.
inline double depth_of_box(const Eigen::Vector3d& half, const Pose& pose, const PinholeCamera& camera, int pixel) {
    const Pose inverse = pose.inverse();
    const Eigen::Vector3d direction = inverse.rotation * camera.ray(pixel % camera.width, pixel / camera.width);
    double enter = 0.0, leave = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (-half[axis] - inverse.translation[axis]) / direction[axis];
        const double b = (half[axis] - inverse.translation[axis]) / direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter < leave ? enter : 0.0;
}
inline double depth_of_sphere(double radius, const Pose& pose, const PinholeCamera& camera, int pixel) {
    const Eigen::Vector3d ray = camera.ray(pixel % camera.width, pixel / camera.width);
    const double along = ray.dot(pose.translation) / ray.squaredNorm();
    const double root = along * along - (pose.translation.squaredNorm() - radius * radius) / ray.squaredNorm();
    return root < 0.0 ? 0.0 : along - std::sqrt(root);
}

// A folder of this test alone, emptied at the start.
class FolderTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::path(testing::TempDir()) /
                  ("nearpose_raycast_" + std::string(info->test_suite_name()) + "_" + info->name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream file(folder_ / name, std::ios::binary);
        file << bytes;
        file.close();
        EXPECT_TRUE(file);
        return folder_ / name;
    }

    std::filesystem::path folder_;
};

// What a call throws says `part`, and it throws `Error`.
template <typename Error, typename Call>
void expect_error(Call call, const std::string& part) {
    try {
        call();
        ADD_FAILURE() << "nothing was thrown; expected \"" << part << "\"";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
}

}  // namespace nearpose::test
