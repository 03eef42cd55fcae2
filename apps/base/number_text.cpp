#include "apps/base/number_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace nearpose::data_set {
namespace {

template <typename Number>
std::optional<Number> parse_whole(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

std::string format_number(double value) {
    std::array<char, 40> text{};  // the longest double is 24 characters
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    return {text.data(), end};
}

std::string format_fixed(double value, int decimals) {
    std::array<char, 400> text{};  // the largest double has 309 digits before the point
    const int digits = std::min(decimals, 60);
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, digits).ptr;
    std::string result(text.data(), end);
    // A tiny negative number rounds to "-0.000", which reads as a change of sign that is none.
    if (result.front() == '-' && result.find_first_not_of("-0.") == std::string::npos) result.erase(0, 1);
    return result;
}

std::optional<double> parse_number(std::string_view text) {
    return parse_whole<double>(text);
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
    return parse_whole<std::int64_t>(text);
}

std::string zero_padded(std::int64_t value, int digits) {
    std::string text = std::to_string(value);
    const auto wanted = static_cast<std::size_t>(digits);
    if (text.size() < wanted) text.insert(0, wanted - text.size(), '0');
    return text;
}

}  // namespace nearpose::data_set
