// The engine block that is part of the program, so that a simulation needs no file.
#pragma once

#include <string_view>

#include "raycast/mesh.hpp"

namespace nearpose::simulate {

// The bytes of a binary PLY file in millimetres.
std::string_view embedded_engine_block_bytes();

// Metres. The box around it is centred on the origin; z points up, out of the deck.
Mesh embedded_engine_block();

}  // namespace nearpose::simulate
