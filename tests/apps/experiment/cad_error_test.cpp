#include "apps/experiment/cad_error.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numeric>

#include "apps/scenes/parts.hpp"
#include "apps/scenes/world.hpp"

namespace nearpose::experiment {
namespace {

// A part whose box is not about the origin.
Mesh flange_aside() {
    Mesh mesh = simulate::embedded_part("flange").mesh;
    for (Eigen::Vector3f& vertex : mesh.vertices_in_object) vertex += Eigen::Vector3f(0.3F, -0.1F, 0.05F);
    return mesh;
}

// Six times what the surface encloses: negative where the normals point inwards.
double signed_volume(const Mesh& mesh) {
    const auto corner = [&](int vertex) {
        return mesh.vertices_in_object[static_cast<std::size_t>(vertex)].cast<double>().eval();
    };
    return std::accumulate(mesh.triangles.begin(), mesh.triangles.end(), 0.0, [&](double sum, const auto& triangle) {
        return sum + corner(triangle[0]).dot(corner(triangle[1]).cross(corner(triangle[2])));
    });
}

double surface(const Mesh& mesh) {
    double area_m2 = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Eigen::Vector3f& from = mesh.vertices_in_object[static_cast<std::size_t>(a)];
        area_m2 += 0.5 * (mesh.vertices_in_object[static_cast<std::size_t>(b)] - from)
                             .cross(mesh.vertices_in_object[static_cast<std::size_t>(c)] - from)
                             .norm();
    }
    return area_m2;
}

TEST(CadError, NoneLeavesThePartsMiddleElsewhere) {
    const Mesh mesh = flange_aside();
    const Eigen::Vector3d centre = extent_of(mesh).centre_in_object();
    for (const std::string& cad : cad_words()) {
        const Mesh wrong = with_cad_error(mesh, cad, 3);
        EXPECT_LT((extent_of(wrong).centre_in_object() - centre).norm(), 1e-7) << cad;
        EXPECT_EQ(wrong.vertices_in_object.size(), mesh.vertices_in_object.size()) << cad;
    }
    EXPECT_EQ(with_cad_error(mesh, "true", 3).vertices_in_object, mesh.vertices_in_object);
    EXPECT_THROW(with_cad_error(mesh, "mirored", 3), std::invalid_argument);
}

TEST(CadError, ScalesAreWhatTheySay) {
    const Mesh mesh = flange_aside();
    const double diameter_m = extent_of(mesh).diameter_m();
    EXPECT_NEAR(extent_of(with_cad_error(mesh, "wrong_unit", 1)).diameter_m() / diameter_m, 2.54, 1e-5);
    EXPECT_NEAR(extent_of(with_cad_error(mesh, "scaled", 1)).diameter_m() / diameter_m, 1.002, 1e-5);
    EXPECT_NEAR(extent_of(with_cad_error(mesh, "scaled_missing_boss", 1)).diameter_m() / diameter_m, 1.002, 1e-5);
}

TEST(CadError, TheMirroredPartIsTheOtherHandWithItsOutsideOutside) {
    const Mesh mesh = flange_aside();
    const Mesh mirrored = with_cad_error(mesh, "mirrored", 1);
    EXPECT_NEAR(signed_volume(mirrored), signed_volume(mesh), 1e-6 * std::abs(signed_volume(mesh)));
    const double twice = 2.0 * extent_of(mesh).centre_in_object().x();
    for (std::size_t i = 0; i < mesh.vertices_in_object.size(); ++i) {
        EXPECT_NEAR(mirrored.vertices_in_object[i].x(), twice - mesh.vertices_in_object[i].x(), 1e-6);
        EXPECT_EQ(mirrored.vertices_in_object[i].tail<2>(), mesh.vertices_in_object[i].tail<2>());
    }
    const Mesh twice_mirrored = with_cad_error(mirrored, "mirrored", 1);
    EXPECT_EQ(twice_mirrored.triangles, mesh.triangles);
}

TEST(CadError, AMissingBossIsOfTheSizeOfTheBall) {
    for (const std::string& name : simulate::part_names()) {
        const Mesh mesh = simulate::embedded_part(name).mesh;
        const double radius_m = 0.08 * extent_of(mesh).diameter_m(), cross_section_m2 = M_PI * radius_m * radius_m;
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            const Mesh missing = with_cad_error(mesh, "missing_boss", seed);
            EXPECT_GT(surface(mesh) - surface(missing), 0.24 * cross_section_m2) << name;
            EXPECT_LT(surface(missing), surface(mesh)) << name;
            EXPECT_EQ(missing.triangles, with_cad_error(mesh, "missing_boss", seed).triangles);
            // What is gone lies within one ball: no two of its points are farther apart than its diameter.
            Eigen::AlignedBox3f gone;
            std::size_t kept = 0;
            for (const auto& triangle : mesh.triangles) {
                if (kept < missing.triangles.size() && missing.triangles[kept] == triangle) {
                    ++kept;
                    continue;
                }
                for (const int vertex : triangle)
                    gone.extend(mesh.vertices_in_object[static_cast<std::size_t>(vertex)]);
            }
            EXPECT_EQ(kept, missing.triangles.size());
            EXPECT_LE(gone.sizes().maxCoeff(), 2.0 * radius_m + 1e-6);
        }
        EXPECT_NE(with_cad_error(mesh, "missing_boss", 1).triangles, with_cad_error(mesh, "missing_boss", 2).triangles);
    }
}

TEST(CadError, ABoxHasNoBoss) {
    const Mesh box = simulate::box_mesh({0.0, 0.0, 0.0}, {0.1, 0.1, 0.1});
    EXPECT_THROW(with_cad_error(box, "missing_boss", 1), std::invalid_argument);
    Mesh cloud = box;
    cloud.triangles.clear();
    EXPECT_THROW(with_cad_error(cloud, "missing_boss", 1), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::experiment
