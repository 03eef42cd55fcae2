#include "apps/scenes/parts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "raycast/depth_renderer.hpp"

namespace nearpose::simulate {
namespace {

using Place = std::array<float, 3>;

Place place_of(const Eigen::Vector3f& point) {
    return {point.x(), point.y(), point.z()};
}

TEST(Parts, AreObjects1To3) {
    EXPECT_EQ(part_names(), (std::vector<std::string>{"engine_block", "flange", "bracket"}));
    for (int i = 0; i < 3; ++i) EXPECT_EQ(object_id_of(part_names()[static_cast<std::size_t>(i)]), i + 1);
    EXPECT_THROW(object_id_of("gear"), std::invalid_argument);
    EXPECT_THROW(embedded_part("gear"), std::invalid_argument);
}

TEST(Parts, AreClosedAndCentred) {
    for (const std::string& name : part_names()) {
        const EmbeddedPart part = embedded_part(name);
        EXPECT_LT(part.part.extent.centre_in_object().norm(), 2e-6) << name;
        EXPECT_FALSE(part.part.targets_in_object_m.empty());
        // Every directed edge once, and its opposite once. Vertices at one place count as one.
        std::map<std::pair<Place, Place>, int> edges;
        for (const auto& triangle : part.mesh.triangles) {
            for (int k = 0; k < 3; ++k) {
                const auto from = static_cast<std::size_t>(triangle[k]);
                const auto to = static_cast<std::size_t>(triangle[(k + 1) % 3]);
                ++edges[{place_of(part.mesh.vertices_in_object[from]), place_of(part.mesh.vertices_in_object[to])}];
            }
        }
        for (const auto& [edge, count] : edges) {
            const auto opposite = edges.find({edge.second, edge.first});
            ASSERT_TRUE(opposite != edges.end() && opposite->second == count) << name;
        }
    }
}

// Depth of a part turned about its z axis, seen from above [m].
DepthImage seen_from_above(const EmbreeScene& scene, double turn_rad) {
    const PinholeCamera camera{120, 120, 600.0, 600.0, 59.5, 59.5};
    Pose camera_from_object;
    camera_from_object.rotation =
        Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0) * Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ());
    camera_from_object.translation = Eigen::Vector3d(0.0, 0.0, 1.0);
    return render_depth(scene, camera_from_object, camera);
}

// Pixels whose depth changes by more than 5 mm when the part is turned.
std::vector<Eigen::Vector2d> changed_by_turn(const EmbreeScene& scene, double turn_rad) {
    const DepthImage before = seen_from_above(scene, 0.0), after = seen_from_above(scene, turn_rad);
    std::vector<Eigen::Vector2d> changed;
    for (int pixel = 0; pixel < 120 * 120; ++pixel) {
        const auto i = static_cast<std::size_t>(pixel);
        if (std::abs(before.depth_m[i] - after.depth_m[i]) <= 0.005) continue;
        // At the height of the bolted face, about 1.0 m away; image rows run against y.
        changed.emplace_back((pixel % 120 - 59.5) / 600.0, -(pixel / 120 - 59.5) / 600.0);
    }
    return changed;
}

TEST(Flange, IsSixFoldButForOneHole) {
    const EmbreeScene scene(embedded_part("flange").mesh);
    for (int k = 1; k < 6; ++k) {
        const double turn = k * M_PI / 3;
        const std::vector<Eigen::Vector2d> changed = changed_by_turn(scene, turn);
        EXPECT_GT(changed.size(), 20u);
        for (const Eigen::Vector2d& point : changed) {
            const Eigen::Vector2d odd(0.0625, 0.0), turned(0.0625 * std::cos(turn), 0.0625 * std::sin(turn));
            EXPECT_LT(std::min((point - odd).norm(), (point - turned).norm()), 0.011) << k;
        }
    }
    // Between the sixths of a turn all holes change.
    EXPECT_GT(changed_by_turn(scene, M_PI / 6).size(), 400u);
}

TEST(Bracket, HasNoSymmetry) {
    const EmbreeScene scene(embedded_part("bracket").mesh);
    for (int k = 1; k < 8; ++k) EXPECT_GT(changed_by_turn(scene, k * M_PI / 4).size(), 1000u) << k;
}

}  // namespace
}  // namespace nearpose::simulate
