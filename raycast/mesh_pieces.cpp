#include "raycast/mesh_pieces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace nearpose {
namespace {

constexpr double kFarDiameters = 0.5;   // of the rest, from its box
constexpr double kFlatDiameters = 2.0;  // of the rest: parts are put together from flat pieces too, but not so
constexpr float kThickness = 1e-3F;     // of a flat piece, in its own diameters
constexpr double kMost = 0.9;           // of the triangles

struct Piece {
    Eigen::AlignedBox3f box;
    std::int64_t triangles = 0;
    float largest_squared = -1.0F;  // of its triangles' doubled area
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float offset = 0.0F;  // of the plane of its largest triangle
    bool is_flat = true;
    bool is_taken = false;

    double diameter() const { return static_cast<double>(box.sizes().norm()); }
};

class Pieces {
  public:
    explicit Pieces(const Mesh& mesh) : mesh_(mesh), piece_of_(connected_pieces(mesh)) {
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto number = static_cast<std::size_t>(piece_of_[t]);
            if (number == pieces_.size()) pieces_.emplace_back();
            extend(pieces_[number], mesh.triangles[t]);
        }
        find_planes();
    }

    std::vector<Piece>& all() { return pieces_; }
    const Piece& of_triangle(std::size_t t) const { return pieces_[static_cast<std::size_t>(piece_of_[t])]; }

    // For each piece whether it lies in the plane of piece `flat`.
    std::vector<bool> in_plane_of(const Piece& flat) const {
        std::vector<bool> is_in(pieces_.size(), true);
        const float tolerance = kThickness * static_cast<float>(flat.diameter());
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
            for (const int corner : mesh_.triangles[t]) {
                if (std::abs(flat.normal.dot(at(corner)) - flat.offset) > tolerance)
                    is_in[static_cast<std::size_t>(piece_of_[t])] = false;
            }
        }
        return is_in;
    }

  private:
    const Eigen::Vector3f& at(int vertex) const { return mesh_.vertices_in_object[static_cast<std::size_t>(vertex)]; }

    void extend(Piece& piece, const std::array<int, 3>& triangle) const {
        for (const int corner : triangle) piece.box.extend(at(corner));
        ++piece.triangles;
        const Eigen::Vector3f normal = (at(triangle[1]) - at(triangle[0])).cross(at(triangle[2]) - at(triangle[0]));
        if (normal.squaredNorm() <= piece.largest_squared) return;
        piece.largest_squared = normal.squaredNorm();
        piece.normal = normal.stableNormalized();
    }

    void find_planes() {
        std::vector<bool> is_placed(pieces_.size(), false);
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
            const auto number = static_cast<std::size_t>(piece_of_[t]);
            Piece& piece = pieces_[number];
            if (!is_placed[number]) piece.offset = piece.normal.dot(at(mesh_.triangles[t][0]));
            is_placed[number] = true;
            const float tolerance = kThickness * static_cast<float>(piece.diameter());
            for (const int corner : mesh_.triangles[t])
                piece.is_flat = piece.is_flat && std::abs(piece.normal.dot(at(corner)) - piece.offset) <= tolerance;
        }
    }

    const Mesh& mesh_;
    std::vector<int> piece_of_;  // each triangle
    std::vector<Piece> pieces_;
};

// Takes the pieces that lie near `box`, which grows with them, until none is near.
void take_near(std::vector<Piece>& pieces, const std::vector<bool>& excluded, Eigen::AlignedBox3f& box) {
    for (bool grows = true; grows;) {
        grows = false;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            Piece& piece = pieces[i];
            if (piece.is_taken || excluded[i]) continue;
            if (static_cast<double>(box.exteriorDistance(piece.box)) >
                kFarDiameters * static_cast<double>(box.sizes().norm()))
                continue;
            piece.is_taken = grows = true;
            box.extend(piece.box);
        }
    }
}

struct FlatGroup {
    std::vector<bool> is_in;  // each piece
    double diameter = 0.0;
};

// The pieces in the plane of the largest flat piece.
FlatGroup largest_flat_group(Pieces& pieces) {
    const Piece* largest = nullptr;
    for (const Piece& piece : pieces.all()) {
        if (piece.is_flat && (largest == nullptr || piece.diameter() > largest->diameter())) largest = &piece;
    }
    FlatGroup group{std::vector<bool>(pieces.all().size(), false), 0.0};
    if (largest == nullptr) return group;
    group.is_in = pieces.in_plane_of(*largest);
    Eigen::AlignedBox3f box;
    for (std::size_t i = 0; i < group.is_in.size(); ++i) {
        if (group.is_in[i]) box.extend(pieces.all()[i].box);
    }
    group.diameter = static_cast<double>(box.sizes().norm());
    return group;
}

// The box of the pieces around the one of the most triangles, which are marked as taken; empty where all are excluded.
Eigen::AlignedBox3f take_main(std::vector<Piece>& pieces, const std::vector<bool>& excluded) {
    Piece* most = nullptr;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (!excluded[i] && (most == nullptr || pieces[i].triangles > most->triangles)) most = &pieces[i];
    }
    if (most == nullptr) return {};
    most->is_taken = true;
    Eigen::AlignedBox3f box = most->box;
    take_near(pieces, excluded, box);
    return box;
}

// True if the flat pieces are not of the part: the rest, or most of it in one place, is much smaller.
bool is_floor(const FlatGroup& flat, const std::vector<Piece>& pieces, const Eigen::AlignedBox3f& main) {
    Eigen::AlignedBox3f others;
    std::int64_t num_others = 0;
    std::int64_t num_taken = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (flat.is_in[i]) continue;
        others.extend(pieces[i].box);
        num_others += pieces[i].triangles;
        if (pieces[i].is_taken) num_taken += pieces[i].triangles;
    }
    const bool most_in_one_place = static_cast<double>(num_taken) >= kMost * static_cast<double>(num_others);
    const Eigen::AlignedBox3f& rest = most_in_one_place ? main : others;
    return flat.diameter >= kFlatDiameters * static_cast<double>(rest.sizes().norm());
}

}  // namespace

std::vector<int> connected_pieces(const Mesh& mesh) {
    std::vector<int> parent(mesh.vertices_in_object.size());  // of each vertex, towards one that stands for its piece
    std::iota(parent.begin(), parent.end(), 0);
    const auto above = [&](int vertex) -> int& { return parent[static_cast<std::size_t>(vertex)]; };
    const auto root = [&](int vertex) {
        while (above(vertex) != vertex) vertex = above(vertex) = above(above(vertex));
        return vertex;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
        above(root(a)) = root(b);
        above(root(b)) = root(c);
    }
    std::vector<int> number(parent.size(), -1);
    std::vector<int> pieces;
    int num_pieces = 0;
    for (const auto& triangle : mesh.triangles) {
        int& piece = number[static_cast<std::size_t>(root(triangle[0]))];
        if (piece < 0) piece = num_pieces++;
        pieces.push_back(piece);
    }
    return pieces;
}

StrayPieces find_stray_pieces(const Mesh& mesh) {
    StrayPieces strays;
    strays.is_stray.assign(mesh.triangles.size(), false);
    if (mesh.is_cloud()) return strays;
    Pieces found(mesh);
    std::vector<Piece>& pieces = found.all();
    if (pieces.size() < 2) return strays;

    FlatGroup flat = largest_flat_group(found);
    Eigen::AlignedBox3f main = take_main(pieces, flat.is_in);
    if (main.isEmpty() || !is_floor(flat, pieces, main)) {
        flat.is_in.assign(pieces.size(), false);
        if (main.isEmpty()) main = take_main(pieces, flat.is_in);
        take_near(pieces, flat.is_in, main);
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (pieces[i].is_taken) continue;
        if (flat.is_in[i]) {
            strays.flat_triangles += pieces[i].triangles;
            strays.flat_diameters = flat.diameter / static_cast<double>(main.sizes().norm());
            continue;
        }
        const auto distance_m = static_cast<double>(main.exteriorDistance(pieces[i].box));
        strays.distance_m = strays.far_pieces == 0 ? distance_m : std::min(strays.distance_m, distance_m);
        ++strays.far_pieces;
        strays.far_triangles += pieces[i].triangles;
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) strays.is_stray[t] = !found.of_triangle(t).is_taken;
    return strays;
}

Mesh without(const StrayPieces& strays, const Mesh& mesh) {
    Mesh rest = mesh;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!strays.is_stray[t]) rest.triangles[kept++] = mesh.triangles[t];
    }
    rest.triangles.resize(kept);
    return clean(std::move(rest), "the rest of the mesh");
}

}  // namespace nearpose
