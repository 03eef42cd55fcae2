// The view generators against closed forms and against each other.
#include <limits>
#include <memory>
#include <set>

#include "raycast/embree_view_generator.hpp"
#include "raycast/raster_view_generator.hpp"
#include "raycast/sphere_view_generator.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

const Eigen::Vector3d kHalf(0.05, 0.03, 0.08);  // of the box [m]

std::vector<std::unique_ptr<ViewGenerator>> all_generators(const Mesh& mesh) {
    std::vector<std::unique_ptr<ViewGenerator>> generators;
    generators.push_back(std::make_unique<EmbreeViewGenerator>(mesh));
    for (const RasterBuffer buffer : {RasterBuffer::kSplats, RasterBuffer::kCells, RasterBuffer::kAsRays}) {
        generators.push_back(std::make_unique<RasterViewGenerator>(mesh, RasterOptions{20000, 1, buffer}));
    }
    generators.push_back(std::make_unique<SphereViewGenerator>(mesh, SphereOptions{100, 2.0, 64}));
    return generators;
}

double distance_to_box_surface(const Eigen::Vector3f& point) {
    const Eigen::Vector3d beyond = point.cast<double>().cwiseAbs() - kHalf;
    return beyond.maxCoeff() > 0.0 ? beyond.cwiseMax(0.0).norm() : -beyond.maxCoeff();
}

class EachGenerator : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(RayRastersSphere, EachGenerator, testing::Values(0U, 1U, 2U, 3U, 4U));

TEST_P(EachGenerator, KeepsTheLawsOfAView) {
    const auto generator = std::move(all_generators(make_box(kHalf.cast<float>()))[GetParam()]);
    EXPECT_NEAR(generator->extent().diameter_m(), 2.0 * kHalf.norm(), 1e-7);
    const PinholeCamera camera = small_camera();
    std::mt19937 random(5);
    for (int repeat = 0; repeat < 10; ++repeat) {
        const Pose pose = random_pose(random, {0.03, -0.01, 0.25});
        const View view = generator->generate(pose, camera);
        ASSERT_GT(view.size(), 100U);
        ASSERT_EQ(view.normals_in_object.size(), view.size());
        ASSERT_EQ(view.pixels.size(), view.size());
        EXPECT_EQ(std::set<int>(view.pixels.begin(), view.pixels.end()).size(), view.size());
        const Eigen::Vector3d camera_in_object = pose.inverse().translation;
        for (std::size_t i = 0; i < view.size(); ++i) {
            const Eigen::Vector3d point = view.points_in_object[i].cast<double>();
            const Eigen::Vector3d normal = view.normals_in_object[i].cast<double>();
            ASSERT_LT(distance_to_box_surface(view.points_in_object[i]), 1e-7);
            ASSERT_NEAR(normal.norm(), 1.0, 1e-6);
            ASSERT_NEAR(normal.cwiseAbs().maxCoeff(), 1.0, 1e-6);  // along an axis of the box
            ASSERT_GE(normal.dot(camera_in_object - point), -1e-6);
            // The point falls into its pixel's square: rounded, not floored.
            const Eigen::Vector2d uv = camera.project(pose * point);
            ASSERT_NEAR(uv.x(), view.pixels[i] % camera.width, 0.5 + 1e-3);
            ASSERT_NEAR(uv.y(), view.pixels[i] / camera.width, 0.5 + 1e-3);
        }
    }
}

TEST_P(EachGenerator, GivesTheSameBitsAgainAndWhenBuiltAgain) {
    std::mt19937 random(6);
    const Pose pose = random_pose(random, {0.0, 0.0, 0.25});
    const auto generator = std::move(all_generators(make_sphere(0.05, 20))[GetParam()]);
    const auto rebuilt = std::move(all_generators(make_sphere(0.05, 20))[GetParam()]);
    const View first = generator->generate(pose, small_camera());
    for (const View& view : {generator->generate(pose, small_camera()), rebuilt->generate(pose, small_camera())}) {
        EXPECT_EQ(view.pixels, first.pixels);
        EXPECT_EQ(view.points_in_object, first.points_in_object);
        EXPECT_EQ(view.normals_in_object, first.normals_in_object);
    }
}

TEST_P(EachGenerator, RefusesPosesThatAreNotFiniteAndSeesNothingBehindTheCamera) {
    const auto generator = std::move(all_generators(make_box(kHalf.cast<float>()))[GetParam()]);
    Pose pose;
    pose.translation.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(generator->generate(pose, small_camera()), std::invalid_argument);
    pose.translation = {0.0, 0.0, -0.4};
    EXPECT_EQ(generator->generate(pose, small_camera()).size(), 0U);
}

TEST_P(EachGenerator, AgreesWithTheClosedFormOfASphere) {
    const double radius = 0.06;
    const auto generator = std::move(all_generators(make_sphere(radius, 100))[GetParam()]);
    Pose pose;
    pose.translation = {0.0, 0.0, 0.3};
    const PinholeCamera camera = small_camera();
    const View view = generator->generate(pose, camera);
    ASSERT_GT(view.size(), 200U);
    for (std::size_t i = 0; i < view.size(); ++i) {
        const Eigen::Vector3d point = view.points_in_object[i].cast<double>();
        ASSERT_NEAR(point.norm(), radius, 1e-4);
        ASSERT_GT(view.normals_in_object[i].cast<double>().dot(point.normalized()), GetParam() == 0U ? 0.999 : -1.0);
        // Half a pixel off the ray at most, where the surface faces the camera.
        if ((pose.rotation * point).z() > -0.7 * radius) continue;
        ASSERT_NEAR((pose * point).z(), depth_of_sphere(radius, pose, camera, view.pixels[i]), 5e-3);
    }
}

// Where the samples are dense enough for every pixel the rasteriser sees what the rays see.
TEST(RasterViewGenerator, AgreesWithRaysWhereSamplesAreDense) {
    const Mesh box = make_box(kHalf.cast<float>());
    const RasterViewGenerator raster(box, {200000, 7});
    const EmbreeViewGenerator rays(box);
    const PinholeCamera camera{32, 24, 30.0, 30.0, 15.5, 11.5};
    std::mt19937 random(8);
    for (int repeat = 0; repeat < 5; ++repeat) {
        const Pose pose = random_pose(random, {0.0, 0.0, 0.3});
        const View seen = rays.generate(pose, camera);
        const View drawn = raster.generate(pose, camera);
        std::vector<double> depth(32 * 24, 0.0);
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            depth[static_cast<std::size_t>(drawn.pixels[i])] = (pose * drawn.points_in_object[i].cast<double>()).z();
        }
        int far_off = 0;
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const double expected = (pose * seen.points_in_object[i].cast<double>()).z();
            // The nearest of a pixel's samples lies before the ray's hit by up to the slope over its 10 mm; at steep
            // faces that is more than this.
            if (std::abs(depth[static_cast<std::size_t>(seen.pixels[i])] - expected) > 0.02) ++far_off;
        }
        EXPECT_LT(far_off, static_cast<int>(seen.size()) / 10);
    }
}

TEST(RasterViewGenerator, KeepsTheNearestOfAPixel) {
    // Two squares, one behind the other, so that every pixel has samples of both.
    Mesh mesh = make_square(0.1F);
    for (int i = 0; i < 4; ++i) {
        mesh.vertices_in_object.push_back(mesh.vertices_in_object[static_cast<std::size_t>(i)] +
                                          Eigen::Vector3f(0, 0, 0.05F));
    }
    mesh.triangles.insert(mesh.triangles.end(), {{4, 5, 6}, {4, 6, 7}});
    const RasterViewGenerator raster(mesh, {100000, 1});
    const PinholeCamera camera{16, 16, 30.0, 30.0, 7.5, 7.5};
    Pose pose;
    pose.translation = {0.0, 0.0, 0.3};  // the first square is at 0.3 m, the second at 0.35 m
    View view = raster.generate(pose, camera);
    EXPECT_EQ(view.size(), 256U);
    for (const Eigen::Vector3f& point : view.points_in_object) ASSERT_EQ(point.z(), 0.0F);
    pose.rotation = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());  // now the second is nearer
    view = raster.generate(pose, camera);
    EXPECT_EQ(view.size(), 256U);
    for (const Eigen::Vector3f& point : view.points_in_object) ASSERT_FLOAT_EQ(point.z(), 0.05F);
}

// At a stored viewpoint and with its camera the store gives the rays' view point by point; at another distance or roll
// it still places the same points; off the axis it does not know what has come into view.
TEST(SphereViewGenerator, EqualsRaysWhereTheObjectIsCentredAndOnlyThere) {
    const Mesh box = make_box(kHalf.cast<float>());
    const SphereViewGenerator sphere(box, {60, 1.0, 48});
    const EmbreeViewGenerator rays(box);
    for (int index = 0; index < 60; index += 7) {
        const Pose& pose = sphere.stored_pose(index);
        const View expected = rays.generate(pose, sphere.stored_camera());
        const View view = sphere.generate(pose, sphere.stored_camera());
        EXPECT_EQ(view.pixels, expected.pixels);
        EXPECT_EQ(view.points_in_object, expected.points_in_object);
        EXPECT_EQ(view.normals_in_object, expected.normals_in_object);
    }
}

// How many of the rays' points have no stored point within 8 mm.
int missing_points(const View& rays, const View& stored) {
    int missing = 0;
    for (const Eigen::Vector3f& point : rays.points_in_object) {
        float nearest = 1.0F;
        for (const Eigen::Vector3f& other : stored.points_in_object)
            nearest = std::min(nearest, (point - other).norm());
        if (nearest > 0.008F) ++missing;
    }
    return missing;
}

TEST(SphereViewGenerator, RollAndDistanceMoveTheStoredViewButPerspectiveDoesNot) {
    const Mesh box = make_box(kHalf.cast<float>());
    const SphereViewGenerator sphere(box, {60, 3.0, 64});
    const EmbreeViewGenerator rays(box);
    PinholeCamera camera{64, 64, 180.0, 180.0, 31.5, 31.5};
    const Pose& stored = sphere.stored_pose(10);
    Pose rolled;
    rolled.rotation = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ());
    EXPECT_EQ(missing_points(rays.generate(rolled * stored, camera), sphere.generate(rolled * stored, camera)), 0);

    // From close by, less of the box's sides is seen than from afar, and from a corner of the image another side.
    int different = 0;
    for (int index = 0; index < 60; index += 5) {
        Pose close = sphere.stored_pose(index);
        close.translation += Eigen::Vector3d(0.09, 0.07, -2.0 * sphere.extent().diameter_m() - 0.05);
        camera = {64, 48, 40.0, 40.0, 31.5, 23.5};
        const View seen = rays.generate(close, camera);
        const View placed = sphere.generate(close, camera);
        different += missing_points(seen, placed) + missing_points(placed, seen);
    }
    EXPECT_GT(different, 100);
}

TEST(ViewGenerators, RefuseOptionsOutOfRange) {
    const Mesh box = make_box(kHalf.cast<float>());
    EXPECT_THROW(RasterViewGenerator(box, {0, 1}), std::invalid_argument);
    EXPECT_THROW(SphereViewGenerator(box, {0, 2.0, 64}), std::invalid_argument);
    EXPECT_THROW(SphereViewGenerator(box, {10, 0.5, 64}), std::invalid_argument);
    EXPECT_THROW(SphereViewGenerator(box, {10, 2.0, 1}), std::invalid_argument);
    EXPECT_THROW(SphereViewGenerator(box, {10, std::nan(""), 64}), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::test
