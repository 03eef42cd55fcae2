#include "raycast/mesh.hpp"

#include <limits>

#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Clean, LeavesAGoodMeshAsItIs) {
    const Mesh box = make_box({0.1F, 0.2F, 0.3F});
    MeshRepair repair;
    const Mesh cleaned = clean(box, "box", &repair);
    EXPECT_EQ(cleaned.triangles.size(), 12U);
    EXPECT_EQ(cleaned.vertices_in_object.size(), 8U);
    EXPECT_EQ(repair.triangles_degenerate + repair.triangles_not_finite + repair.triangles_bad_index, 0);
    EXPECT_EQ(repair.vertices_joined + repair.vertices_not_finite, 0);
}

TEST(Clean, CountsEachFaultAndKeepsTheRest) {
    Mesh mesh = make_box({0.1F, 0.1F, 0.1F});
    mesh.vertices_in_object.push_back({kNaN, 0, 0});
    mesh.vertices_in_object.push_back({0, kInfinity, 0});
    mesh.vertices_in_object.push_back({0, 0, 1e20F});
    mesh.vertices_in_object.push_back(mesh.vertices_in_object[0]);
    mesh.triangles.push_back({0, 1, 8});
    mesh.triangles.push_back({9, 1, 2});
    mesh.triangles.push_back({3, 10, 2});
    mesh.triangles.push_back({0, 1, 99});
    mesh.triangles.push_back({-5, 1, 2});
    mesh.triangles.push_back({std::numeric_limits<int>::max(), 1, 2});
    mesh.triangles.push_back({4, 4, 5});
    mesh.triangles.push_back({11, 0, 5});  // its first two corners are the same point
    MeshRepair repair;
    const Mesh cleaned = clean(mesh, "box", &repair);
    EXPECT_EQ(cleaned.triangles.size(), 12U);
    EXPECT_EQ(cleaned.vertices_in_object.size(), 8U);
    EXPECT_EQ(repair.triangles_not_finite, 3);
    EXPECT_EQ(repair.triangles_bad_index, 3);
    EXPECT_EQ(repair.triangles_degenerate, 2);
    EXPECT_EQ(repair.vertices_not_finite, 3);
    EXPECT_EQ(repair.vertices_joined, 1);
}

TEST(Clean, JoinsZerosOfEitherSign) {
    Mesh mesh = make_square(0.1F);
    mesh.vertices_in_object.push_back({-0.1F, -0.1F, -0.0F});
    mesh.triangles.push_back({4, 1, 2});
    MeshRepair repair;
    EXPECT_EQ(clean(mesh, "square", &repair).vertices_in_object.size(), 4U);
    EXPECT_EQ(repair.vertices_joined, 1);
}

TEST(Clean, DropsTinyTrianglesRelativeToTheDiameter) {
    for (const float side : {1e-20F, 1e-9F, 1e-3F}) {
        Mesh mesh = make_box({0.1F, 0.1F, 0.1F});
        mesh.vertices_in_object.insert(mesh.vertices_in_object.end(), {{0, 0, 0}, {side, 0, 0}, {0, side, 0}});
        mesh.triangles.push_back({8, 9, 10});
        MeshRepair repair;
        clean(mesh, "box", &repair);
        EXPECT_EQ(repair.triangles_degenerate, side < 1e-8F ? 1 : 0) << side;
    }
}

// A vertex that no triangle uses must not count for the size, or the real triangles would look tiny.
TEST(Clean, ForgetsStrayVertices) {
    Mesh mesh = make_box({0.1F, 0.1F, 0.1F});
    mesh.vertices_in_object.push_back({1e8F, 0, 0});
    const Mesh cleaned = clean(mesh, "box");
    EXPECT_EQ(cleaned.triangles.size(), 12U);
    EXPECT_NEAR(extent_of(cleaned).diameter_m(), 0.2 * std::sqrt(3.0), 1e-7);
}

TEST(Clean, RefusesAMeshOfWhichNothingIsLeft) {
    Mesh mesh;
    mesh.vertices_in_object = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 1, 7}};
    expect_error<std::runtime_error>([&] { clean(mesh, "line.ply"); }, "line.ply: no usable surface");
    expect_error<std::runtime_error>([] { clean(Mesh{}, "empty.ply"); }, "empty.ply");
}

TEST(Clean, KeepsOfACloudThePointsThatAreFiniteAndDistinct) {
    Mesh cloud;
    cloud.vertices_in_object = {{0, 0, 0}, {kNaN, 0, 0}, {1, 0, 0}, {0, 0, 0}, {2, 0, 0}};
    cloud.vertex_normals_in_object = {{0, 0, 2}, {0, 0, 1}, {0, kNaN, 1}, {0, 0, 1}, {0, 3, 0}};
    MeshRepair repair;
    const Mesh cleaned = clean(cloud, "cloud", &repair);
    ASSERT_EQ(cleaned.vertices_in_object.size(), 2U);
    EXPECT_EQ(cleaned.vertices_in_object[1].x(), 2.0F);
    EXPECT_EQ(cleaned.vertex_normals_in_object[0], Eigen::Vector3f(0, 0, 1));
    EXPECT_EQ(cleaned.vertex_normals_in_object[1], Eigen::Vector3f(0, 1, 0));
    EXPECT_EQ(repair.vertices_not_finite, 2);
    EXPECT_EQ(repair.vertices_joined, 1);
}

}  // namespace
}  // namespace nearpose::test
