// Tables for a terminal.
#pragma once

#include <string>

#include "apps/tables/results.hpp"

namespace nearpose::compare {

// Title, text, then aligned columns; values without their intervals, "-" where there is none.
std::string text_of(const experiment::Table& table);

}  // namespace nearpose::compare
