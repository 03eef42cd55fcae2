#include "tests/bench/tessellation.hpp"

#include <array>
#include <map>

namespace nearpose::bench {
namespace {

Mesh cluster(const Mesh& mesh, float cell_m) {
    std::map<std::array<int, 3>, int> cells;
    std::vector<int> place;
    Mesh coarse;
    for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) {
        const Eigen::Vector3i cell = (vertex / cell_m).array().round().cast<int>();
        const auto [entry, is_new] =
            cells.try_emplace({cell.x(), cell.y(), cell.z()}, static_cast<int>(coarse.vertices_in_object.size()));
        if (is_new) coarse.vertices_in_object.push_back(vertex);
        place.push_back(entry->second);
    }
    for (const auto& triangle : mesh.triangles)
        coarse.triangles.push_back({place[static_cast<std::size_t>(triangle[0])],
                                    place[static_cast<std::size_t>(triangle[1])],
                                    place[static_cast<std::size_t>(triangle[2])]});
    return clean(std::move(coarse), "coarsening");
}

}  // namespace

Mesh tessellate(const Mesh& mesh, int side) {
    Mesh fine;
    for (const auto& triangle : mesh.triangles) {
        const Eigen::Vector3f& a = mesh.vertices_in_object[static_cast<std::size_t>(triangle[0])];
        const Eigen::Vector3f& b = mesh.vertices_in_object[static_cast<std::size_t>(triangle[1])];
        const Eigen::Vector3f& c = mesh.vertices_in_object[static_cast<std::size_t>(triangle[2])];
        const int first = static_cast<int>(fine.vertices_in_object.size());
        // Row i holds side - i + 1 vertices.
        const auto index = [&](int i, int j) { return first + i * (side + 1) - i * (i - 1) / 2 + j; };
        for (int i = 0; i <= side; ++i) {
            for (int j = 0; j <= side - i; ++j) {
                const float s = static_cast<float>(i) / static_cast<float>(side);
                const float t = static_cast<float>(j) / static_cast<float>(side);
                fine.vertices_in_object.push_back((1.0F - s - t) * a + s * b + t * c);
                if (i + j < side) fine.triangles.push_back({index(i, j), index(i + 1, j), index(i, j + 1)});
                if (i + j < side - 1) fine.triangles.push_back({index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)});
            }
        }
    }
    return clean(std::move(fine), "tessellation");
}

Mesh coarsen(const Mesh& mesh, std::size_t max_triangles) {
    constexpr float kFirstCell_m = 0.002F, kGrowth = 1.05F;
    Mesh coarse = mesh;
    for (float cell_m = kFirstCell_m; coarse.triangles.size() > max_triangles; cell_m *= kGrowth)
        coarse = cluster(mesh, cell_m);
    return coarse;
}

}  // namespace nearpose::bench
