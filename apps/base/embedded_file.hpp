// Files that are part of the program. Symbols are defined by the assembler file that apps/CMakeLists.txt generates.
#pragma once

#include <cstddef>
#include <string_view>

// Declares the bytes of an embedded file: models/flange.ply is NEARPOSE_EMBEDDED(flange_ply). Outside any namespace.
#define NEARPOSE_EMBEDDED(name)                  \
    extern "C" {                                 \
    extern const char nearpose_##name##_begin[]; \
    extern const char nearpose_##name##_end[];   \
    }

// A declared file as text.
#define NEARPOSE_EMBEDDED_BYTES(name) \
    std::string_view(nearpose_##name##_begin, static_cast<std::size_t>(nearpose_##name##_end - nearpose_##name##_begin))
