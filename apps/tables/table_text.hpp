// Tables for a terminal.
#pragma once

#include <string>

#include "apps/tables/results.hpp"

namespace nearpose::tables {

// Title, text, then aligned columns; values without their intervals, "-" where there is none.
std::string text_of(const Table& table);

}  // namespace nearpose::tables
