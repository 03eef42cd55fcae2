#include "apps/report/shown_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace nearpose::report {
namespace {

Mesh clustered(const Mesh& mesh, double cell_m, const Eigen::Vector3d& origin) {
    std::map<std::array<std::int64_t, 3>, int> cluster_of_cell;
    std::vector<Eigen::Vector3d> sums;
    std::vector<int> counts, cluster_of_vertex;
    for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) {
        const Eigen::Vector3d place = (vertex.cast<double>() - origin) / cell_m;
        std::array<std::int64_t, 3> cell{};
        for (int axis = 0; axis < 3; ++axis) cell[axis] = static_cast<std::int64_t>(std::floor(place[axis]));
        const auto [found, added] = cluster_of_cell.emplace(cell, static_cast<int>(sums.size()));
        if (added) {
            sums.emplace_back(Eigen::Vector3d::Zero());
            counts.push_back(0);
        }
        sums[found->second] += vertex.cast<double>();
        ++counts[found->second];
        cluster_of_vertex.push_back(found->second);
    }
    Mesh result;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        result.vertices_in_object.push_back((sums[i] / counts[i]).cast<float>());
    }
    for (const std::array<int, 3>& corners : mesh.triangles) {
        const std::array<int, 3> merged = {cluster_of_vertex[corners[0]], cluster_of_vertex[corners[1]],
                                           cluster_of_vertex[corners[2]]};
        if (merged[0] != merged[1] && merged[1] != merged[2] && merged[2] != merged[0])
            result.triangles.push_back(merged);
    }
    return result;
}

std::size_t size_of(const Mesh& mesh) {
    return mesh.is_cloud() ? mesh.vertices_in_object.size() : mesh.triangles.size();
}

}  // namespace

Mesh shown_mesh(const Mesh& mesh, std::size_t max_triangles) {
    if (size_of(mesh) <= max_triangles) return mesh;
    const ModelExtent extent = extent_of(mesh);
    for (double cells = 400.0;; cells *= 0.8) {
        Mesh coarse = clustered(mesh, extent.diameter_m() / cells, extent.box_min_in_object);
        // A mesh that has lost all its triangles is none: a few large ones are kept however many small ones there are.
        if (size_of(coarse) <= max_triangles || cells < 10.0) return coarse;
    }
}

}  // namespace nearpose::report
