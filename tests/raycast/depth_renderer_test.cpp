#include "raycast/depth_renderer.hpp"

#include <array>

#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

// Back-projected through pixel centres at integers, a tilted plane is a plane again. Half a pixel off would be 2 mm
// here.
TEST(RenderDepth, BackProjectedTiltedPlaneIsThePlane) {
    const EmbreeScene scene(make_square(1.0F));
    Pose pose;
    pose.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 0.4, 0.2).normalized());
    pose.translation = {0.01, 0.02, 0.25};
    const PinholeCamera camera = small_camera();
    const DepthImage image = render_depth(scene, pose, camera);
    ASSERT_EQ(image.width, 64);
    ASSERT_EQ(image.height, 48);
    for (int v = 0; v < 48; ++v) {
        for (int u = 0; u < 64; ++u) {
            const double depth = image.depth_m[static_cast<std::size_t>(v * 64 + u)];
            ASSERT_GT(depth, 0.0);
            ASSERT_NEAR((pose.inverse() * (depth * camera.ray(u, v))).z(), 0.0, 1e-7);
        }
    }
}

// A camera rolled by 180 degrees whose principal point is mirrored sees the same image turned by 180 degrees.
TEST(RenderDepth, RolledCameraGivesTheTurnedImage) {
    const EmbreeScene scene(make_box({0.05F, 0.03F, 0.08F}));
    std::mt19937 random(9);
    const PinholeCamera camera = small_camera();
    PinholeCamera turned = camera;
    turned.cx = camera.width - 1 - camera.cx;
    turned.cy = camera.height - 1 - camera.cy;
    Pose roll;
    roll.rotation = Eigen::Quaterniond(0.0, 0.0, 0.0, 1.0);
    for (int repeat = 0; repeat < 10; ++repeat) {
        const Pose pose = random_pose(random, {0.02, 0.03, 0.2});
        const DepthImage image = render_depth(scene, pose, camera);
        const DepthImage rolled = render_depth(scene, roll * pose, turned);
        int outline = 0;
        for (std::size_t i = 0; i < image.depth_m.size(); ++i) {
            const float other = rolled.depth_m[image.depth_m.size() - 1 - i];
            if ((image.depth_m[i] > 0.0F) != (other > 0.0F)) {
                ++outline;
            } else {
                ASSERT_NEAR(image.depth_m[i], other, 1e-6F);
            }
        }
        EXPECT_LE(outline, 1);
    }
}

TEST(Render, KeepsTheNearestObjectOfEachPixel) {
    const EmbreeScene wall(make_square(2.0F));
    const EmbreeScene box(make_box({0.03F, 0.03F, 0.03F}));
    SceneObject far{&wall, Pose()}, near{&box, Pose()};
    far.camera_from_object.translation = {0.0, 0.0, 0.5};
    near.camera_from_object.translation = {0.0, 0.0, 0.2};
    const PinholeCamera camera = small_camera();
    const DepthImage alone = render_depth(box, near.camera_from_object, camera);
    for (const bool wall_first : {true, false}) {
        const std::array<SceneObject, 2> objects =
            wall_first ? std::array<SceneObject, 2>{far, near} : std::array<SceneObject, 2>{near, far};
        const RenderedImage image = render(objects, camera);
        int of_box = 0;
        for (std::size_t i = 0; i < alone.depth_m.size(); ++i) {
            const bool is_box = alone.depth_m[i] > 0.0F;
            of_box += is_box ? 1 : 0;
            ASSERT_EQ(image.object[i], is_box == wall_first ? 1 : 0);
            ASSERT_EQ(image.depth.depth_m[i], is_box ? alone.depth_m[i] : 0.5F);
            ASSERT_LT((image.normals_in_camera[i] - Eigen::Vector3f(0, 0, -1)).norm(), 1e-6F);
        }
        EXPECT_GT(of_box, 100);
    }
}

TEST(Render, WithoutObjectsIsEmpty) {
    const RenderedImage image = render({}, small_camera());
    EXPECT_EQ(image.object, std::vector<int>(64 * 48, -1));
    EXPECT_EQ(image.depth.depth_m, std::vector<float>(64 * 48, 0.0F));
    EXPECT_THROW(render(std::array<SceneObject, 1>{}, small_camera()), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::test
