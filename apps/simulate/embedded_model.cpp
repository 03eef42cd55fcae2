#include "apps/simulate/embedded_model.hpp"

#include "raycast/mesh_loader.hpp"

// Defined by the assembler file that apps/CMakeLists.txt generates around models/engine_block.ply.
extern "C" {
extern const char nearpose_engine_block_begin[];
extern const char nearpose_engine_block_end[];
}

namespace nearpose::simulate {

std::string_view embedded_engine_block_bytes() {
    return {nearpose_engine_block_begin,
            static_cast<std::size_t>(nearpose_engine_block_end - nearpose_engine_block_begin)};
}

Mesh embedded_engine_block() {
    return load_mesh_from_bytes(embedded_engine_block_bytes(), "embedded engine block", LengthUnit::kMillimetre).mesh;
}

}  // namespace nearpose::simulate
