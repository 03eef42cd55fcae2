// Polygons into triangles. That all triangles are wound as the polygon and their areas add up to its own means that
// they cover it once: what lies outside would be covered with the other winding.
#include "raycast/mesh_files/ear_clipping.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <random>

#include "raycast/mesh_loader.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;
using Corners = std::vector<Eigen::Vector3d>;

double draw(std::mt19937& random) {
    return static_cast<double>(random()) / 4294967296.0;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// The shoelace formula.
double area_of(const Polygon& polygon) {
    double doubled = 0.0;
    for (std::size_t k = 0; k < polygon.size(); ++k) doubled += cross(polygon[k], polygon[(k + 1) % polygon.size()]);
    return 0.5 * doubled;
}

bool edges_cross(const Polygon& p, std::size_t i, std::size_t j) {
    const Eigen::Vector2d &a = p[i], &b = p[(i + 1) % p.size()], &c = p[j], &d = p[(j + 1) % p.size()];
    return cross(b - a, c - a) * cross(b - a, d - a) < 0.0 && cross(d - c, a - c) * cross(d - c, b - c) < 0.0;
}

// Points strewn at random, and the path through them turned round between two edges that cross until none does.
Polygon random_polygon(std::size_t num_corners, std::mt19937& random) {
    Polygon polygon;
    for (std::size_t k = 0; k < num_corners; ++k) polygon.emplace_back(draw(random), draw(random));
    bool crosses = true;
    while (crosses) {
        crosses = false;
        for (std::size_t i = 0; i + 2 < num_corners; ++i) {
            for (std::size_t j = i + 2; j < num_corners; ++j) {
                if (!edges_cross(polygon, i, j)) continue;
                std::reverse(polygon.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                             polygon.begin() + static_cast<std::ptrdiff_t>(j) + 1);
                crosses = true;
            }
        }
    }
    if (area_of(polygon) < 0.0) std::reverse(polygon.begin(), polygon.end());
    return polygon;
}

// Seen whole from its middle, and nowhere thin.
Polygon star(std::size_t num_corners, std::mt19937& random) {
    Polygon polygon;
    for (std::size_t k = 0; k < num_corners; ++k) {
        const double angle = 2.0 * M_PI * static_cast<double>(k) / static_cast<double>(num_corners);
        const double radius = 0.3 + 0.7 * draw(random);
        polygon.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return polygon;
}

Polygon comb(int num_teeth) {
    Polygon polygon{{num_teeth, -1.0}, {num_teeth, 0.0}};
    for (int k = num_teeth; k-- > 0;) {
        polygon.emplace_back(k + 0.5, 1.0);
        polygon.emplace_back(k, 0.0);
    }
    polygon.emplace_back(0.0, -1.0);
    return polygon;
}

Polygon spiral(int num_steps) {
    Polygon polygon;
    const auto at = [](double radius, int step) -> Eigen::Vector2d {
        return radius * Eigen::Vector2d(std::cos(0.2 * step), std::sin(0.2 * step));
    };
    for (int step = 0; step < num_steps; ++step) polygon.push_back(at(1.3 + 0.1 * step, step));
    for (int step = num_steps; step-- > 0;) polygon.push_back(at(1.0 + 0.1 * step, step));
    return polygon;
}

struct Plane {
    Eigen::Matrix<double, 3, 2> axes;
    Eigen::Vector3d origin;
};

Plane random_plane(std::mt19937& random) {
    const Pose pose = random_pose(random, Eigen::Vector3d(draw(random), draw(random), draw(random)));
    return {pose.rotation.toRotationMatrix().leftCols<2>(), pose.translation};
}

// In single precision, as files hold them.
Corners placed(const Polygon& polygon, const Plane& plane) {
    Corners corners;
    for (const Eigen::Vector2d& corner : polygon) {
        corners.emplace_back((plane.origin + plane.axes * corner).cast<float>().cast<double>());
    }
    return corners;
}

struct Division {
    double area = 0.0;     // of all triangles, by its amount
    int against = 0;       // triangles that are wound the other way, by more than rounding
    int without_area = 0;  // or hardly any
    std::size_t triangles = 0;
};

Division divided(const Corners& corners, const Eigen::Vector3d& normal, double rounding) {
    std::int64_t work = 100'000'000;
    Division division;
    for (const auto& [a, b, c] : triangulate(corners, work)) {
        const auto at = [&](int i) -> const Eigen::Vector3d& { return corners.at(static_cast<std::size_t>(i)); };
        const Eigen::Vector3d doubled = (at(b) - at(a)).cross(at(c) - at(a));
        division.area += 0.5 * doubled.norm();
        division.against += static_cast<int>(doubled.dot(normal) < -rounding);
        division.without_area += static_cast<int>(doubled.norm() < 1e-12);
        ++division.triangles;
    }
    return division;
}

void expect_covered(const Polygon& polygon, const Plane& plane, double tolerance, const std::string& name) {
    const Eigen::Vector3d normal = plane.axes.col(0).cross(plane.axes.col(1));
    const Division division = divided(placed(polygon, plane), normal, tolerance);
    EXPECT_EQ(division.triangles, polygon.size() - 2) << name;
    EXPECT_NEAR(division.area, area_of(polygon), tolerance) << name;
    EXPECT_EQ(division.against, 0) << name;
}

TEST(EarClipping, CoversRandomPolygonsInPlanesOfAnyTiltOnce) {
    std::mt19937 random(101);
    for (int round = 0; round < 600; ++round) {
        const Polygon polygon = random_polygon(3 + random() % 30, random);
        expect_covered(polygon, random_plane(random), 2e-6, "round " + std::to_string(round));
    }
}

TEST(EarClipping, CoversCombsAndSpirals) {
    std::mt19937 random(102);
    for (const int size : {2, 5, 40}) {
        expect_covered(comb(size), random_plane(random), 1e-5 * size, "comb");
        expect_covered(spiral(size), random_plane(random), 1e-5 * size * size, "spiral");
    }
}

TEST(EarClipping, CoversThinPolygons) {
    std::mt19937 random(103);
    for (int round = 0; round < 200; ++round) {
        Polygon polygon = random_polygon(4 + random() % 12, random);
        for (Eigen::Vector2d& corner : polygon) corner.y() *= 1e-3;
        expect_covered(polygon, random_plane(random), 1e-6, "round " + std::to_string(round));
    }
}

// A concave face whose corners lie a little off one plane: the triangles' area is that of the plane's to second order.
TEST(EarClipping, CoversFacesThatAreNotQuiteFlat) {
    std::mt19937 random(104);
    const Polygon bracket{{0, 0}, {1, 0}, {1, 0.2}, {0.2, 0.2}, {0.2, 1}, {0, 1}};
    for (int round = 0; round < 50; ++round) {
        const Plane plane = random_plane(random);
        const Eigen::Vector3d normal = plane.axes.col(0).cross(plane.axes.col(1));
        Corners corners = placed(bracket, plane);
        for (Eigen::Vector3d& corner : corners) corner += 0.01 * (draw(random) - 0.5) * normal;
        const Division division = divided(corners, normal, 1e-6);
        EXPECT_NEAR(division.area, 0.36, 0.001) << round;
        EXPECT_EQ(division.against, 0) << round;
    }
}

TEST(EarClipping, CornersOnEdgesLoseNoTriangle) {
    std::mt19937 random(105);
    for (int round = 0; round < 200; ++round) {
        const Polygon polygon = star(5 + random() % 10, random);
        Polygon finer;
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Eigen::Vector2d &from = polygon[k], &to = polygon[(k + 1) % polygon.size()];
            finer.push_back(from);
            for (std::size_t step = 1, steps = random() % 4; step < steps; ++step)
                finer.emplace_back(from + (to - from) * static_cast<double>(step) / static_cast<double>(steps));
        }
        const Plane flat{Eigen::Matrix<double, 3, 2>::Identity(), Eigen::Vector3d::Zero()};
        expect_covered(finer, flat, 1e-6, "flat " + std::to_string(round));
        expect_covered(finer, random_plane(random), 2e-6, "tilted " + std::to_string(round));
        EXPECT_EQ(divided(placed(finer, flat), Eigen::Vector3d::UnitZ(), 1e-6).without_area, 0) << round;
    }
}

TEST(EarClipping, RepeatedCornersAndSpikesAddNoArea) {
    std::mt19937 random(106);
    for (int round = 0; round < 200; ++round) {
        const Polygon polygon = random_polygon(3 + random() % 10, random);
        Polygon longer;
        for (const Eigen::Vector2d& corner : polygon) {
            longer.push_back(corner);
            if (random() % 3 == 0) longer.push_back(corner);
            if (random() % 4 != 0) continue;
            longer.emplace_back(corner.x() + draw(random), corner.y() + 0.3);
            longer.push_back(corner);
        }
        const Division division = divided(placed(longer, random_plane(random)), Eigen::Vector3d::Zero(), 1e-6);
        EXPECT_NEAR(division.area, area_of(polygon), 5e-6) << round;
        EXPECT_EQ(division.triangles, longer.size() - 2) << round;
    }
}

// Exporters write a face with a hole as one polygon, which goes to the hole over a bridge and back.
TEST(EarClipping, HolesBehindBridgesStayOpen) {
    std::mt19937 random(107);
    const Polygon frame{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}};
    const Polygon two_holes{{0, 0}, {5, 0}, {5, 3}, {4, 2}, {4, 1}, {3, 1}, {3, 2}, {4, 2},
                            {5, 3}, {0, 3}, {0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}};
    for (int round = 0; round < 20; ++round) {
        expect_covered(frame, random_plane(random), 1e-5, "frame");
        expect_covered(two_holes, random_plane(random), 1e-5, "two holes");
    }
}

TEST(EarClipping, ConvexFacesStayFansFromTheirFirstCorner) {
    std::int64_t work = 0;
    EXPECT_EQ(triangulate({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, work),
              (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}}));
}

TEST(EarClipping, EndsWithAnyInputAndWithinItsWork) {
    std::mt19937 random(108);
    for (int round = 0; round < 300; ++round) {
        Corners corners;
        for (std::size_t k = 0, count = 3 + random() % 20; k < count; ++k)
            corners.emplace_back(random() % 3, random() % 3, random() % 2);
        std::int64_t work = 1'000'000;
        EXPECT_EQ(triangulate(corners, work).size(), corners.size() - 2) << round;
    }
    std::int64_t work = 1000;
    const Plane flat{Eigen::Matrix<double, 3, 2>::Identity(), Eigen::Vector3d::Zero()};
    EXPECT_TRUE(triangulate(placed(comb(500), flat), work).empty());
}

class ConcaveFaces : public FolderTest {};

// An angle bracket of two legs of 100 mm, 20 mm thick and 30 mm deep, in six-cornered faces.
TEST_F(ConcaveFaces, ABracketHasItsAreaInEveryFormat) {
    const Polygon bracket{{0, 0}, {100, 0}, {100, 20}, {20, 20}, {20, 100}, {0, 100}};
    std::vector<std::string> vertices, faces;
    for (const char* z : {"0", "30"}) {
        for (const Eigen::Vector2d& corner : bracket)
            vertices.push_back(std::to_string(corner.x()) + " " + std::to_string(corner.y()) + " " + z + "\n");
    }
    std::string obj, off = "OFF\n12 8 0\n", rows;
    for (const std::string& vertex : vertices) obj += "v " + vertex;
    std::vector<std::vector<int>> polygons{{5, 4, 3, 2, 1, 0}, {6, 7, 8, 9, 10, 11}};
    for (int k = 0; k < 6; ++k) polygons.push_back({k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k});
    for (const std::vector<int>& polygon : polygons) {
        obj += "f";
        rows += std::to_string(polygon.size());
        for (const int corner : polygon) {
            obj.append(" ").append(std::to_string(corner + 1));
            rows.append(" ").append(std::to_string(corner));
        }
        obj += "\n";
        rows += "\n";
    }
    const std::string all_vertices = std::accumulate(vertices.begin(), vertices.end(), std::string());
    write("bracket.obj", obj);
    write("bracket.off", off + all_vertices + rows);
    write("bracket.ply",
          "ply\nformat ascii 1.0\nelement vertex 12\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 8\nproperty list uchar int vertex_indices\nend_header\n" +
              all_vertices + rows);
    // Faces may come before their vertices.
    write("before.ply",
          "ply\nformat ascii 1.0\nelement face 8\nproperty list uchar int vertex_indices\n"
          "element vertex 12\nproperty float x\nproperty float y\nproperty float z\nend_header\n" +
              rows + all_vertices);
    constexpr double kArea_mm2 = 2.0 * 3600.0 + 400.0 * 30.0;
    for (const std::string name : {"bracket.obj", "bracket.off", "bracket.ply", "before.ply"}) {
        const LoadedMesh loaded = load_mesh(folder_ / name, LengthUnit::kMillimetre);
        EXPECT_NEAR(1e6 * surface_area_m2(loaded.mesh), kArea_mm2, 0.01) << name;
        EXPECT_EQ(loaded.mesh.triangles.size(), 20U) << name;
        EXPECT_EQ(loaded.repair.triangles_degenerate, 0) << name;
    }
}

TEST_F(ConcaveFaces, AFaceWithACornerThatIsMissingLosesTheTrianglesThere) {
    const std::string text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.2 0.2 0\nv 0 1 0\n";
    EXPECT_EQ(load_mesh(write("a.obj", text + "f 1 2 3 9 5\n"), LengthUnit::kMetre).repair.triangles_bad_index, 2);
    EXPECT_EQ(load_mesh(write("b.obj", text + "v nan 0 0\nf 1 2 3 6 5\n"), LengthUnit::kMetre).mesh.triangles.size(),
              1U);
}

}  // namespace
}  // namespace nearpose::test
