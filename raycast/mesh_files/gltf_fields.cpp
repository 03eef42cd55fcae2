#include "raycast/mesh_files/gltf_fields.hpp"

#include <optional>

namespace nearpose {

std::int64_t GltfFields::count_of(const JsonValue& object, const std::string& key, std::int64_t otherwise) const {
    const JsonValue* value = object.find(key);
    if (value == nullptr) return otherwise;
    const std::optional<std::int64_t> count = value->as_count();
    // Sums of several such numbers stay within 64 bits.
    if (!count || *count > (std::int64_t{1} << 48)) fail(key + " is not a number of 0 or more");
    return *count;
}

std::int64_t GltfFields::index_of(const JsonValue& object, const std::string& key, std::size_t size) const {
    const std::int64_t index = count_of(object, key, -1);
    if (index < 0 || static_cast<std::size_t>(index) >= size) fail(key + " is missing or refers to nothing");
    return index;
}

std::vector<std::size_t> GltfFields::indices_of(const JsonValue& object, const std::string& key,
                                                std::size_t size) const {
    std::vector<std::size_t> indices;
    const JsonValue* values = object.find(key);
    if (values == nullptr) return indices;
    if (values->kind != JsonValue::Kind::kArray) fail(key + " is not an array");
    for (const JsonValue& value : values->items) {
        const std::optional<std::int64_t> index = value.as_count();
        if (!index || static_cast<std::uint64_t>(*index) >= size) fail(key + " refers to nothing");
        indices.push_back(static_cast<std::size_t>(*index));
    }
    return indices;
}

}  // namespace nearpose
