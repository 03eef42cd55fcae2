// Numbers in messages, the same in every locale.
#pragma once

#include <string>

namespace nearpose {

// With so many digits after the point.
std::string fixed_text(double value, int decimals);

}  // namespace nearpose
