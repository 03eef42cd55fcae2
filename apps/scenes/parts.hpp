// The parts that are built into the program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apps/data_set/bop_models.hpp"
#include "apps/scenes/scenario.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::simulate {

// "engine_block", "flange" (six-fold but for one hole), "bracket" (thin bent sheet): BOP objects 1, 2 and 3.
const std::vector<std::string>& part_names();
int object_id_of(const std::string& part_name);

// The bytes of the part's binary PLY file, in millimetres. Throws std::invalid_argument that lists the names.
std::string_view embedded_part_bytes(const std::string& part_name);

struct EmbeddedPart {
    Mesh mesh;  // metres; the box around it is centred on the origin, z points up
    Part part;  // what camera paths must know of it
};
EmbeddedPart embedded_part(const std::string& part_name);

}  // namespace nearpose::simulate
