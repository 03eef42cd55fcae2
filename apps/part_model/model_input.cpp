#include "apps/part_model/model_input.hpp"

#include <CLI/CLI.hpp>

#include "apps/base/console.hpp"
#include "apps/data_set/bop_models.hpp"
#include "apps/part_model/checked_model.hpp"

namespace nearpose::program {
void add_model_file_options(CLI::App& command, ModelOptions& options) {
    command.add_option("--model", options.model, "Model: PLY (mesh or dense point cloud), STL, OBJ, OFF, glTF, GLB");
    command.add_option("--unit", options.unit, "Unit of --model: m, mm, cm or in [mm; m for glTF]")
        ->check(CLI::IsMember({"m", "mm", "cm", "in"}));
    command.add_flag("--keep-largest", options.keep_largest,
                     "Leave out pieces of the model that lie apart from the largest, and a floor under it");
}

void add_bop_model_options(CLI::App& command, ModelOptions& options) {
    command.add_option("--models", options.models, "Folder of BOP models (obj_NNNNNN.ply, millimetres)");
    command.add_option("--object", options.object, "Number of the object, also in the results")
        ->check(CLI::NonNegativeNumber);
}

void check(const ModelOptions& options) {
    if (options.model.empty() && options.models.empty()) {
        throw BadUse("a model is needed: --models DIR --object ID, or --model FILE --unit mm");
    }
    if (!options.model.empty() && !options.models.empty()) throw BadUse("--model and --models exclude each other");
    if (!options.model.empty() && std::filesystem::is_directory(options.model)) {
        throw BadUse("--model " + options.model.string() + " is a folder; --models takes a folder of BOP models");
    }
    if (options.model.empty() && !options.unit.empty()) {
        throw BadUse("--unit belongs to --model: BOP models are in millimetres");
    }
}

std::filesystem::path model_file(const ModelOptions& options) {
    check(options);
    return options.model.empty() ? data_set::model_path(options.models, options.object) : options.model;
}

LengthUnit model_unit(const ModelOptions& options) {
    if (!options.unit.empty()) return parse_length_unit(options.unit);
    std::string extension = options.model.extension().string();
    for (char& letter : extension) letter = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter + 32) : letter;
    return extension == ".gltf" || extension == ".glb" ? LengthUnit::kMetre : LengthUnit::kMillimetre;
}

Mesh load_model(const ModelOptions& options, const SharedOptions& shared) {
    CheckedModel model = load_checked_model(model_file(options), model_unit(options), options.keep_largest);
    for (const std::string& notice : model.notices) print_notice(notice, shared.quiet);
    return std::move(model.mesh);
}

}  // namespace nearpose::program
