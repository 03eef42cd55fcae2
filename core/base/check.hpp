// Bounds of options.
#pragma once

#include <string>

namespace nearpose {

// Throws std::invalid_argument "<name> is <value>, but must be in <low>..<high>" unless low <= value <= high; NaN is
// refused.
void check_option(const std::string& name, double value, double low, double high);

}  // namespace nearpose
