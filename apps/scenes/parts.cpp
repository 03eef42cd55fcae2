#include "apps/scenes/parts.hpp"

#include <algorithm>
#include <stdexcept>

#include "apps/base/embedded_file.hpp"
#include "raycast/mesh_loader.hpp"

NEARPOSE_EMBEDDED(engine_block_ply)
NEARPOSE_EMBEDDED(flange_ply)
NEARPOSE_EMBEDDED(bracket_ply)

namespace nearpose::simulate {
namespace {

std::size_t place_of(const std::string& part_name) {
    const std::vector<std::string>& names = part_names();
    const auto found = std::find(names.begin(), names.end(), part_name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    std::string known;
    for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
    throw std::invalid_argument("no such part: " + part_name + "; there are: " + known);
}

}  // namespace

const std::vector<std::string>& part_names() {
    static const std::vector<std::string> names{"engine_block", "flange", "bracket"};
    return names;
}

int object_id_of(const std::string& part_name) {
    return static_cast<int>(place_of(part_name)) + 1;
}

std::string_view embedded_part_bytes(const std::string& part_name) {
    static const std::vector<std::string_view> bytes{NEARPOSE_EMBEDDED_BYTES(engine_block_ply),
                                                     NEARPOSE_EMBEDDED_BYTES(flange_ply),
                                                     NEARPOSE_EMBEDDED_BYTES(bracket_ply)};
    return bytes[place_of(part_name)];
}

EmbeddedPart embedded_part(const std::string& part_name) {
    EmbeddedPart result;
    result.mesh =
        load_mesh_from_bytes(embedded_part_bytes(part_name), "built-in part " + part_name, LengthUnit::kMillimetre)
            .mesh;
    const ModelExtent extent = extent_of(result.mesh);
    result.part = place_of(part_name) == 0 ? engine_block_part(extent) : box_part(extent);
    return result;
}

}  // namespace nearpose::simulate
