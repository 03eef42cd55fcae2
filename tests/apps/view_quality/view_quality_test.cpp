// What the comparison of views counts, against closed forms and brute force.
#include "apps/view_quality/view_quality.hpp"

#include <array>
#include <memory>

#include "raycast/embree_view_generator.hpp"
#include "raycast/raster_view_generator.hpp"
#include "raycast/sphere_view_generator.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::compare {
namespace {

using test::make_box;
using test::make_sphere;
using test::make_square;

const PinholeCamera kImageCamera{320, 240, 300.0, 300.0, 159.5, 119.5};

Pose at_distance(double distance_m) {
    return {Eigen::Quaterniond::Identity(), {0.0, 0.0, distance_m}};
}

ViewQuality quality_of(const ViewGenerator& views, const Mesh& mesh, const Pose& pose, int max_rays = 64 * 48,
                       const PinholeCamera& camera = kImageCamera) {
    return view_quality(views, EmbreeScene(mesh), {camera, max_rays, 0}, {&pose, 1});
}

// A generator that says always the same.
class FixedView : public ViewGenerator {
  public:
    explicit FixedView(View view) : view_(std::move(view)) {}
    View generate(const Pose&, const PinholeCamera&) const override { return view_; }
    const ModelExtent& extent() const override { return extent_; }

  private:
    View view_;
    ModelExtent extent_;
};

TEST(ViewQuality, RaysAreRight) {
    std::mt19937 random(3);
    const Mesh sphere = make_sphere(0.06, 60);
    const Mesh box = make_box({0.05F, 0.03F, 0.08F});
    for (const Mesh& mesh : {sphere, box}) {
        for (int repeat = 0; repeat < 5; ++repeat) {
            const Pose pose = test::random_pose(random, {0.02, -0.03, 0.25});
            const ViewQuality quality = quality_of(EmbreeViewGenerator(mesh), mesh, pose);
            EXPECT_EQ(quality.views, 1);
            EXPECT_GT(quality.points_per_view, 500.0);
            EXPECT_EQ(quality.points_per_view, quality.pixels_per_view);
            // A ray through an edge may find either face, or slip past the part when it is cast again.
            EXPECT_LE(quality.wrong_share * quality.points_per_view, 2.0);
            EXPECT_LE(quality.missing_share * quality.pixels_per_view, 2.0);
            EXPECT_LT(quality.distance_95_m, 1e-6);
        }
    }
}

TEST(ViewQuality, CountsThePixelsThatMeetASphere) {
    const double radius_m = 0.05;
    const Pose pose = at_distance(0.3);
    const Mesh sphere = make_sphere(radius_m, 100);
    const ViewQuality quality = quality_of(EmbreeViewGenerator(sphere), sphere, pose, 320 * 240);
    int expected = 0;
    for (int pixel = 0; pixel < 320 * 240; ++pixel) {
        expected += test::depth_of_sphere(radius_m, pose, kImageCamera, pixel) > 0.0 ? 1 : 0;
    }
    EXPECT_NEAR(quality.pixels_per_view, expected, 0.005 * expected);
}

TEST(ViewQuality, FewSamplesMissMostPixels) {
    const Mesh box = make_box({0.05F, 0.03F, 0.08F});
    constexpr int kSamples = 50;
    const Pose pose = at_distance(0.3);
    const ViewQuality quality = quality_of(RasterViewGenerator(box, {kSamples, 1}), box, pose);
    EXPECT_LE(quality.points_per_view, kSamples);
    EXPECT_GE(quality.missing_share, 1.0 - kSamples / quality.pixels_per_view);
    EXPECT_LT(quality.missing_share, 1.0);
    // Dense ones miss hardly any.
    const ViewQuality dense = quality_of(RasterViewGenerator(box, {100000, 1}), box, pose, 300);
    EXPECT_LT(dense.missing_share, 0.02);
    EXPECT_LT(dense.wrong_share, 0.02);
}

constexpr double kFront = 0.04, kBack = 0.08;                            // half sides of two squares [m]
constexpr double kFrontDepth = 0.3, kGap = 0.05;                         // the second stands behind the first
constexpr double kShadow = kFront * (kFrontDepth + kGap) / kFrontDepth;  // half side of what the first hides

Mesh two_plates() {
    Mesh mesh = make_square(static_cast<float>(kFront));
    for (const Eigen::Vector3f& corner : make_square(static_cast<float>(kBack)).vertices_in_object) {
        mesh.vertices_in_object.push_back(corner + Eigen::Vector3f(0, 0, static_cast<float>(kGap)));
    }
    mesh.triangles.insert(mesh.triangles.end(), {{4, 5, 6}, {4, 6, 7}});
    return mesh;
}

bool on_back(const Eigen::Vector3f& point) {
    return point.z() > 0.5F * static_cast<float>(kGap);
}

double farther_side(const Eigen::Vector3f& point) {
    return static_cast<double>(std::max(std::abs(point.x()), std::abs(point.y())));
}

// From a hidden point of the back plate to the front plate, or along its own plate out of the shadow.
double distance_to_seen(const Eigen::Vector3f& point) {
    const Eigen::Array2d beyond = (point.head<2>().cast<double>().array().abs() - kFront).max(0.0);
    return std::min(std::hypot(kGap, beyond.matrix().norm()), kShadow - farther_side(point));
}

TEST(ViewQuality, LeaksThroughASparseFrontAreCounted) {
    const Mesh plates = two_plates();
    const Pose pose = at_distance(kFrontDepth);
    const RasterViewGenerator raster(plates, {2000, 4, RasterBuffer::kAsRays});
    const ViewQuality quality = quality_of(raster, plates, pose);

    // The same grid, by hand: the back plate is what the part shows at most.
    const double reach = kBack / (kFrontDepth + kGap) * kImageCamera.fx;
    const PixelBox box{static_cast<int>(std::ceil(kImageCamera.cx - reach)),
                       static_cast<int>(std::ceil(kImageCamera.cy - reach)),
                       static_cast<int>(std::floor(kImageCamera.cx + reach)) + 1,
                       static_cast<int>(std::floor(kImageCamera.cy + reach)) + 1};
    const PinholeCamera camera = camera_of(grid_over(box, 64 * 48), kImageCamera);
    const View view = raster.generate(pose, camera);
    int leaked = 0, right = 0;
    double sum_m = 0.0, max_m = 0.0;
    for (const Eigen::Vector3f& point : view.points_in_object) {
        if (!on_back(point) || farther_side(point) > kShadow) {
            ++right;
            continue;
        }
        ++leaked;
        sum_m += distance_to_seen(point);
        max_m = std::max(max_m, distance_to_seen(point));
    }
    const double count = static_cast<double>(view.size());
    ASSERT_GT(leaked, 100);
    ASSERT_GT(right, 100);
    EXPECT_DOUBLE_EQ(quality.points_per_view, count);
    EXPECT_DOUBLE_EQ(quality.wrong_share, leaked / count);
    EXPECT_DOUBLE_EQ(quality.hidden_share, leaked / count);
    // All of the grid's pixels meet one of the plates, and each point stands for its own.
    EXPECT_DOUBLE_EQ(quality.pixels_per_view, camera.width * camera.height);
    EXPECT_DOUBLE_EQ(quality.missing_share, 1.0 - right / quality.pixels_per_view);
    // The dense image's pixels are 1.2 mm apart on the back plate: never too short, and a pixel too long at most.
    EXPECT_NEAR(quality.mean_distance_m, sum_m / count, 2e-4);
    EXPECT_GE(quality.max_distance_m, max_m - 1e-6);
    EXPECT_LE(quality.max_distance_m, max_m + 1.2e-3);
}

TEST(ViewQuality, PointsOutOfTheImageAreWrongButNotHidden) {
    const Mesh plates = two_plates();
    const Pose pose = at_distance(0.1);  // the front plate alone fills more than the image's height
    // On the front plate but above the image, beside the part, behind the camera, and one that is right.
    const std::array<Eigen::Vector3f, 4> points = {Eigen::Vector3f(0, -0.0401F, 0), Eigen::Vector3f(0.2F, 0, 0),
                                                   Eigen::Vector3f(0, 0, -0.2F), Eigen::Vector3f(0.01F, 0.02F, 0)};
    View view;
    for (std::size_t i = 0; i < points.size(); ++i) {
        view.points_in_object.push_back(points[i]);
        view.normals_in_object.emplace_back(0, 0, -1);
        view.pixels.push_back(static_cast<int>(i));
    }
    PinholeCamera low = kImageCamera;
    low.height = 180;
    low.cy = 89.5;
    const ViewQuality quality = quality_of(FixedView(view), plates, pose, 64 * 48, low);
    EXPECT_DOUBLE_EQ(quality.wrong_share, 0.75);
    EXPECT_DOUBLE_EQ(quality.hidden_share, 0.0);
    EXPECT_NEAR(quality.max_distance_m, 0.2, 1e-3);  // of the one behind the camera
}

TEST(ViewQuality, AStoredViewIsRightWhereItWasTakenAndWrongCloseBy) {
    const Mesh plates = two_plates();
    const SphereViewGenerator sphere(plates, {60, 2.0, 48});
    for (int index = 0; index < 60; index += 11) {
        const ViewQuality stored =
            quality_of(sphere, plates, sphere.stored_pose(index), 48 * 48, sphere.stored_camera());
        EXPECT_EQ(stored.points_per_view, stored.pixels_per_view);
        EXPECT_LE(stored.wrong_share * stored.points_per_view, 1.0);
        EXPECT_LE(stored.missing_share * stored.pixels_per_view, 1.0);
    }
    // From close by and aside, the front plate hides another part of the back than it does from afar.
    Pose close = at_distance(0.12);
    close.translation.x() = 0.06;
    const ViewQuality off_axis = quality_of(sphere, plates, close);
    EXPECT_GT(off_axis.wrong_share, 0.05);
    EXPECT_GT(off_axis.missing_share, 0.3);
}

TEST(ViewQuality, PosesThatShowNothingDoNotCount) {
    const Mesh box = make_box({0.05F, 0.03F, 0.08F});
    const EmbreeViewGenerator rays(box);
    const std::array<Pose, 3> poses = {at_distance(0.3), at_distance(-0.3), at_distance(0.4)};
    const ViewQuality quality = view_quality(rays, EmbreeScene(box), {kImageCamera, 1000, 40}, poses);
    EXPECT_EQ(quality.views, 2);
    EXPECT_GT(quality.cpu_s_per_200, 0.0);
    EXPECT_GT(quality.raycast_cpu_s_per_200, 0.0);
    const ViewQuality nothing = quality_of(rays, box, at_distance(-0.3));
    EXPECT_EQ(nothing.views, 0);
    EXPECT_EQ(nothing.points_per_view, 0.0);
}

}  // namespace
}  // namespace nearpose::compare
