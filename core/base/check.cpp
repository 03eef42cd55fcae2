#include "core/base/check.hpp"

#include <sstream>
#include <stdexcept>

namespace nearpose {

void check_option(const std::string& name, double value, double low, double high) {
    if (value >= low && value <= high) return;  // false for NaN
    std::ostringstream message;
    message.imbue(std::locale::classic());
    message << name << " is " << value << ", but must be in " << low << ".." << high;
    throw std::invalid_argument(message.str());
}

}  // namespace nearpose
