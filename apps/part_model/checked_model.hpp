// A model as it is loaded, and what its user should know about it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "raycast/mesh_loader.hpp"

namespace nearpose::program {

struct CheckedModel {
    Mesh mesh;
    std::vector<std::string> notices;  // sentences that begin with the file's name
};

// Loads `file`. `keep_largest` leaves out pieces that lie apart from the largest, and a floor (find_stray_pieces);
// without it they are named in a notice. Throws std::runtime_error as load_mesh does.
CheckedModel load_checked_model(const std::filesystem::path& file, LengthUnit unit, bool keep_largest);

}  // namespace nearpose::program
