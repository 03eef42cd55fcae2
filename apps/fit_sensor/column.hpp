// Columns of the tables that fit-sensor prints.
#pragma once

#include <string>

namespace nearpose::program {

// Right-aligned in `width` characters; a longer text follows one blank.
inline std::string column(const std::string& text, std::size_t width) {
    return std::string(text.size() < width ? width - text.size() : 1, ' ') + text;
}

}  // namespace nearpose::program
