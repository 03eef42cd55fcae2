// Pieces that hardly belong to the part.
#include "raycast/mesh_pieces.hpp"

#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

void append(const Mesh& part, const Eigen::Vector3f& at, Mesh& mesh) {
    const int first = static_cast<int>(mesh.vertices_in_object.size());
    for (const Eigen::Vector3f& vertex : part.vertices_in_object) mesh.vertices_in_object.push_back(vertex + at);
    for (const auto& [a, b, c] : part.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

Mesh tilted(Mesh mesh) {
    const Eigen::Matrix3f turn =
        Eigen::AngleAxisf(0.7F, Eigen::Vector3f(1.0F, 2.0F, 3.0F).normalized()).toRotationMatrix();
    for (Eigen::Vector3f& vertex : mesh.vertices_in_object) vertex = turn * vertex;
    return clean(std::move(mesh), "mesh");
}

// Every triangle with corners of its own, as where an exporter's rounding keeps them apart.
Mesh soup(const Mesh& mesh) {
    Mesh apart;
    for (const auto& triangle : mesh.triangles) {
        const auto number = static_cast<float>(apart.triangles.size());
        for (const int corner : triangle)
            apart.vertices_in_object.push_back(mesh.vertices_in_object[static_cast<std::size_t>(corner)] *
                                               (1.0F + 1e-6F * number));
        const int end = static_cast<int>(apart.vertices_in_object.size());
        apart.triangles.push_back({end - 3, end - 2, end - 1});
    }
    return apart;
}

const Mesh kBox = make_box({0.05F, 0.03F, 0.02F});

Mesh stray_triangle() {
    Mesh mesh;
    mesh.vertices_in_object = {{0, 0, 0}, {0.01F, 0, 0}, {0, 0.01F, 0}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

TEST(StrayPieces, ATriangleFarOffIsFoundAndItsDistanceIsKnown) {
    for (const bool is_soup : {false, true}) {
        Mesh mesh = is_soup ? soup(kBox) : kBox;
        append(stray_triangle(), {3.05F, 0.0F, 0.0F}, mesh);
        const StrayPieces strays = find_stray_pieces(clean(mesh, "mesh"));
        EXPECT_EQ(strays.far_pieces, 1);
        EXPECT_EQ(strays.far_triangles, 1);
        EXPECT_EQ(strays.flat_triangles, 0);
        EXPECT_NEAR(strays.distance_m, 3.0, 1e-4);
        const Mesh rest = without(strays, clean(mesh, "mesh"));
        EXPECT_EQ(rest.triangles.size(), 12U);
        EXPECT_NEAR(extent_of(rest).diameter_m(), extent_of(kBox).diameter_m(), 1e-5);
    }
}

TEST(StrayPieces, AFloorIsFoundInAnyTilt) {
    for (const bool is_soup : {false, true}) {
        Mesh mesh = is_soup ? soup(kBox) : kBox;
        append(is_soup ? soup(make_square(0.5F)) : make_square(0.5F), {0.0F, 0.0F, -0.03F}, mesh);
        mesh = tilted(mesh);
        const StrayPieces strays = find_stray_pieces(mesh);
        EXPECT_EQ(strays.flat_triangles, 2);
        EXPECT_EQ(strays.far_triangles, 0);
        // 11.5 untilted; boxes along the axes are larger where things are tilted.
        EXPECT_NEAR(strays.flat_diameters, 11.5, 2.0);
        EXPECT_EQ(without(strays, mesh).triangles.size(), 12U);
    }
}

TEST(StrayPieces, AFloorAndATriangleFarOffAreBothFound) {
    Mesh mesh = make_sphere(0.05, 20);
    append(make_square(0.5F), {0.0F, 0.0F, -0.05F}, mesh);
    append(stray_triangle(), {0.0F, 0.0F, 2.0F}, mesh);
    mesh = clean(std::move(mesh), "mesh");
    const StrayPieces strays = find_stray_pieces(mesh);
    EXPECT_EQ(strays.flat_triangles, 2);
    EXPECT_EQ(strays.far_triangles, 1);
    EXPECT_NEAR(strays.distance_m, 1.95, 1e-3);
    EXPECT_EQ(without(strays, mesh).triangles.size(), mesh.triangles.size() - 3);
}

TEST(StrayPieces, PartsOfManyPiecesAreWhole) {
    Mesh plate = make_box({0.2F, 0.2F, 0.001F});  // with bolts in its corners
    for (const float x : {-0.19F, 0.19F})
        for (const float y : {-0.19F, 0.19F}) append(make_sphere(0.005, 8), {x, y, 0.0F}, plate);
    Mesh sheet = make_square(0.2F);  // without thickness
    for (const float x : {-0.19F, 0.19F}) append(make_sphere(0.005, 8), {x, 0.0F, 0.0F}, sheet);
    Mesh row;
    for (int k = 0; k < 20; ++k) append(kBox, {0.12F * static_cast<float>(k), 0.0F, 0.0F}, row);
    for (const Mesh& mesh : {plate, sheet, row, kBox, soup(kBox), soup(plate), make_square(0.1F), soup(make_square(1)),
                             soup(make_sphere(0.1, 12))}) {
        const Mesh cleaned = clean(mesh, "mesh");
        const StrayPieces strays = find_stray_pieces(cleaned);
        EXPECT_TRUE(strays.empty()) << mesh.triangles.size();
        EXPECT_EQ(without(strays, cleaned).triangles.size(), cleaned.triangles.size());
    }
}

TEST(StrayPieces, ConnectedPiecesShareVertices) {
    Mesh mesh = kBox;
    append(kBox, {1.0F, 0.0F, 0.0F}, mesh);
    std::vector<int> expected(24, 0);
    std::fill(expected.begin() + 12, expected.end(), 1);
    EXPECT_EQ(connected_pieces(mesh), expected);
    EXPECT_TRUE(find_stray_pieces(Mesh{}).empty());
}

}  // namespace
}  // namespace nearpose::test
