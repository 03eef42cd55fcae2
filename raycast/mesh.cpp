#include "raycast/mesh.hpp"

#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace nearpose {
namespace {

// Beyond it products of coordinates would leave the range of float within the ray caster [m].
constexpr float kMaxCoordinate_m = 1e9F;

bool is_usable(const Eigen::Vector3f& vertex) {
    // NaN fails the comparison.
    return (vertex.array().abs() <= kMaxCoordinate_m).all();
}

// Finds equal points: an open-addressing table of indices into the points seen so far, 8 bytes a point.
class PointTable {
  public:
    explicit PointTable(std::size_t max_points) : slots_(std::bit_ceil(2 * max_points + 1), -1) {}

    // Index of the first of `points` equal to `point`; -1 if there is none, and then `next_index` is its index from now
    // on.
    int find_or_insert(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& point, int next_index) {
        const std::size_t mask = slots_.size() - 1;
        std::size_t slot = hash(point) & mask;
        for (; slots_[slot] >= 0; slot = (slot + 1) & mask) {
            if (points[static_cast<std::size_t>(slots_[slot])] == point) return slots_[slot];
        }
        slots_[slot] = next_index;
        return -1;
    }

  private:
    static std::size_t hash(const Eigen::Vector3f& point) {
        std::uint64_t state = 0;
        for (int axis = 0; axis < 3; ++axis) {
            // Adding zero makes -0 equal to +0.
            state = (state ^ std::bit_cast<std::uint32_t>(point[axis] + 0.0F)) * 0x9E3779B97F4A7C15U;
            state ^= state >> 29U;
        }
        return static_cast<std::size_t>(state ^ (state >> 32U));
    }

    std::vector<int> slots_;
};

Mesh clean_cloud(const Mesh& mesh, MeshRepair& counts) {
    const bool has_normals = mesh.vertex_normals_in_object.size() == mesh.vertices_in_object.size();
    Mesh result;
    result.disc_radius_m = mesh.disc_radius_m;
    PointTable table(mesh.vertices_in_object.size());
    for (std::size_t i = 0; i < mesh.vertices_in_object.size(); ++i) {
        const Eigen::Vector3f& point = mesh.vertices_in_object[i];
        const float length = has_normals ? mesh.vertex_normals_in_object[i].norm() : 1.0F;
        if (!is_usable(point) || !std::isfinite(length) || !(length > 0.0F)) {
            ++counts.vertices_not_finite;
        } else if (table.find_or_insert(result.vertices_in_object, point,
                                        static_cast<int>(result.vertices_in_object.size())) >= 0) {
            ++counts.vertices_joined;
        } else {
            result.vertices_in_object.push_back(point);
            if (has_normals) result.vertex_normals_in_object.push_back(mesh.vertex_normals_in_object[i] / length);
        }
    }
    return result;
}

// For each vertex its index among the distinct, usable ones, which go to `distinct`; -1 where it is not usable.
std::vector<int> join_vertices(const std::vector<Eigen::Vector3f>& vertices, std::vector<Eigen::Vector3f>& distinct,
                               MeshRepair& counts) {
    PointTable table(vertices.size());
    std::vector<int> joined(vertices.size(), -1);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (!is_usable(vertices[i])) {
            ++counts.vertices_not_finite;
            continue;
        }
        const int next = static_cast<int>(distinct.size());
        const int found = table.find_or_insert(distinct, vertices[i], next);
        if (found < 0) {
            distinct.push_back(vertices[i]);
        } else {
            ++counts.vertices_joined;
        }
        joined[i] = found < 0 ? next : found;
    }
    return joined;
}

// The triangles over the joined vertices without those whose corners are missing.
std::vector<std::array<int, 3>> usable_triangles(const Mesh& mesh, const std::vector<int>& joined, MeshRepair& counts) {
    std::vector<std::array<int, 3>> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const std::array<int, 3>& triangle : mesh.triangles) {
        std::array<int, 3> corners{};
        bool exists = true;
        bool finite = true;
        for (std::size_t k = 0; k < 3; ++k) {
            if (triangle[k] < 0 || static_cast<std::size_t>(triangle[k]) >= joined.size()) {
                exists = false;
                break;
            }
            corners[k] = joined[static_cast<std::size_t>(triangle[k])];
            finite = finite && corners[k] >= 0;
        }
        if (!exists) {
            ++counts.triangles_bad_index;
        } else if (!finite) {
            ++counts.triangles_not_finite;
        } else {
            triangles.push_back(corners);
        }
    }
    return triangles;
}

double twice_area(const std::vector<Eigen::Vector3f>& vertices, const std::array<int, 3>& triangle) {
    const Eigen::Vector3d a = vertices[static_cast<std::size_t>(triangle[0])].cast<double>();
    const Eigen::Vector3d b = vertices[static_cast<std::size_t>(triangle[1])].cast<double>();
    const Eigen::Vector3d c = vertices[static_cast<std::size_t>(triangle[2])].cast<double>();
    return (b - a).cross(c - a).norm();
}

Mesh clean_triangles(const Mesh& mesh, MeshRepair& counts) {
    Mesh joined_mesh;
    const std::vector<int> joined = join_vertices(mesh.vertices_in_object, joined_mesh.vertices_in_object, counts);
    joined_mesh.triangles = usable_triangles(mesh, joined, counts);
    if (joined_mesh.triangles.empty()) return {};

    // Only corners of triangles count for the size: a stray vertex far off would make every triangle "tiny".
    Eigen::AlignedBox3d box;
    for (const auto& triangle : joined_mesh.triangles) {
        for (int corner : triangle) {
            box.extend(joined_mesh.vertices_in_object[static_cast<std::size_t>(corner)].cast<double>());
        }
    }
    const double min_side = 1e-7 * box.diagonal().norm();
    Mesh result;
    std::vector<int> new_index(joined_mesh.vertices_in_object.size(), -1);
    for (std::array<int, 3> triangle : joined_mesh.triangles) {
        if (!(twice_area(joined_mesh.vertices_in_object, triangle) > 2.0 * min_side * min_side)) {
            ++counts.triangles_degenerate;
            continue;
        }
        for (int& corner : triangle) {
            const auto old = static_cast<std::size_t>(corner);
            if (new_index[old] < 0) {
                new_index[old] = static_cast<int>(result.vertices_in_object.size());
                result.vertices_in_object.push_back(joined_mesh.vertices_in_object[old]);
            }
            corner = new_index[old];
        }
        result.triangles.push_back(triangle);
    }
    return result;
}

void add(const MeshRepair& counts, MeshRepair& sum) {
    sum.triangles_degenerate += counts.triangles_degenerate;
    sum.triangles_not_finite += counts.triangles_not_finite;
    sum.triangles_bad_index += counts.triangles_bad_index;
    sum.vertices_not_finite += counts.vertices_not_finite;
    sum.vertices_joined += counts.vertices_joined;
}

}  // namespace

double surface_area_m2(const Mesh& mesh) {
    if (mesh.is_cloud()) {
        const double disc_m2 = std::numbers::pi * static_cast<double>(mesh.disc_radius_m * mesh.disc_radius_m);
        return disc_m2 * static_cast<double>(mesh.vertices_in_object.size());
    }
    double doubled = 0.0;
    for (const auto& triangle : mesh.triangles) {
        const auto corner = [&](int k) -> Eigen::Vector3d {
            return mesh.vertices_in_object[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])]
                .cast<double>();
        };
        doubled += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
    }
    return 0.5 * doubled;
}

ModelExtent extent_of(const Mesh& mesh) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) box.extend(vertex);
    return {box.min().cast<double>(), box.max().cast<double>()};
}

Mesh clean(Mesh mesh, const std::string& source, MeshRepair* repair) {
    MeshRepair counts;
    Mesh result = mesh.is_cloud() ? clean_cloud(mesh, counts) : clean_triangles(mesh, counts);
    if (repair != nullptr) add(counts, *repair);
    if (result.vertices_in_object.empty()) {
        throw std::runtime_error(source + ": no usable surface is left: of " + std::to_string(mesh.triangles.size()) +
                                 " triangles " + std::to_string(counts.triangles_degenerate) + " have no area, " +
                                 std::to_string(counts.triangles_not_finite) + " have a NaN or infinite corner, " +
                                 std::to_string(counts.triangles_bad_index) + " a corner that does not exist; of " +
                                 std::to_string(mesh.vertices_in_object.size()) + " vertices " +
                                 std::to_string(counts.vertices_not_finite) +
                                 " are not finite. Export the model again");
    }
    return result;
}

}  // namespace nearpose
