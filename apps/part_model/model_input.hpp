// The model that a command works with: one of a folder of BOP models, or any file with its unit.
#pragma once

#include <filesystem>
#include <string>

#include "apps/base/command.hpp"
#include "raycast/mesh.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose::program {

struct ModelOptions {
    std::filesystem::path models;  // folder of BOP models; used with `object`
    int object = 1;
    std::filesystem::path model;  // a file; instead of `models`
    std::string unit;             // of that file: m, mm, cm, in; empty: mm, or m for glTF
    bool keep_largest = false;    // see load_checked_model
};

// --model FILE, --unit UNIT and --keep-largest.
void add_model_file_options(CLI::App& command, ModelOptions& options);
// --models DIR and --object ID.
void add_bop_model_options(CLI::App& command, ModelOptions& options);

// Throws BadUse where the options name no model or two.
void check(const ModelOptions& options);
// The file that they name.
std::filesystem::path model_file(const ModelOptions& options);
// The unit that the options say, or the usual one of the format.
LengthUnit model_unit(const ModelOptions& options);

// Loads it, with notices about what is wrong with it. Throws std::runtime_error naming the file.
Mesh load_model(const ModelOptions& options, const SharedOptions& shared);

}  // namespace nearpose::program
