#include "raycast/mesh_loader.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "raycast/mesh_files/point_cloud.hpp"
#include "raycast/mesh_files/readers.hpp"

namespace nearpose {
namespace {

struct UnitName {
    LengthUnit unit;
    const char* symbol;
    const char* word;
    double metres;
};

constexpr std::array<UnitName, 4> kUnits{{{LengthUnit::kMetre, "m", "metre", 1.0},
                                          {LengthUnit::kMillimetre, "mm", "millimetre", 1e-3},
                                          {LengthUnit::kCentimetre, "cm", "centimetre", 1e-2},
                                          {LengthUnit::kInch, "in", "inch", 0.0254}}};

const UnitName& entry_of(LengthUnit unit) {
    return *std::find_if(kUnits.begin(), kUnits.end(), [&](const UnitName& entry) { return entry.unit == unit; });
}

Mesh read_by_extension(const std::filesystem::path& path, const MeshLimits& limits, MeshRepair& repair) {
    std::string extension = path.extension().string();
    for (char& letter : extension) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    const std::string source = path.string();
    constexpr const char* kWhatToDo = "export the model as PLY, STL or OBJ";
    if (extension == ".dae" || extension == ".3mf") {
        throw std::runtime_error(source + ": " + extension +
                                 " files are not read, since their importer fails on damaged " + "files; " + kWhatToDo);
    }
    constexpr std::array<std::string_view, 6> kExtensions{".ply", ".stl", ".obj", ".off", ".gltf", ".glb"};
    if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end()) {
        throw std::runtime_error(source +
                                 ": models are read from .ply, .stl, .obj, .off, .gltf and .glb files, not \"" +
                                 extension + "\"; " + kWhatToDo);
    }
    const std::string content = read_regular_file(path, limits.max_file_bytes);
    if (extension == ".stl") return read_stl(content, source, limits);
    const std::string_view bytes = without_byte_order_mark(content);
    if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
        throw std::runtime_error(source + ": the text is in UTF-16; save it as UTF-8");
    }
    if (extension == ".ply") return read_ply(bytes, source, limits, repair);
    if (extension == ".obj") return read_obj(bytes, source, limits, repair);
    if (extension == ".off") return read_off(bytes, source, limits, repair);
    return read_gltf(bytes, source, path.parent_path(), limits, repair);
}

std::string rounded(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g", value);
    return text.data();
}

// A wrong unit is the most common fault of a model, and nothing later can tell it from a strange scene.
void require_plausible_size(const Mesh& mesh, const std::string& source, LengthUnit unit, const MeshLimits& limits) {
    const double diameter_m = extent_of(mesh).diameter_m();
    const bool too_large = !(diameter_m <= limits.max_diameter_m);
    if (!too_large && diameter_m >= limits.min_diameter_m) return;

    std::string message = source + ": read in " + entry_of(unit).word + "s this is a part of " + rounded(diameter_m) +
                          " metres, " + (too_large ? "larger than " : "smaller than ") +
                          rounded(too_large ? limits.max_diameter_m : limits.min_diameter_m) + " m";
    // Millimetres first: CAD exports are mostly in them.
    for (LengthUnit other : {LengthUnit::kMillimetre, LengthUnit::kMetre, LengthUnit::kInch}) {
        const double other_m = diameter_m / metres_per(unit) * metres_per(other);
        if (other == unit || !(other_m >= 0.01 && other_m <= limits.max_diameter_m)) continue;
        throw std::runtime_error(message + ": the file is probably in " + entry_of(other).word + "s (" +
                                 rounded(other_m) + " m), say --unit " + to_string(other));
    }
    throw std::runtime_error(message + ": check the unit it was exported in");
}

// Far from its origin a part loses its shape: single precision, in which most files hold their numbers, has steps of a
// ten-millionth of the distance.
void require_precise(const Mesh& mesh, const std::string& source) {
    constexpr double kCoarsest = 1e-3;  // steps in diameters
    Eigen::AlignedBox3d box;
    const auto extend = [&](const Eigen::Vector3f& vertex) {
        if (vertex.allFinite()) box.extend(vertex.cast<double>());
    };
    for (const auto& triangle : mesh.triangles) {
        for (const int corner : triangle) {
            if (corner >= 0 && static_cast<std::size_t>(corner) < mesh.vertices_in_object.size())
                extend(mesh.vertices_in_object[static_cast<std::size_t>(corner)]);
        }
    }
    if (mesh.is_cloud()) std::for_each(mesh.vertices_in_object.begin(), mesh.vertices_in_object.end(), extend);
    if (box.isEmpty()) return;
    const double farthest_m = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
    const double step_m = std::nextafter(static_cast<float>(farthest_m), INFINITY) - static_cast<float>(farthest_m);
    const double diameter_m = box.diagonal().norm();
    if (step_m <= kCoarsest * diameter_m) return;
    throw std::runtime_error(source + ": the part lies " + rounded(farthest_m) +
                             " m from its origin, where numbers of single precision are " + rounded(1e3 * step_m) +
                             " mm apart: too coarse for a part of " + rounded(diameter_m) +
                             " m; move it to the origin in CAD and export it again");
}

// What a reader returned in `unit`, as load_mesh gives it.
LoadedMesh finish(Mesh raw, const std::string& source, LengthUnit unit, const MeshLimits& limits,
                  const MeshRepair& repair) {
    LoadedMesh loaded{{}, repair};
    const bool is_ply_cloud = raw.is_cloud() && !raw.vertices_in_object.empty();
    for (Eigen::Vector3f& vertex : raw.vertices_in_object) {
        const Eigen::Vector3d in_metres = vertex.cast<double>() * metres_per(unit);
        vertex = in_metres.cast<float>();
    }
    require_precise(raw, source);
    loaded.mesh = clean(std::move(raw), source, &loaded.repair);
    require_plausible_size(loaded.mesh, source, unit, limits);
    if (is_ply_cloud) {
        try {
            complete_cloud(loaded.mesh);
        } catch (const std::invalid_argument& error) {
            throw std::runtime_error(source + ": " + error.what());
        }
    }
    return loaded;
}

}  // namespace

LengthUnit parse_length_unit(std::string_view text) {
    for (const UnitName& entry : kUnits) {
        if (text == entry.symbol || text == entry.word) return entry.unit;
    }
    throw std::invalid_argument("unknown unit \"" + std::string(text) + "\": say m, mm, cm or in");
}

const char* to_string(LengthUnit unit) {
    return entry_of(unit).symbol;
}

double metres_per(LengthUnit unit) {
    return entry_of(unit).metres;
}

LoadedMesh load_mesh(const std::filesystem::path& path, LengthUnit unit, const MeshLimits& limits) {
    MeshRepair repair;
    Mesh raw = read_by_extension(path, limits, repair);
    return finish(std::move(raw), path.string(), unit, limits, repair);
}

std::vector<Eigen::Vector3d> load_vertices(const std::filesystem::path& path, LengthUnit unit,
                                           const MeshLimits& limits) {
    MeshRepair repair;
    const Mesh raw = read_by_extension(path, limits, repair);
    if (raw.vertices_in_object.empty()) throw std::runtime_error(path.string() + ": has no vertices");
    std::vector<Eigen::Vector3d> vertices;
    vertices.reserve(raw.vertices_in_object.size());
    for (const Eigen::Vector3f& vertex : raw.vertices_in_object) {
        if (!vertex.allFinite()) throw std::runtime_error(path.string() + ": a vertex is not finite");
        vertices.emplace_back(vertex.cast<double>() * metres_per(unit));
    }
    return vertices;
}

LoadedMesh load_mesh_from_bytes(std::string_view ply, const std::string& source, LengthUnit unit,
                                const MeshLimits& limits) {
    if (ply.size() > limits.max_file_bytes) {
        throw std::runtime_error(source + ": " + std::to_string(ply.size()) + " bytes are more than the limit of " +
                                 std::to_string(limits.max_file_bytes));
    }
    MeshRepair repair;
    Mesh raw = read_ply(ply, source, limits, repair);
    return finish(std::move(raw), source, unit, limits, repair);
}

}  // namespace nearpose
