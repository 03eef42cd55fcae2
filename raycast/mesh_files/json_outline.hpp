// The outline of a JSON text, enough to check a glTF file before a library reads it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nearpose {

struct JsonValue {
    enum class Kind { kObject, kArray, kString, kNumber, kLiteral };

    Kind kind = Kind::kLiteral;
    std::string_view text;               // as it stands in the file; of a string what is between the quotes
    std::vector<std::string_view> keys;  // of an object, one for each item
    std::vector<JsonValue> items;        // of an object or an array

    // The first member of an object called `key`; null where there is none.
    const JsonValue* find(std::string_view key) const;
    // The value as an integer of 0 or more.
    std::optional<std::int64_t> as_count() const;
};

// Refers to `text`, which must live longer. Throws std::runtime_error that names `source` for what is not JSON, is
// nested deeper than `max_depth`, or holds more than `max_values` values.
JsonValue parse_json_outline(std::string_view text, const std::string& source, int max_depth, int max_values);

}  // namespace nearpose
