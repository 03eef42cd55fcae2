#include "raycast/mesh_faults.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "raycast/embree_scene.hpp"
#include "raycast/mesh_pieces.hpp"
#include "raycast/surface_samples.hpp"

namespace nearpose {
namespace {

constexpr double kJoinedDiameters = 1e-5;

// For each vertex the number of its cell; vertices of one cell count as one.
std::vector<std::uint32_t> cells_of(const Mesh& mesh) {
    const ModelExtent extent = extent_of(mesh);
    const double side_m = kJoinedDiameters * extent.diameter_m();
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
    for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) {
        const Eigen::Vector3d cell = ((vertex.cast<double>() - extent.box_min_in_object) / side_m).array().round();
        std::uint64_t key = 0;
        for (const double coordinate : cell) key = key << 21U | static_cast<std::uint64_t>(coordinate);
        keys.emplace_back(key, static_cast<std::uint32_t>(keys.size()));
    }
    std::sort(keys.begin(), keys.end());
    std::vector<std::uint32_t> cells(keys.size());
    std::uint32_t number = 0;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (i > 0 && keys[i].first != keys[i - 1].first) ++number;
        cells[keys[i].second] = number;
    }
    return cells;
}

void count_edges(const Mesh& mesh, MeshFaults& faults) {
    const std::vector<std::uint32_t> cells = cells_of(mesh);
    std::vector<std::uint64_t> edges;
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint64_t a = cells[static_cast<std::size_t>(triangle[k])];
            const std::uint64_t b = cells[static_cast<std::size_t>(triangle[(k + 1) % 3])];
            if (a != b) edges.push_back(std::min(a, b) << 32U | std::max(a, b));
        }
    }
    std::sort(edges.begin(), edges.end());
    std::size_t all = 0;
    std::size_t open = 0;
    std::size_t crowded = 0;
    for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
        while (last < edges.size() && edges[last] == edges[first]) ++last;
        ++all;
        open += static_cast<std::size_t>(last - first == 1);
        crowded += static_cast<std::size_t>(last - first > 2);
    }
    if (all == 0) return;
    faults.open_edges = static_cast<double>(open) / static_cast<double>(all);
    faults.crowded_edges = static_cast<double>(crowded) / static_cast<double>(all);
}

// The share of directions around `direction` in which nothing is met from `origin` on.
double open_share(const EmbreeScene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
    const PinholeCamera camera{8, 8, 2.5, 2.5, 3.5, 3.5};  // 54 degrees to each side
    Pose camera_from_object;
    camera_from_object.rotation = Eigen::Quaterniond::FromTwoVectors(direction, Eigen::Vector3d::UnitZ());
    camera_from_object.translation = -(camera_from_object.rotation * origin);
    const double met = static_cast<double>(scene.cast(camera_from_object, camera).size());
    return 1.0 - met / static_cast<double>(camera.width * camera.height);
}

void look_out(const Mesh& mesh, MeshFaults& faults) {
    constexpr int kPoints = 2000;
    constexpr double kOffSurface = 1e-4;  // diameters
    const EmbreeScene scene(mesh);
    const double step_m = kOffSurface * scene.extent().diameter_m();
    const SurfaceSamples samples = sample_surface(mesh, kPoints, 1);
    for (std::size_t i = 0; i < samples.points_in_object.size(); ++i) {
        const Eigen::Vector3d point = samples.points_in_object[i].cast<double>();
        const Eigen::Vector3d normal = samples.normals_in_object[i].cast<double>().normalized();
        const double front = open_share(scene, point + step_m * normal, normal);
        const double back = open_share(scene, point - step_m * normal, -normal);
        faults.see_through += std::min(front, back) / kPoints;
        faults.hidden += front == 0.0 && back == 0.0 ? 1.0 / kPoints : 0.0;
    }
}

}  // namespace

MeshFaults find_faults(const Mesh& mesh, std::size_t max_triangles) {
    MeshFaults faults;
    if (mesh.is_cloud() || mesh.triangles.size() > max_triangles) return faults;
    count_edges(mesh, faults);
    const std::vector<int> pieces = connected_pieces(mesh);
    const bool has_several = std::any_of(pieces.begin(), pieces.end(), [](int piece) { return piece > 0; });
    if (faults.open_edges > 0.1 || has_several) look_out(mesh, faults);
    return faults;
}

}  // namespace nearpose
