// Numbers to text and back, independent of the locale: with a German locale printf writes 0,9 and a CSV gains a column.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace nearpose::data_set {

// The shortest text that reads back as the same double: 0.1, 1e-07, 42. NaN and infinities give "nan", "inf", "-inf":
// no format of ours may hold them, so its writer checks before.
std::string format_number(double value);

// With `decimals` digits after the point, rounded to nearest; never an exponent, never "-0.000".
std::string format_fixed(double value, int decimals);

// The whole of `text` must be the number (no spaces, no leading '+', a point as the decimal separator); nullopt
// otherwise, and for a number that does not fit. Reads "nan" and "inf": check with std::isfinite.
std::optional<double> parse_number(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);  // digits with an optional '-'; zero-padding is fine

// `value` with at least `digits` digits, zero-padded, as BOP names its files: 000042.
std::string zero_padded(std::int64_t value, int digits = 6);

}  // namespace nearpose::data_set
