#include "raycast/embree_scene.hpp"

#include <cstring>
#include <limits>
#include <thread>

#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

// Half sides of the box [m], exact as float: the mesh and the closed form are the same box.
const Eigen::Vector3d kHalf(0.0625, 0.03125, 0.078125);

bool same_bits(const RayHits& a, const RayHits& b) {
    const auto same = [](const auto& x, const auto& y) {
        return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
    };
    return same(a.pixels, b.pixels) && same(a.points_in_object, b.points_in_object) &&
           same(a.normals_in_object, b.normals_in_object) && same(a.depth_m, b.depth_m);
}

// Every hit is on its pixel's ray at its depth, with a unit normal towards the camera; pixels ascend.
void expect_consistent(const RayHits& hits, const Pose& pose, const PinholeCamera& camera) {
    const Eigen::Vector3d camera_in_object = pose.inverse().translation;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        ASSERT_TRUE(i == 0 || hits.pixels[i - 1] < hits.pixels[i]);
        const int u = hits.pixels[i] % camera.width, v = hits.pixels[i] / camera.width;
        const Eigen::Vector3d point = pose * hits.points_in_object[i].cast<double>();
        ASSERT_LT((point - hits.depth_m[i] * camera.ray(u, v)).norm(), 1e-7);
        const Eigen::Vector3d normal = hits.normals_in_object[i].cast<double>();
        ASSERT_NEAR(normal.norm(), 1.0, 1e-6);
        ASSERT_GE(normal.dot(camera_in_object - hits.points_in_object[i].cast<double>()), -1e-6);
    }
}

TEST(EmbreeScene, AgreesWithTheClosedFormOfABoxAndHidesItsFarSide) {
    const EmbreeScene scene(make_box(kHalf.cast<float>()));
    const PinholeCamera camera = small_camera();
    std::mt19937 random(1);
    for (int repeat = 0; repeat < 60; ++repeat) {
        const Pose pose = random_pose(random, {0.03, -0.02, 0.2});
        const RayHits hits = scene.cast(pose, camera);
        expect_consistent(hits, pose, camera);
        std::vector<double> depth(static_cast<std::size_t>(camera.width * camera.height), 0.0);
        for (std::size_t i = 0; i < hits.size(); ++i) depth[static_cast<std::size_t>(hits.pixels[i])] = hits.depth_m[i];
        int different = 0, at_edges = 0;
        for (std::size_t pixel = 0; pixel < depth.size(); ++pixel) {
            const double expected = depth_of_box(kHalf, pose, camera, static_cast<int>(pixel));
            // A ray that just touches an edge may go either way.
            if ((expected > 0.0) != (depth[pixel] > 0.0)) {
                ++different;
            } else {
                // Beside an edge the ray may count for the plane of the face next to it.
                ASSERT_NEAR(depth[pixel], expected, 2e-6) << pixel;
                if (std::abs(depth[pixel] - expected) > 3e-8) ++at_edges;
            }
        }
        EXPECT_LE(different, 1);
        EXPECT_LE(at_edges, 2);
        EXPECT_GT(hits.size(), 100U);
    }
}

TEST(EmbreeScene, AgreesWithTheClosedFormOfASphere) {
    const double radius = 0.06;
    const int rows = 200;
    const EmbreeScene scene(make_sphere(radius, rows));
    const double sagitta = radius * std::pow(M_PI / rows, 2) / 2.0;
    std::mt19937 random(2);
    const PinholeCamera camera = small_camera();
    const Pose pose = random_pose(random, {0.02, 0.01, 0.15});
    const RayHits hits = scene.cast(pose, camera);
    expect_consistent(hits, pose, camera);
    ASSERT_GT(hits.size(), 1000U);
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const Eigen::Vector3d point = hits.points_in_object[i].cast<double>();
        ASSERT_NEAR(point.norm(), radius, 2.0 * sagitta);
        const double cosine = hits.normals_in_object[i].cast<double>().dot(point.normalized());
        ASSERT_GT(cosine, std::cos(2.0 * M_PI / rows));
        const Eigen::Vector3d ray = camera.ray(hits.pixels[i] % camera.width, hits.pixels[i] / camera.width);
        const double facing = -(pose.rotation * point.normalized()).dot(ray.normalized());
        if (facing < 0.2) continue;  // near the outline the depth changes fast
        ASSERT_NEAR(hits.depth_m[i], depth_of_sphere(radius, pose, camera, hits.pixels[i]), 10.0 * sagitta);
    }
}

TEST(EmbreeScene, SeesASquareFromBothSidesWhateverItsWinding) {
    const EmbreeScene scene(make_square(1.0F));
    for (const double angle : {0.0, M_PI}) {
        Pose pose;
        pose.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX());
        pose.translation = {0.0, 0.0, 0.3};
        const RayHits hits = scene.cast(pose, small_camera());
        EXPECT_EQ(hits.size(), 64U * 48U);
        expect_consistent(hits, pose, small_camera());
    }
}

// Rays within a degree of the plane are hits as any other.
TEST(EmbreeScene, KeepsGrazingHits) {
    const EmbreeScene scene(make_square(1.0F));
    Pose pose;
    pose.rotation = Eigen::AngleAxisd(M_PI / 2.0 - 0.005, Eigen::Vector3d::UnitX());
    pose.translation = {0.0, 0.0, 0.9};
    const PinholeCamera camera{64, 48, 6000.0, 6000.0, 31.5, 23.5};
    const RayHits hits = scene.cast(pose, camera);
    EXPECT_GT(hits.size(), 64U * 30U);
    const Pose inverse = pose.inverse();
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const Eigen::Vector3d direction = inverse.rotation * camera.ray(hits.pixels[i] % 64, hits.pixels[i] / 64);
        ASSERT_NEAR(hits.depth_m[i], -inverse.translation.z() / direction.z(), 1e-6);
    }
}

TEST(EmbreeScene, GivesTheSameBitsForEveryCallAndThread) {
    const EmbreeScene scene(make_sphere(0.06, 40));
    std::mt19937 random(3);
    std::vector<Pose> poses;
    std::vector<RayHits> expected;
    for (int i = 0; i < 12; ++i) poses.push_back(random_pose(random, {0.02, 0.0, 0.12}));
    for (const Pose& pose : poses) expected.push_back(scene.cast(pose, small_camera()));
    std::vector<int> num_same(4, 0);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < num_same.size(); ++t) {
        threads.emplace_back([&, t] {
            for (std::size_t i = 0; i < poses.size(); ++i) {
                num_same[t] += same_bits(scene.cast(poses[i], small_camera()), expected[i]) ? 1 : 0;
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(num_same, std::vector<int>(4, 12));
    const EmbreeScene rebuilt(make_sphere(0.06, 40));
    EXPECT_TRUE(same_bits(rebuilt.cast(poses[0], small_camera()), expected[0]));
}

// The same pixel gives the same hit whatever block of pixels it is cast with.
TEST(EmbreeScene, APixelDoesNotDependOnItsNeighbours) {
    const EmbreeScene scene(make_sphere(0.06, 40));
    std::mt19937 random(4);
    const Pose pose = random_pose(random, {0.0, 0.0, 0.12});
    PinholeCamera camera = small_camera();
    camera.cx = 31.0;  // whole numbers, so that shifted rays are the same to the last bit
    camera.cy = 24.0;
    const RayHits all = scene.cast(pose, camera);
    const PinholeCamera shifted{61, 47, camera.fx, camera.fy, camera.cx - 3.0, camera.cy - 1.0};
    const RayHits part = scene.cast(pose, shifted);
    std::vector<float> depth(64 * 48, 0.0F);
    for (std::size_t i = 0; i < all.size(); ++i) depth[static_cast<std::size_t>(all.pixels[i])] = all.depth_m[i];
    ASSERT_GT(part.size(), 500U);
    for (std::size_t i = 0; i < part.size(); ++i) {
        const int pixel = (part.pixels[i] / 61 + 1) * 64 + part.pixels[i] % 61 + 3;
        ASSERT_EQ(part.depth_m[i], depth[static_cast<std::size_t>(pixel)]);
    }
}

TEST(EmbreeScene, RefusesWhatWouldEndTheProcess) {
    const EmbreeScene scene(make_box({0.1F, 0.1F, 0.1F}));
    const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e19};
    for (const double value : bad) {
        Pose pose;
        pose.translation.y() = value;
        EXPECT_THROW(scene.cast(pose, small_camera()), std::invalid_argument) << value;
        pose = Pose();
        pose.rotation.x() = value;
        EXPECT_THROW(scene.cast(pose, small_camera()), std::invalid_argument) << value;
        PinholeCamera camera = small_camera();
        camera.cx = value;
        EXPECT_THROW(scene.cast(Pose(), camera), std::invalid_argument) << value;
    }
    PinholeCamera camera = small_camera();
    camera.fx = 1e-300;
    EXPECT_THROW(scene.cast(Pose(), camera), std::invalid_argument);
    camera = small_camera();
    camera.width = 0;
    EXPECT_THROW(scene.cast(Pose(), camera), std::invalid_argument);
}

TEST(EmbreeScene, AnswersWithNothingWhereNothingIsInView) {
    const EmbreeScene scene(make_box({0.1F, 0.1F, 0.1F}));
    Pose behind;
    behind.translation = {0.0, 0.0, -0.5};
    EXPECT_EQ(scene.cast(behind, small_camera()).size(), 0U);
    behind.translation = {0.0, 0.0, 9e5};
    EXPECT_LE(scene.cast(behind, small_camera()).size(), 1U);
    // From inside every ray meets a wall.
    EXPECT_EQ(scene.cast(Pose(), small_camera()).size(), 64U * 48U);
}

TEST(EmbreeScene, CleansItsMeshAndRefusesAnEmptyOne) {
    Mesh mesh = make_box({0.1F, 0.1F, 0.1F});
    mesh.vertices_in_object.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
    mesh.triangles.insert(mesh.triangles.begin(), {{0, 1, 8}, {0, 1, 99}, {0, 0, 1}});
    const EmbreeScene scene(mesh);
    EXPECT_EQ(scene.cast(Pose(), small_camera()).size(), 64U * 48U);
    Mesh degenerate;
    degenerate.vertices_in_object = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    degenerate.triangles = {{0, 1, 2}};
    EXPECT_THROW(EmbreeScene{degenerate}, std::runtime_error);
}

// A cloud of a plane, as oriented discs and as plain ones.
TEST(EmbreeScene, SeesACloudThroughItsDiscs) {
    Mesh cloud;
    for (int i = -40; i <= 40; ++i) {
        for (int j = -40; j <= 40; ++j)
            cloud.vertices_in_object.push_back(Eigen::Vector3d(0.005 * i, 0.005 * j, 0.0).cast<float>());
    }
    EXPECT_THROW(EmbreeScene{cloud}, std::invalid_argument);  // no radius
    cloud.disc_radius_m = 0.006F;
    Pose pose;
    pose.rotation = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 1, 0).normalized());
    pose.translation = {0.0, 0.0, 0.2};
    for (const bool oriented : {true, false}) {
        if (oriented) cloud.vertex_normals_in_object.assign(cloud.vertices_in_object.size(), {0, 0, 1});
        if (!oriented) cloud.vertex_normals_in_object.clear();
        const EmbreeScene scene(cloud);
        const RayHits hits = scene.cast(pose, small_camera());
        EXPECT_GT(hits.size(), 64U * 48U * 9U / 10U);
        expect_consistent(hits, pose, small_camera());
        for (const Eigen::Vector3f& point : hits.points_in_object) {
            ASSERT_NEAR(point.z(), 0.0F, oriented ? 1e-6F : 0.006F);
        }
    }
}

}  // namespace
}  // namespace nearpose::test
