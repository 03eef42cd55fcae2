// A CAD model or dense cloud with its unit into BOP's models folder: obj_NNNNNN.ply in millimetres and
// models_info.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/data_set/bop_models.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose::data_set {

struct ModelImport {
    std::filesystem::path model;
    LengthUnit unit = LengthUnit::kMillimetre;
    int object_id = 1;
    std::filesystem::path models_folder;
    bool find_symmetries = true;
    std::optional<double> symmetry_resolution_m = std::nullopt;  // see program::find_symmetries
    bool keep_largest = false;                                   // see program::load_checked_model
};

struct ModelImportSummary {
    std::filesystem::path file;
    ModelInfo info;
    Symmetries symmetries;              // what was found; the exact ones are in `info`
    std::vector<std::string> warnings;  // sentences for the user
};

// Adds to a models_info.json that is there already. Throws std::runtime_error naming the file and the cause.
ModelImportSummary import_model(const ModelImport& options);

}  // namespace nearpose::data_set
