#include "raycast/mesh_files/face_writer.hpp"

#include <stdexcept>

#include "raycast/mesh_files/ear_clipping.hpp"

namespace nearpose {
namespace {

// Ten seconds, which a face of 20 000 corners may take; some more than files for people ever have.
constexpr std::int64_t kMaxEdgesLookedAt = 1'000'000'000;

}  // namespace

void FaceWriter::add(const std::vector<int>& corners) {
    if (corners.size() < 3) {
        ++repair_.triangles_degenerate;
        return;
    }
    if (mesh_.triangles.size() + corners.size() - 2 > static_cast<std::size_t>(limits_.max_triangles)) {
        throw std::runtime_error(source_ + ": more triangles than the limit of " +
                                 std::to_string(limits_.max_triangles));
    }
    if (corners.size() > 3) {
        polygons_.push_back({static_cast<int>(mesh_.triangles.size()), static_cast<int>(corners.size())});
    }
    for (std::size_t k = 2; k < corners.size(); ++k)
        mesh_.triangles.push_back({corners[0], corners[k - 1], corners[k]});
}

void FaceWriter::finish() {
    std::int64_t work = kMaxEdgesLookedAt;
    std::vector<int> indices;
    std::vector<Eigen::Vector3d> corners;
    for (const Polygon& polygon : polygons_) {
        std::array<int, 3>* const triangles = &mesh_.triangles[static_cast<std::size_t>(polygon.first_triangle)];
        indices.assign({triangles[0][0], triangles[0][1]});
        for (int k = 0; k + 2 < polygon.num_corners; ++k) indices.push_back(triangles[k][2]);
        corners.clear();
        for (const int index : indices) {
            if (index < 0 || static_cast<std::size_t>(index) >= mesh_.vertices_in_object.size()) break;
            const Eigen::Vector3f& corner = mesh_.vertices_in_object[static_cast<std::size_t>(index)];
            if (!corner.allFinite()) break;
            corners.push_back(corner.cast<double>());
        }
        // A polygon with a corner that is missing stays a fan, of which `clean` drops what cannot be used.
        if (corners.size() != indices.size()) continue;
        const std::vector<std::array<int, 3>> divided = triangulate(corners, work);
        if (divided.empty()) {
            throw std::runtime_error(source_ + ": concave faces of very many corners, such as one of " +
                                     std::to_string(polygon.num_corners) + "; export it as triangles");
        }
        for (std::size_t t = 0; t < divided.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) triangles[t][k] = indices[static_cast<std::size_t>(divided[t][k])];
        }
    }
}

}  // namespace nearpose
