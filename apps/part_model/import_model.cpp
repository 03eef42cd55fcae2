#include "apps/part_model/import_model.hpp"

#include <stdexcept>
#include <utility>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/model_diameter.hpp"
#include "apps/part_model/checked_model.hpp"
#include "apps/part_model/model_symmetries.hpp"

namespace nearpose::data_set {

ModelImportSummary import_model(const ModelImport& options) {
    if (options.object_id < 0) {
        throw std::invalid_argument("object id is " + std::to_string(options.object_id) + ", but must not be negative");
    }
    program::CheckedModel loaded = program::load_checked_model(options.model, options.unit, options.keep_largest);
    create_folder(options.models_folder);
    const std::filesystem::path info_file = options.models_folder / "models_info.json";
    std::map<int, ModelInfo> models;
    if (std::filesystem::exists(info_file)) models = read_models_info(info_file);

    ModelImportSummary summary;
    const ModelExtent extent = extent_of(loaded.mesh);
    summary.info.diameter_m = diameter_of(loaded.mesh.vertices_in_object);
    summary.info.box_min_in_object_m = extent.box_min_in_object;
    summary.info.box_max_in_object_m = extent.box_max_in_object;
    if (options.find_symmetries) {
        summary.symmetries = program::find_symmetries(loaded.mesh, options.symmetry_resolution_m);
        program::declare(summary.symmetries, summary.info);
    }
    summary.file = options.models_folder / ("obj_" + zero_padded(options.object_id) + ".ply");
    summary.warnings = std::move(loaded.notices);
    save_ply(loaded.mesh, summary.file, LengthUnit::kMillimetre);
    models[options.object_id] = summary.info;
    write_models_info(info_file, models);
    return summary;
}

}  // namespace nearpose::data_set
