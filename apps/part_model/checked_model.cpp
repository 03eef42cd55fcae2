#include "apps/part_model/checked_model.hpp"

#include <utility>

#include "apps/base/number_text.hpp"
#include "raycast/mesh_faults.hpp"
#include "raycast/mesh_pieces.hpp"

namespace nearpose::program {
namespace {

std::string percent(double share) {
    return data_set::format_fixed(100.0 * share, 0) + " %";
}

std::string metres(double length_m) {
    return data_set::format_fixed(length_m, length_m < 0.1 ? 3 : 2);
}

std::string counted(std::int64_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// What was left out because it cannot be used; empty where it was nothing.
std::string unusable(const MeshRepair& repair) {
    std::string text;
    const auto add = [&](std::int64_t count, const char* what) {
        if (count > 0) text += (text.empty() ? "left out " : ", ") + std::to_string(count) + " " + what;
    };
    add(repair.triangles_degenerate, "triangles without area");
    add(repair.triangles_not_finite, "triangles with a corner that is not finite");
    add(repair.triangles_bad_index, "triangles with a corner that does not exist");
    add(repair.vertices_not_finite, "vertices that are not finite");
    return text;
}

// "a piece of 1 triangle lies 3 m from the rest; a flat piece of 2 triangles is 8.5 times as large as the rest".
std::string described(const StrayPieces& strays) {
    std::string text;
    if (strays.far_pieces == 1) {
        text = "a piece of " + counted(strays.far_triangles, "triangle") + " lies " + metres(strays.distance_m) +
               " m from the rest";
    } else if (strays.far_pieces > 1) {
        text = counted(strays.far_pieces, "piece") + " of " + counted(strays.far_triangles, "triangle") + " lie " +
               metres(strays.distance_m) + " m or more from the rest";
    }
    if (strays.flat_triangles == 0) return text;
    return text + (text.empty() ? "" : "; ") + "a flat piece of " + counted(strays.flat_triangles, "triangle") +
           " is " + data_set::format_fixed(strays.flat_diameters, 1) + " times as large as the rest";
}

void add_faults(const std::string& name, const MeshFaults& faults, std::vector<std::string>& notices) {
    if (faults.has_holes()) {
        notices.push_back(name + "the surface has holes: " + percent(faults.open_edges) +
                          " of its edges belong to one triangle alone. Where faces are missing another surface is "
                          "expected than the camera sees, and poses are hardly accepted; export a closed surface");
    }
    if (faults.has_second_shell()) {
        notices.push_back(name + percent(faults.hidden) +
                          " of the surface cannot be seen from outside, as of a second shell; export the outer "
                          "surface alone");
    }
    if (faults.is_double()) {
        notices.push_back(name + percent(faults.crowded_edges) +
                          " of the edges belong to more than two triangles: faces lie double; export them once");
    }
}

}  // namespace

CheckedModel load_checked_model(const std::filesystem::path& file, LengthUnit unit, bool keep_largest) {
    LoadedMesh loaded = load_mesh(file, unit);
    CheckedModel model{std::move(loaded.mesh), {}};
    const std::string name = file.string() + ": ";
    if (const std::string text = unusable(loaded.repair); !text.empty()) model.notices.push_back(name + text);
    const StrayPieces strays = find_stray_pieces(model.mesh);
    if (strays.empty()) {
        add_faults(name, find_faults(model.mesh), model.notices);
        return model;
    }
    Mesh rest = without(strays, model.mesh);
    model.notices.push_back(name + described(strays) +
                            (keep_largest ? ": left out"
                                          : ". It counts as a part of what is looked for; where it is none, "
                                            "--keep-largest leaves it out"));
    add_faults(name, find_faults(rest), model.notices);
    if (keep_largest) model.mesh = std::move(rest);
    return model;
}

}  // namespace nearpose::program
