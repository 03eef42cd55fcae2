// Missing faces, inner bodies and double surfaces, on shapes whose shares are known.
#include "raycast/mesh_faults.hpp"

#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

Mesh joined(const Mesh& first, const Mesh& second) {
    Mesh mesh = first;
    const int offset = static_cast<int>(first.vertices_in_object.size());
    for (const Eigen::Vector3f& vertex : second.vertices_in_object) mesh.vertices_in_object.push_back(vertex);
    for (const auto& [a, b, c] : second.triangles) mesh.triangles.push_back({offset + a, offset + b, offset + c});
    return mesh;
}

MeshFaults faults_of(const Mesh& mesh) {
    return find_faults(clean(mesh, "mesh"));
}

Mesh thinned(Mesh mesh, double share) {
    std::mt19937 random(7);
    std::erase_if(mesh.triangles, [&](const auto&) { return static_cast<double>(random()) < share * 4294967296.0; });
    return mesh;
}

TEST(MeshFaults, AClosedSurfaceHasNone) {
    for (const Mesh& mesh : {make_box({0.1F, 0.2F, 0.3F}), make_sphere(0.1, 30)}) {
        const MeshFaults faults = faults_of(mesh);
        EXPECT_EQ(faults.open_edges, 0.0);
        EXPECT_EQ(faults.crowded_edges, 0.0);
        EXPECT_FALSE(faults.has_holes() || faults.has_second_shell() || faults.is_double());
    }
}

// Of the edges of which at least one triangle is left, 2 p (1 - p) of 1 - p^2 have lost the other. From within one sees
// out through the share p of the surface.
TEST(MeshFaults, MissingTrianglesShowAsTheirShare) {
    for (const double missing : {0.1, 0.3}) {
        const MeshFaults faults = faults_of(thinned(make_sphere(0.1, 40), missing));
        EXPECT_NEAR(faults.open_edges, 2.0 * missing * (1.0 - missing) / (1.0 - missing * missing), 0.03);
        EXPECT_NEAR(faults.see_through, missing, 0.05);
        EXPECT_TRUE(faults.has_holes());
        EXPECT_FALSE(faults.has_second_shell());
    }
}

// Faces with corners of their own on the same edges: open edges, but nothing is seen through them.
TEST(MeshFaults, EdgesThatDoNotFitAreNoHoles) {
    Mesh mesh;
    const Mesh box = make_box({0.1F, 0.1F, 0.1F});
    for (const auto& [a, b, c] : box.triangles) {
        const auto at = [&](int i) -> const Eigen::Vector3f& {
            return box.vertices_in_object[static_cast<std::size_t>(i)];
        };
        Mesh half;
        // Divided in its own place, so that no neighbour has the same corner there.
        const float share = 0.3F + 0.03F * static_cast<float>(mesh.triangles.size());
        half.vertices_in_object = {at(a), at(a) + share * (at(b) - at(a)), at(b), at(c)};
        half.triangles = {{0, 1, 3}, {1, 2, 3}};
        mesh = joined(mesh, half);
    }
    const MeshFaults faults = faults_of(mesh);
    EXPECT_GT(faults.open_edges, 0.1);
    EXPECT_LT(faults.see_through, 0.01);
    EXPECT_FALSE(faults.has_holes());
}

// Corners that an exporter's rounding keeps apart.
TEST(MeshFaults, CornersAlmostInOnePlaceAreOne) {
    const Mesh sphere = make_sphere(0.1, 30);
    Mesh soup;
    for (const auto& triangle : sphere.triangles) {
        const float scale = 1.0F + 2e-7F * static_cast<float>(soup.triangles.size() % 3);
        for (const int corner : triangle)
            soup.vertices_in_object.push_back(scale * sphere.vertices_in_object[static_cast<std::size_t>(corner)]);
        const int end = static_cast<int>(soup.vertices_in_object.size());
        soup.triangles.push_back({end - 3, end - 2, end - 1});
    }
    EXPECT_LT(faults_of(soup).open_edges, 0.1);
    EXPECT_FALSE(faults_of(soup).has_holes());
}

TEST(MeshFaults, AnInnerBodyIsHiddenByItsShareOfTheArea) {
    const MeshFaults body = faults_of(joined(make_sphere(0.1, 30), make_sphere(0.08, 30)));
    EXPECT_NEAR(body.hidden, 0.64 / 1.64, 0.03);
    EXPECT_FALSE(body.has_second_shell() || body.has_holes());
    const MeshFaults shell = faults_of(joined(make_sphere(0.1, 30), make_sphere(0.098, 30)));
    EXPECT_TRUE(shell.has_second_shell());
    EXPECT_FALSE(shell.has_holes());
    const Mesh beside = joined(make_box({0.1F, 0.1F, 0.1F}), make_box({0.02F, 0.02F, 0.3F}));
    EXPECT_FALSE(faults_of(beside).has_second_shell());
}

TEST(MeshFaults, EqualSurfacesAreDouble) {
    const Mesh sphere = make_sphere(0.1, 20);
    const MeshFaults faults = faults_of(joined(sphere, sphere));
    EXPECT_EQ(faults.crowded_edges, 1.0);
    EXPECT_TRUE(faults.is_double());
}

// A scan is often open below: there nobody looks.
TEST(MeshFaults, AFineSurfaceThatIsOpenBelowHasNoHoles) {
    Mesh bowl = make_sphere(0.1, 40);
    std::erase_if(bowl.triangles, [&](const auto& triangle) {
        return bowl.vertices_in_object[static_cast<std::size_t>(triangle[0])].z() < -0.07F;
    });
    EXPECT_FALSE(faults_of(bowl).has_holes());
}

}  // namespace
}  // namespace nearpose::test
