#include "apps/experiment/cad_error.hpp"

#include <Eigen/Geometry>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/base/random.hpp"
#include "raycast/surface_samples.hpp"

namespace nearpose::experiment {
namespace {

// The stream of this module beside the estimator's, the simulation's and the evaluation's own.
constexpr auto kCadDraw = static_cast<RandomPurpose>(210);

constexpr float kInchForCentimetre = 2.54F, kShrinkage = 1.002F;
constexpr double kBossRadius = 0.08;   // of the box's diameter
constexpr double kLeastOfBoss = 0.25;  // of the ball's cross-section: what must go so that it matters

Mesh enlarged(Mesh mesh, float factor) {
    const Eigen::Vector3f centre = extent_of(mesh).centre_in_object().cast<float>();
    for (Eigen::Vector3f& vertex : mesh.vertices_in_object) vertex = centre + factor * (vertex - centre);
    mesh.disc_radius_m *= factor;
    return mesh;
}

Mesh mirrored(Mesh mesh) {
    const float twice = 2.0F * static_cast<float>(extent_of(mesh).centre_in_object().x());
    for (Eigen::Vector3f& vertex : mesh.vertices_in_object) vertex.x() = twice - vertex.x();
    for (Eigen::Vector3f& normal : mesh.vertex_normals_in_object) normal.x() = -normal.x();
    for (auto& [a, b, c] : mesh.triangles) std::swap(b, c);
    return mesh;
}

struct Cut {
    std::vector<std::array<int, 3>> kept;
    double area_m2 = 0.0;  // of what was cut out
};

Cut cut_out(const Mesh& mesh, const Eigen::Vector3f& centre, float radius_m) {
    Cut cut;
    for (const std::array<int, 3>& triangle : mesh.triangles) {
        Eigen::Matrix3f corners;
        for (int i = 0; i < 3; ++i)
            corners.col(i) = mesh.vertices_in_object[static_cast<std::size_t>(triangle[static_cast<std::size_t>(i)])];
        if ((corners.colwise() - centre).colwise().norm().maxCoeff() > radius_m) {
            cut.kept.push_back(triangle);
            continue;
        }
        const Eigen::Vector3f side = corners.col(1) - corners.col(0), other = corners.col(2) - corners.col(0);
        cut.area_m2 += 0.5 * side.cross(other).norm();
    }
    return cut;
}

Mesh without_a_boss(Mesh mesh, std::uint64_t seed) {
    constexpr int kPoints = 2000, kDraws = 100;
    if (mesh.is_cloud()) throw std::invalid_argument("cad missing_boss needs a model of triangles, not a cloud");
    const std::vector<Eigen::Vector3f> surface = sample_surface(mesh, kPoints, seed).points_in_object;
    const auto radius_m = static_cast<float>(kBossRadius * extent_of(mesh).diameter_m());
    RandomStream random(seed, 0, 0, kCadDraw);
    for (int draw = 0; draw < kDraws; ++draw) {
        const Eigen::Vector3f& centre = surface[static_cast<std::size_t>(random.below(kPoints))];
        Cut cut = cut_out(mesh, centre, radius_m);
        if (cut.area_m2 < kLeastOfBoss * std::numbers::pi * radius_m * radius_m || cut.kept.empty()) continue;
        mesh.triangles = std::move(cut.kept);
        return mesh;
    }
    throw std::invalid_argument("cad missing_boss: no feature of the model lies within " + std::to_string(radius_m) +
                                " m of a point of its surface: take a model of finer triangles");
}

}  // namespace

const std::vector<std::string>& cad_words() {
    static const std::vector<std::string> words = {"true",   "mirrored",     "wrong_unit",
                                                   "scaled", "missing_boss", "scaled_missing_boss"};
    return words;
}

bool is_drawn(const std::string& cad) {
    return cad == "missing_boss" || cad == "scaled_missing_boss";
}

Mesh with_cad_error(const Mesh& mesh, const std::string& cad, std::uint64_t seed) {
    if (cad == "true") return mesh;
    if (cad == "mirrored") return mirrored(mesh);
    if (cad == "wrong_unit") return enlarged(mesh, kInchForCentimetre);
    if (cad == "scaled") return enlarged(mesh, kShrinkage);
    if (cad == "missing_boss") return without_a_boss(mesh, seed);
    if (cad == "scaled_missing_boss") return enlarged(without_a_boss(mesh, seed), kShrinkage);
    throw std::invalid_argument("no such cad: " + cad + "; there are: true, mirrored, wrong_unit, scaled, " +
                                "missing_boss, scaled_missing_boss");
}

}  // namespace nearpose::experiment
