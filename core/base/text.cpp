#include "core/base/text.hpp"

#include <array>
#include <charconv>

namespace nearpose {

std::string fixed_text(double value, int decimals) {
    std::array<char, 400> digits{};  // the largest double has 309 before the point
    const auto end =
        std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, decimals);
    return {digits.data(), end.ptr};
}

}  // namespace nearpose
