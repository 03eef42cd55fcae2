// The bytes of a glTF document: buffers, views of them, and accessors, which are arrays of numbers in views.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "raycast/mesh_files/gltf_fields.hpp"

namespace nearpose {

// glTF's codes of component types.
inline constexpr std::int64_t kGltfInt8 = 5120;
inline constexpr std::int64_t kGltfUint8 = 5121;
inline constexpr std::int64_t kGltfInt16 = 5122;
inline constexpr std::int64_t kGltfUint16 = 5123;
inline constexpr std::int64_t kGltfUint32 = 5125;
inline constexpr std::int64_t kGltfFloat = 5126;

struct GltfAccessor {
    std::int64_t count = 0;
    std::int64_t component = 0;  // glTF's code of the type; 0 where it refers to no bytes
    std::string_view type;       // "SCALAR", "VEC3", ...
    bool is_packed = false;      // one entry follows the other without a gap
};

// Each of the functions checks one item, which may refer to those before it, and returns it as it is written again.
class GltfBuffers {
  public:
    // `binary_chunk_bytes` is the size of a GLB's second chunk; other buffers must be regular files in `folder`.
    // `fields` and `folder` must live longer.
    GltfBuffers(const GltfFields& fields, std::uint64_t binary_chunk_bytes, const std::filesystem::path& folder)
        : fields_(fields), binary_chunk_bytes_(binary_chunk_bytes), folder_(folder) {}

    std::string buffer(const JsonValue& item);
    std::string view(const JsonValue& item);
    std::string accessor(const JsonValue& item);

    const std::vector<GltfAccessor>& accessors() const { return accessors_; }

  private:
    struct View {
        std::int64_t bytes = 0;
        std::int64_t stride = 0;  // 0: packed
    };

    // As the importer gets it: the name of a file that was checked, or data.
    std::string checked_uri(const JsonValue& uri, std::int64_t bytes) const;
    std::string checked_data_uri(std::string_view uri, std::int64_t bytes) const;

    const GltfFields& fields_;
    std::uint64_t binary_chunk_bytes_;
    const std::filesystem::path& folder_;

    std::vector<std::int64_t> buffer_bytes_;
    std::uint64_t total_buffer_bytes_ = 0;
    std::vector<View> views_;
    std::vector<GltfAccessor> accessors_;
};

}  // namespace nearpose
