#include "raycast/mesh_files/gltf_buffers.hpp"

#include <array>
#include <utility>

#include "raycast/mesh_files/gltf_guard.hpp"

namespace nearpose {
namespace {

std::int64_t components_of(std::string_view type) {
    constexpr std::array<std::pair<std::string_view, int>, 7> kTypes{
        {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
    for (const auto& [name, components] : kTypes) {
        if (name == type) return components;
    }
    return 0;
}

std::int64_t bytes_of(std::int64_t component) {
    switch (component) {
        case kGltfInt8:
        case kGltfUint8:
            return 1;
        case kGltfInt16:
        case kGltfUint16:
            return 2;
        case kGltfUint32:
        case kGltfFloat:
            return 4;
        default:
            return 0;
    }
}

}  // namespace

std::string GltfBuffers::buffer(const JsonValue& item) {
    const std::int64_t bytes = fields_.count_of(item, "byteLength", 0);
    total_buffer_bytes_ += static_cast<std::uint64_t>(bytes);
    if (bytes == 0 || total_buffer_bytes_ > fields_.limits().max_file_bytes)
        fields_.fail("the size of a buffer is 0 or above the limit");
    const JsonValue* uri = item.find("uri");
    std::string out = "{\"byteLength\":" + std::to_string(bytes);
    if (uri == nullptr) {
        const bool is_chunk = buffer_bytes_.empty() && static_cast<std::uint64_t>(bytes) <= binary_chunk_bytes_;
        if (!is_chunk) fields_.fail("a buffer has neither a uri nor enough bytes in the file");
    } else {
        out += ",\"uri\":\"" + checked_uri(*uri, bytes) + "\"";
    }
    buffer_bytes_.push_back(bytes);
    return out + "}";
}

// The same data with a plain media type: the importer takes the data to be missing where the type is long.
std::string GltfBuffers::checked_data_uri(std::string_view uri, std::int64_t bytes) const {
    constexpr std::string_view kMarker = ";base64,";
    const std::size_t marker = uri.substr(0, 256).find(kMarker);
    if (marker == uri.npos) fields_.fail("a data uri is not in base64");
    const std::string_view data = uri.substr(marker + kMarker.size());
    const std::size_t num_letters = data.find_last_not_of('=') + 1;
    const bool is_base64 =
        data.size() % 4 == 0 && data.size() - num_letters <= 2 &&
        data.substr(0, num_letters)
                .find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/") == data.npos;
    if (!is_base64) fields_.fail("a data uri is not valid base64");
    const std::size_t decoded = num_letters * 3 / 4;
    if (decoded < static_cast<std::uint64_t>(bytes) || decoded > fields_.limits().max_file_bytes) {
        fields_.fail("a data uri is shorter than its buffer");
    }
    return "data:application/octet-stream;base64," + std::string(data);
}

std::string GltfBuffers::checked_uri(const JsonValue& uri, std::int64_t bytes) const {
    if (uri.kind != JsonValue::Kind::kString) fields_.fail("the uri of a buffer is not a string");
    if (uri.text.starts_with("data:")) return checked_data_uri(uri.text, bytes);
    const std::string name = file_name_of(uri.text);
    if (!is_own_file(folder_, name)) {
        fields_.fail("the buffer \"" + std::string(uri.text.substr(0, 200)) +
                     "\" is not a regular file beside it with a plain name");
    }
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(folder_ / name, error);
    if (error || size < static_cast<std::uint64_t>(bytes) || size > fields_.limits().max_file_bytes) {
        fields_.fail("the file \"" + name + "\" is shorter than its buffer, or above the limit");
    }
    return name;
}

std::string GltfBuffers::view(const JsonValue& item) {
    const std::int64_t buffer = fields_.index_of(item, "buffer", buffer_bytes_.size());
    const std::int64_t offset = fields_.count_of(item, "byteOffset", 0);
    const std::int64_t bytes = fields_.count_of(item, "byteLength", 0);
    const std::int64_t stride = fields_.count_of(item, "byteStride", 0);
    if (bytes == 0 || offset + bytes > buffer_bytes_[static_cast<std::size_t>(buffer)]) {
        fields_.fail("a buffer view is empty or reaches beyond its buffer");
    }
    if (stride != 0 && (stride < 4 || stride > 252)) fields_.fail("the stride of a buffer view is not in 4..252");
    views_.push_back({bytes, stride});
    std::string out = "{\"buffer\":" + std::to_string(buffer) + ",\"byteOffset\":" + std::to_string(offset) +
                      ",\"byteLength\":" + std::to_string(bytes);
    if (stride != 0) out += ",\"byteStride\":" + std::to_string(stride);
    return out + "}";
}

std::string GltfBuffers::accessor(const JsonValue& item) {
    const std::int64_t component = fields_.count_of(item, "componentType", 0);
    const JsonValue* type = item.find("type");
    const std::int64_t num_components = type == nullptr ? 0 : components_of(type->text);
    const std::int64_t element = bytes_of(component) * num_components;
    const std::int64_t count = fields_.count_of(item, "count", 0);
    if (element == 0 || count == 0) fields_.fail("an accessor has no known type or no entries");
    if (count > 3 * fields_.limits().max_triangles) fields_.fail("an accessor is above the limit of vertices");
    GltfAccessor accessor{count, component, type->text, true};
    // Accessors without a view or with sparse changes hold nothing of a plain model's shape. They stay in place,
    // since indices count them, but as one number; used for positions, they are refused there.
    if (item.find("bufferView") == nullptr || item.find("sparse") != nullptr) {
        accessors_.push_back({});
        return R"({"componentType":5126,"count":1,"type":"SCALAR"})";
    }
    const std::int64_t view = fields_.index_of(item, "bufferView", views_.size());
    const std::int64_t offset = fields_.count_of(item, "byteOffset", 0);
    const View& bytes = views_[static_cast<std::size_t>(view)];
    accessor.is_packed = bytes.stride == 0 || bytes.stride == element;
    const std::int64_t stride = bytes.stride == 0 ? element : bytes.stride;
    if (stride < element || offset + (count - 1) * stride + element > bytes.bytes) {
        fields_.fail("an accessor reaches beyond its buffer view");
    }
    accessors_.push_back(accessor);
    return "{\"bufferView\":" + std::to_string(view) + ",\"byteOffset\":" + std::to_string(offset) +
           ",\"componentType\":" + std::to_string(component) + ",\"count\":" + std::to_string(count) + ",\"type\":\"" +
           std::string(type->text) + "\"}";
}

}  // namespace nearpose
