// The rasteriser's depth buffers against closed forms and against visibility by brute force.
#include "raycast/fitted_buffer.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "raycast/raster_view_generator.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

const PinholeCamera kCamera{64, 48, 60.0, 63.0, 31.3, 23.8};
const Eigen::Vector3d kPlates(0.1, 0.08, 0.01);  // half sides of a flat box: two plates, 20 mm apart [m]

Pose facing(double distance_m) {
    return {Eigen::Quaterniond::Identity(), {0.0, 0.0, distance_m}};
}

std::string name_of(RasterBuffer buffer) {
    return buffer == RasterBuffer::kSplats ? "splats" : buffer == RasterBuffer::kCells ? "cells" : "as rays";
}

// The share of a view's points that lie behind the box's first surface on the ray through themselves.
double hidden_share(const View& view, const Eigen::Vector3d& half, const Pose& pose) {
    int hidden = 0;
    for (const Eigen::Vector3f& point_in_object : view.points_in_object) {
        const Eigen::Vector3d point = pose * point_in_object.cast<double>();
        const PinholeCamera through_it{1, 1, 1.0, 1.0, -point.x() / point.z(), -point.y() / point.z()};
        hidden += point.z() > depth_of_box(half, pose, through_it, 0) + 1e-5 ? 1 : 0;
    }
    return hidden / static_cast<double>(std::max<std::size_t>(view.size(), 1));
}

TEST(CellSize, FollowsTheClosedForm) {
    for (const double area_m2 : {1e-6, 4e-5}) {
        for (const double depth_m : {0.05, 0.4}) {
            const Eigen::Array2d size_px = cell_size_px(area_m2, depth_m, kCamera);
            EXPECT_DOUBLE_EQ(size_px.x(), std::max(1.0, kCamera.fx * std::sqrt(area_m2) / depth_m));
            EXPECT_DOUBLE_EQ(size_px.y(), std::max(1.0, kCamera.fy * std::sqrt(area_m2) / depth_m));
        }
    }
}

TEST(CellSize, TheCellsLieOverTheImageAndHoldAsManySamplesAsAskedFor) {
    const double coverage = 5.0, depth_m = 0.1;
    const int num_samples = 20000;
    const Mesh square = make_square(0.1F);  // larger than the image
    const SurfaceSamples samples = sample_surface(square, num_samples, 3);
    const double cell_area_m2 = coverage * surface_area_m2(square) / num_samples;
    const PinholeCamera cells = camera_of_cells(cell_size_px(cell_area_m2, depth_m, kCamera), kCamera);
    // The corners of the image, half a pixel beyond the centres of its first and last pixels.
    const Eigen::Vector2d first = cells.project(kCamera.ray(-0.5, -0.5));
    const Eigen::Vector2d last = cells.project(kCamera.ray(kCamera.width - 0.5, kCamera.height - 0.5));
    EXPECT_NEAR((first - Eigen::Vector2d(-0.5, -0.5)).norm(), 0.0, 1e-12);
    EXPECT_TRUE(last.x() <= cells.width - 0.5 + 1e-9 && last.x() > cells.width - 1.5);
    EXPECT_TRUE(last.y() <= cells.height - 0.5 + 1e-9 && last.y() > cells.height - 1.5);

    int drawn = 0;
    for (const Eigen::Vector3f& point : samples.points_in_object) {
        const Eigen::Vector2d uv = cells.project(facing(depth_m) * point.cast<double>());
        drawn += cells.pixel_at(uv.x(), uv.y()) >= 0 ? 1 : 0;
    }
    EXPECT_NEAR(drawn / static_cast<double>(cells.width * cells.height), coverage, 0.1);
}

TEST(CellSize, TwiceTheSamplesHalveTheArea) {
    const Mesh box = make_box(kPlates.cast<float>());
    for (const RasterBuffer buffer : {RasterBuffer::kSplats, RasterBuffer::kCells}) {
        const RasterViewGenerator sparse(box, {10000, 1, buffer}), dense(box, {20000, 1, buffer});
        EXPECT_DOUBLE_EQ(sparse.cell_area_m2(), 2.0 * dense.cell_area_m2());
        const double box_area_m2 =
            8.0 * (kPlates.x() * kPlates.y() + kPlates.y() * kPlates.z() + kPlates.z() * kPlates.x());
        EXPECT_NEAR(dense.cell_area_m2(), RasterOptions{}.coverage * box_area_m2 / 20000, 1e-10);
    }
}

// Two plates, so that whatever shows through the first is hidden surface. A buffer as fine as the rays is the control:
// it leaks in the same views. What is left beside exp(-coverage) shows past the outline of the first plate's samples.
TEST(RasterBuffers, HiddenPointsAreRareWhereTheBufferFitsTheSamples) {
    const Mesh plates = make_box(kPlates.cast<float>());
    for (const double distance_m : {0.06, 0.1, 0.2, 0.4}) {
        for (const double tilt_rad : {0.0, 0.5}) {
            Pose pose = facing(distance_m);
            pose.rotation = Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d(1.0, 0.4, 0.2).normalized());
            std::map<RasterBuffer, double> hidden;
            for (const RasterBuffer buffer : {RasterBuffer::kSplats, RasterBuffer::kCells, RasterBuffer::kAsRays}) {
                const View view = RasterViewGenerator(plates, {3000, 2, buffer}).generate(pose, kCamera);
                ASSERT_GT(view.size(), 10U);
                hidden[buffer] = hidden_share(view, kPlates, pose);
            }
            EXPECT_LT(hidden[RasterBuffer::kSplats], 0.05) << distance_m << " m, " << tilt_rad << " rad";
            EXPECT_LT(hidden[RasterBuffer::kCells], 0.05) << distance_m << " m, " << tilt_rad << " rad";
            EXPECT_GT(hidden[RasterBuffer::kAsRays], distance_m < 0.15 ? 0.3 : 0.0);
        }
    }
}

// The horizon is known to about the width of a splat or cell: a point that much inside of the outline has turned away
// by the root of twice that width.
TEST(RasterBuffers, OfASphereOnlyTheFrontIsSeen) {
    const double radius_m = 0.05;
    const Mesh sphere = make_sphere(radius_m, 80);
    for (const RasterBuffer buffer : {RasterBuffer::kSplats, RasterBuffer::kCells}) {
        const RasterViewGenerator raster(sphere, {20000, 3, buffer});
        const double width = std::sqrt(raster.cell_area_m2()) / radius_m;
        for (const double distance_m : {0.12, 0.3}) {
            const Pose pose = facing(distance_m);
            const View view = raster.generate(pose, kCamera);
            ASSERT_GT(view.size(), 100U);
            const Eigen::Vector3d camera_in_object = pose.inverse().translation;
            int turned_away = 0;
            for (const Eigen::Vector3f& point_in_object : view.points_in_object) {
                const Eigen::Vector3d point = point_in_object.cast<double>();
                const double cosine = point.normalized().dot((camera_in_object - point).normalized());
                turned_away += cosine < -std::sqrt(2.0 * width) ? 1 : 0;
            }
            EXPECT_LT(turned_away, 0.01 * static_cast<double>(view.size())) << name_of(buffer) << " " << distance_m;
        }
    }
}

// A plane does not hide itself, but for samples that lie beyond their cell's centre on a steep one.
TEST(RasterBuffers, SplatsKeepThePlaneThatTheyLieIn) {
    const Mesh square = make_square(0.05F);
    const SurfaceSamples samples = sample_surface(square, 300, 1);
    const PinholeCamera fine{640, 480, 600.0, 600.0, 319.5, 239.5};  // hardly two samples in a pixel
    for (const double tilt_rad : {0.0, 0.5, 1.0}) {
        Pose pose = facing(0.2);
        pose.rotation = Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitY());
        const View all = RasterViewGenerator(square, {300, 1, RasterBuffer::kAsRays}).generate(pose, fine);
        const View seen = RasterViewGenerator(square, {300, 1, RasterBuffer::kSplats}).generate(pose, fine);
        EXPECT_GT(all.size(), 290U);
        const double kept = tilt_rad < 0.6 ? 0.95 : 0.5;
        EXPECT_GT(static_cast<double>(seen.size()), kept * static_cast<double>(all.size())) << tilt_rad;
    }
}

TEST(RasterBuffers, PointsAreSamplesInWhicheverBuffer) {
    const Mesh box = make_box({0.05F, 0.03F, 0.08F});
    std::set<std::tuple<float, float, float>> drawn;
    for (const auto& p : sample_surface(box, 5000, 4).points_in_object) drawn.insert({p.x(), p.y(), p.z()});
    std::mt19937 random(2);
    const Pose pose = random_pose(random, {0.0, 0.0, 0.25});
    for (const RasterBuffer buffer : {RasterBuffer::kSplats, RasterBuffer::kCells, RasterBuffer::kAsRays}) {
        const View view = RasterViewGenerator(box, {5000, 4, buffer}).generate(pose, kCamera);
        EXPECT_TRUE(view.of_samples);
        for (const auto& p : view.points_in_object) ASSERT_TRUE(drawn.contains({p.x(), p.y(), p.z()}));
        EXPECT_TRUE(std::is_sorted(view.pixels.begin(), view.pixels.end()));
    }
}

// By brute force: every sample is projected, and the first of the nearest in a pixel is its view, to the last bit.
TEST(RasterBuffers, AsFineAsTheRaysKeepsTheNearestSampleOfEachPixel) {
    const Mesh box = make_box({0.05F, 0.03F, 0.08F});
    const SurfaceSamples samples = sample_surface(box, 4000, 9);
    std::mt19937 random(7);
    for (int repeat = 0; repeat < 5; ++repeat) {
        const Pose pose = random_pose(random, {0.02, -0.01, 0.18});
        const Eigen::Matrix3d rotation = pose.rotation_matrix();
        std::map<int, std::pair<double, std::size_t>> nearest;  // of a pixel: depth and sample
        for (std::size_t i = 0; i < samples.points_in_object.size(); ++i) {
            const Eigen::Vector3d point = rotation * samples.points_in_object[i].cast<double>() + pose.translation;
            const double u = kCamera.fx * point.x() / point.z() + kCamera.cx;
            const double v = kCamera.fy * point.y() / point.z() + kCamera.cy;
            const auto column = static_cast<int>(std::floor(u + 0.5)), row = static_cast<int>(std::floor(v + 0.5));
            if (column < 0 || row < 0 || column >= kCamera.width || row >= kCamera.height) continue;
            const auto slot = nearest.try_emplace(row * kCamera.width + column, point.z(), i).first;
            slot->second = std::min(slot->second, std::pair(point.z(), i));
        }
        const View view = RasterViewGenerator(box, {4000, 9, RasterBuffer::kAsRays}).generate(pose, kCamera);
        ASSERT_EQ(view.size(), nearest.size());
        const Eigen::Vector3f camera_in_object = pose.inverse().translation.cast<float>();
        std::size_t k = 0;
        for (const auto& [pixel, kept] : nearest) {
            const Eigen::Vector3f& point = samples.points_in_object[kept.second];
            const Eigen::Vector3f& normal = samples.normals_in_object[kept.second];
            ASSERT_EQ(view.pixels[k], pixel);
            ASSERT_EQ(view.points_in_object[k], point);
            ASSERT_EQ(view.normals_in_object[k].cwiseAbs(), normal.cwiseAbs());
            ASSERT_GE(view.normals_in_object[k].dot(camera_in_object - point), 0.0F);
            ++k;
        }
    }
}

TEST(RasterBuffers, RefuseACoverageOutOfRange) {
    const Mesh box = make_box(kPlates.cast<float>());
    for (const double coverage : {0.0, -1.0, 1001.0, std::nan("")}) {
        expect_error<std::invalid_argument>(
            [&] {
                RasterViewGenerator(box, {100, 1, RasterBuffer::kSplats, coverage});
            },
            "0.1");
    }
}

// Discs and cells as large as the image, and samples just before the camera.
TEST(RasterBuffers, ViewsFromWithinTheSurfacesReachAreStillViews) {
    const Mesh box = make_box(kPlates.cast<float>());
    for (const RasterBuffer buffer : {RasterBuffer::kSplats, RasterBuffer::kCells}) {
        const RasterViewGenerator raster(box, {50, 1, buffer});
        for (const double distance_m : {-0.02, 0.0, 0.0100001, 0.011}) {
            const View view = raster.generate(facing(distance_m), kCamera);
            for (const Eigen::Vector3f& point : view.points_in_object) {
                ASSERT_GT((facing(distance_m) * point.cast<double>()).z(), 0.0);
            }
        }
    }
}

}  // namespace
}  // namespace nearpose::test
