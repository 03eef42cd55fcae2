// Symmetries as ray casting finds them. (The laws of the values are in tests/core/symmetry_test.cpp.)
#include "raycast/symmetry/find_symmetries.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "raycast/embree_view_generator.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose {
namespace {

constexpr double kResolution_m = 5e-4;

void add_triangle(Mesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const int first = static_cast<int>(mesh.vertices_in_object.size());
    for (const Eigen::Vector3d& corner : {a, b, c}) mesh.vertices_in_object.push_back(corner.cast<float>());
    mesh.triangles.push_back({first, first + 1, first + 2});
}

void add_quad(Mesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              const Eigen::Vector3d& d) {
    add_triangle(mesh, a, b, c);
    add_triangle(mesh, a, c, d);
}

Eigen::Vector3d on_circle(double radius_m, double turns, double z) {
    return {radius_m * std::cos(2.0 * M_PI * turns), radius_m * std::sin(2.0 * M_PI * turns), z};
}

// A blind hole of three sides in the triangle a b c, its corners at `size` of the way from the middle to a, b and c.
void add_holed_triangle(Mesh& mesh, const std::array<Eigen::Vector3d, 3>& corners, double size, double depth_m) {
    const Eigen::Vector3d middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    const Eigen::Vector3d down = -depth_m * (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    std::array<Eigen::Vector3d, 3> rim;
    for (int i = 0; i < 3; ++i) rim[i] = middle + size * (corners[i] - middle);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        add_quad(mesh, corners[i], corners[j], rim[j], rim[i]);
        add_quad(mesh, rim[i], rim[j], rim[j] + down, rim[i] + down);
    }
    add_triangle(mesh, rim[0] + down, rim[1] + down, rim[2] + down);
}

struct Frustum {
    int sides = 6;
    double bottom_m = 0.05, top_m = 0.05, half_height_m = 0.02;
    double hole = 0.0, odd_hole = 0.0;  // sizes of the holes in the top, and of the one that is different
};

Mesh make_frustum(const Frustum& f) {
    Mesh mesh;
    for (int i = 0; i < f.sides; ++i) {
        const double from = static_cast<double>(i) / f.sides, to = static_cast<double>(i + 1) / f.sides;
        const Eigen::Vector3d a = on_circle(f.bottom_m, from, -f.half_height_m);
        const Eigen::Vector3d b = on_circle(f.bottom_m, to, -f.half_height_m);
        const Eigen::Vector3d c = on_circle(f.top_m, to, f.half_height_m);
        const Eigen::Vector3d d = on_circle(f.top_m, from, f.half_height_m);
        add_quad(mesh, a, b, c, d);
        add_triangle(mesh, {0, 0, -f.half_height_m}, b, a);
        const double hole = i == 0 ? f.odd_hole : f.hole;
        if (hole > 0.0) {
            add_holed_triangle(mesh, {Eigen::Vector3d(0, 0, f.half_height_m), d, c}, hole, 0.01);
        } else {
            add_triangle(mesh, {0, 0, f.half_height_m}, d, c);
        }
    }
    return mesh;
}

Mesh moved(Mesh mesh, const Pose& pose) {
    for (Eigen::Vector3f& vertex : mesh.vertices_in_object) vertex = (pose * vertex.cast<double>()).cast<float>();
    return mesh;
}

Symmetries find(const Mesh& mesh) {
    return find_symmetries(EmbreeViewGenerator(mesh), kResolution_m);
}

// How far a turn of the list moves a point less or more than `turn` does, where both rotate alike; large if none does.
double distance_m(const std::vector<Pose>& turns, const Pose& turn) {
    double least_m = 1.0;
    for (const Pose& other : turns) {
        if (!same_turn(other, turn)) continue;
        for (const Eigen::Vector3d& corner : {Eigen::Vector3d(0.05, 0, 0), Eigen::Vector3d(0, 0.05, 0.02)})
            least_m = std::min(least_m, (other * corner - turn * corner).norm());
    }
    return least_m;
}

const Pose kElsewhere{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -0.5).normalized())),
                      {0.3, -0.1, 0.05}};

TEST(FindSymmetries, CubeHas24TurnsABoxFour) {
    const Symmetries cube = find(test::make_box({0.02F, 0.02F, 0.02F}));
    EXPECT_EQ(cube.discrete.size(), 23U);
    EXPECT_TRUE(cube.continuous.empty());
    EXPECT_TRUE(cube.near_symmetries.empty());
    const Symmetries box = find(test::make_box({0.02F, 0.03F, 0.05F}));
    EXPECT_EQ(box.discrete.size(), 3U);
    EXPECT_TRUE(box.continuous.empty());
    const Symmetries square = find(test::make_box({0.03F, 0.03F, 0.05F}));
    EXPECT_EQ(square.discrete.size(), 7U);
}

TEST(FindSymmetries, PrismsHaveTheirFoldsAndHalfTurns) {
    for (const int sides : {3, 5, 6, 8}) {
        const Symmetries prism = find(make_frustum({sides}));
        EXPECT_EQ(prism.discrete.size(), 2U * static_cast<unsigned>(sides) - 1U) << sides;
        EXPECT_TRUE(prism.continuous.empty()) << sides;
        const Symmetries frustum = find(make_frustum({sides, 0.05, 0.03}));
        EXPECT_EQ(frustum.discrete.size(), static_cast<unsigned>(sides) - 1U) << sides;
    }
}

TEST(FindSymmetries, TetrahedronHas12Turns) {
    Mesh mesh;
    const Eigen::Vector3d a(1, 1, 1), b(1, -1, -1), c(-1, 1, -1), d(-1, -1, 1);
    const double half = 0.03;
    add_triangle(mesh, half * a, half * c, half * b);
    add_triangle(mesh, half * a, half * b, half * d);
    add_triangle(mesh, half * a, half * d, half * c);
    add_triangle(mesh, half * b, half * c, half * d);
    EXPECT_EQ(find(mesh).discrete.size(), 11U);
    EXPECT_EQ(find(moved(mesh, kElsewhere)).discrete.size(), 11U);
}

TEST(FindSymmetries, CylinderAndConeTurnFreelyAndOnlyTheCylinderMayBeFlipped) {
    const Symmetries cylinder = find(make_frustum({180}));
    ASSERT_EQ(cylinder.continuous.size(), 1U);
    EXPECT_GT(std::abs(cylinder.continuous[0].axis_in_object.z()), 0.99999);
    ASSERT_EQ(cylinder.discrete.size(), 1U) << "all flips are one and a turn about the axis";
    EXPECT_NEAR((cylinder.discrete[0].rotation * Eigen::Vector3d::UnitZ()).z(), -1.0, 1e-4);
    const Symmetries cone = find(make_frustum({180, 0.05, 0.01}));
    EXPECT_EQ(cone.continuous.size(), 1U);
    EXPECT_TRUE(cone.discrete.empty());
    EXPECT_TRUE(cone.near_symmetries.empty());
}

TEST(FindSymmetries, BallTurnsAboutEveryAxis) {
    const Symmetries ball = find(test::make_sphere(0.04, 60));
    EXPECT_GE(ball.continuous.size(), 2U);
    EXPECT_TRUE(ball.discrete.empty());
    EXPECT_TRUE(contains(ball, turn_about({Eigen::Vector3d(1, 2, 3).normalized(), {}}, 1.0)));
}

TEST(FindSymmetries, OneSmallHoleBreaksThemAndWhatIsLeftIsNear) {
    const Frustum even{6, 0.05, 0.04, 0.02, 0.3, 0.3};
    EXPECT_EQ(find(make_frustum(even)).discrete.size(), 5U);
    Frustum odd = even;
    odd.odd_hole = 0.0;  // sides of 12 mm where the part is 10 cm wide
    const Symmetries found = find(make_frustum(odd));
    EXPECT_TRUE(found.empty());
    EXPECT_EQ(found.near_symmetries.size(), 5U);
    odd.hole = 0.0;
    odd.odd_hole = 0.15;  // a single one, of 6 mm, 3.5 mm wide inside
    const Symmetries alone = find(make_frustum(odd));
    EXPECT_TRUE(alone.empty());
    EXPECT_EQ(alone.near_symmetries.size(), 5U);
}

TEST(FindSymmetries, DetailsBelowTheResolutionDoNotCount) {
    const Frustum dented{6, 0.05, 0.04, 0.02, 0.0, 0.1};
    const Symmetries blurred = find_symmetries(EmbreeViewGenerator(make_frustum(dented)), 3e-3);
    EXPECT_EQ(blurred.discrete.size(), 5U);
    const Mesh nearly_square = test::make_box({0.03F, 0.0305F, 0.05F});  // sides of 60 and 61 mm
    for (const double resolution_m : {1e-3, 2e-3, 4e-3})
        EXPECT_EQ(find_symmetries(EmbreeViewGenerator(nearly_square), resolution_m).discrete.size(), 7U);
    EXPECT_EQ(find_symmetries(EmbreeViewGenerator(nearly_square), 2e-4).discrete.size(), 3U);
}

TEST(FindSymmetries, DiscWithAKeywayLooksNearlyTheSameAfterAnyTurn) {
    const Symmetries found = find(make_frustum({180, 0.05, 0.04, 0.02, 0.0, 0.0}));
    ASSERT_EQ(found.continuous.size(), 1U);
    Mesh keyed = make_frustum({180, 0.05, 0.04, 0.02, 0.0, 0.0});
    Mesh key = moved(test::make_box({0.004F, 0.003F, 0.01F}), {Eigen::Quaterniond::Identity(), {0.045, 0, 0}});
    for (std::size_t i = 0; i < key.triangles.size(); ++i)
        add_triangle(keyed, key.vertices_in_object[key.triangles[i][0]].cast<double>(),
                     key.vertices_in_object[key.triangles[i][1]].cast<double>(),
                     key.vertices_in_object[key.triangles[i][2]].cast<double>());
    const Symmetries shaft = find(keyed);
    EXPECT_TRUE(shaft.empty());
    EXPECT_EQ(shaft.near_symmetries.size(), 11U);
}

TEST(FindSymmetries, MoveWithThePart) {
    for (const Frustum& frustum : {Frustum{6}, Frustum{4, 0.05, 0.03}, Frustum{6, 0.05, 0.04, 0.02, 0.3, 0.15}}) {
        const Mesh mesh = make_frustum(frustum);
        const Symmetries here = find(mesh), there = find(moved(mesh, kElsewhere));
        ASSERT_EQ(here.discrete.size(), there.discrete.size());
        ASSERT_EQ(here.near_symmetries.size(), there.near_symmetries.size());
        for (const Pose& turn : here.discrete)
            EXPECT_LT(distance_m(there.discrete, kElsewhere * turn * kElsewhere.inverse()), 2.0 * kResolution_m);
        for (const Pose& turn : here.near_symmetries)
            EXPECT_LT(distance_m(there.near_symmetries, kElsewhere * turn * kElsewhere.inverse()), 4.0 * kResolution_m);
    }
    const Symmetries cylinder = find(moved(make_frustum({180}), kElsewhere));
    ASSERT_EQ(cylinder.continuous.size(), 1U);
    const AxisOfRevolution& axis = cylinder.continuous[0];
    EXPECT_LT(axis.axis_in_object.cross(kElsewhere.rotation * Eigen::Vector3d::UnitZ()).norm(), 0.01);
    EXPECT_LT((axis.offset_in_object_m - kElsewhere.translation).cross(axis.axis_in_object).norm(), kResolution_m);
    EXPECT_EQ(cylinder.discrete.size(), 1U);
}

TEST(FindSymmetries, AnAxisBesideTheBoxCentreIsFound) {
    // A pointer of three arms of which the box is not centred on the axis.
    Mesh mesh = make_frustum({3, 0.05, 0.03});
    const Symmetries found = find(mesh);
    ASSERT_EQ(found.discrete.size(), 2U);
    for (const Pose& turn : found.discrete) EXPECT_LT(turn.translation.norm(), kResolution_m);
    EXPECT_GT(std::abs(EmbreeViewGenerator(mesh).extent().centre_in_object().x()), 0.01);
}

TEST(FindSymmetries, NothingToSeeNothingFoundAndBoundsAreChecked) {
    const EmbreeViewGenerator box(test::make_box({0.02F, 0.03F, 0.05F}));
    EXPECT_THROW(find_symmetries(box, 0.0), std::invalid_argument);
    EXPECT_THROW(find_symmetries(box, std::nan("")), std::invalid_argument);
    SymmetrySearchOptions no_fold;
    no_fold.max_fold = 1;
    EXPECT_THROW(find_symmetries(box, kResolution_m, no_fold), std::invalid_argument);
    EXPECT_EQ(find(test::make_square(0.1F)).discrete.size(), 7U) << "a sheet is seen from both sides";
}

}  // namespace
}  // namespace nearpose
