#include "raycast/mesh_files/gltf_guard.hpp"

#include <charconv>
#include <stdexcept>

#include "raycast/mesh_files/gltf_buffers.hpp"
#include "raycast/mesh_files/gltf_fields.hpp"
#include "raycast/mesh_files/gltf_nodes.hpp"

namespace nearpose {
namespace {

std::size_t count_nodes(const JsonValue& document) {
    const JsonValue* nodes = document.find("nodes");
    return nodes == nullptr ? 0 : nodes->items.size();
}

class GltfChecker {
  public:
    GltfChecker(const JsonValue& document, std::uint64_t binary_chunk_bytes, const std::string& source,
                const std::filesystem::path& folder, const MeshLimits& limits)
        : document_(document),
          fields_(source, limits),
          buffers_(fields_, binary_chunk_bytes, folder),
          nodes_(fields_, count_nodes(document)) {}

    std::string run() {
        if (document_.kind != JsonValue::Kind::kObject) fields_.fail("the document is not an object");
        check_asset();
        std::string out = R"({"asset":{"version":"2.0"})";
        // In this order: what is referred to is checked before what refers to it.
        out += list("buffers", [this](const JsonValue& item) { return buffers_.buffer(item); });
        out += list("bufferViews", [this](const JsonValue& item) { return buffers_.view(item); });
        out += list("accessors", [this](const JsonValue& item) { return buffers_.accessor(item); });
        out += list("meshes", [this](const JsonValue& item) { return mesh(item); });
        out += list("nodes", [this](const JsonValue& item) { return nodes_.node(item, num_meshes_); });
        nodes_.count_instances();
        out += list("scenes", [this](const JsonValue& item) { return nodes_.scene(item); });
        if (nodes_.num_scenes() == 0) fields_.fail("it has no scene");
        const std::int64_t shown = fields_.count_of(document_, "scene", 0);
        if (shown >= nodes_.num_scenes()) fields_.fail("its scene does not exist");
        return out + ",\"scene\":" + std::to_string(shown) + "}";
    }

  private:
    template <typename Check>
    std::string list(const std::string& name, Check check) const {
        return fields_.list(document_, name, check);
    }

    void check_asset() const {
        const JsonValue* asset = document_.find("asset");
        const JsonValue* version = asset == nullptr ? nullptr : asset->find("version");
        if (version == nullptr || !version->text.starts_with("2.")) fields_.fail("the version is not 2");
        const JsonValue* required = document_.find("extensionsRequired");
        if (required == nullptr) return;
        for (const JsonValue& name : required->items) {
            // How a surface looks does not matter here; every other extension may change where it is.
            if (!name.text.starts_with("KHR_materials") && !name.text.starts_with("KHR_texture")) {
                fields_.fail("it needs the extension " + std::string(name.text.substr(0, 60)) +
                             ", which is not supported: export without compression or quantisation");
            }
        }
    }

    std::string mesh(const JsonValue& item) {
        const JsonValue* primitives = item.find("primitives");
        if (primitives == nullptr || primitives->kind != JsonValue::Kind::kArray || primitives->items.empty()) {
            fields_.fail("a mesh has no primitives");
        }
        std::string out;
        for (const JsonValue& primitive : primitives->items) {
            const JsonValue* attributes = primitive.find("attributes");
            if (attributes == nullptr) fields_.fail("a primitive has no attributes");
            const std::int64_t position = fields_.index_of(*attributes, "POSITION", buffers_.accessors().size());
            const GltfAccessor& points = buffers_.accessors()[static_cast<std::size_t>(position)];
            if (points.component != kGltfFloat || points.type != "VEC3")
                fields_.fail("positions are not three floats from a buffer");
            total_entries_ += points.count;
            out += (out.empty() ? "" : ",") + std::string("{\"attributes\":{\"POSITION\":") + std::to_string(position) +
                   "}";
            if (primitive.find("indices") != nullptr) {
                const std::int64_t indices = fields_.index_of(primitive, "indices", buffers_.accessors().size());
                const GltfAccessor& corners = buffers_.accessors()[static_cast<std::size_t>(indices)];
                const bool is_unsigned = corners.component == kGltfUint8 || corners.component == kGltfUint16 ||
                                         corners.component == kGltfUint32;
                if (!is_unsigned || corners.type != "SCALAR" || !corners.is_packed)
                    fields_.fail("indices are not unsigned numbers");
                total_entries_ += corners.count;
                out += ",\"indices\":" + std::to_string(indices);
            }
            const std::int64_t mode = fields_.count_of(primitive, "mode", 4);
            if (mode > 6) fields_.fail("a primitive has an unknown mode");
            out += ",\"mode\":" + std::to_string(mode) + "}";
            // The same accessor may be used by many primitives, and is copied for each.
            if (total_entries_ > 4 * fields_.limits().max_triangles)
                fields_.fail("its meshes are above the limit of triangles");
        }
        ++num_meshes_;
        return "{\"primitives\":[" + out + "]}";
    }

    const JsonValue& document_;
    GltfFields fields_;
    GltfBuffers buffers_;  // refers to the fields, as the nodes do
    GltfNodes nodes_;
    std::int64_t total_entries_ = 0;  // of all primitives: positions and indices
    std::size_t num_meshes_ = 0;
};

}  // namespace

std::string file_name_of(std::string_view uri) {
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        unsigned byte = static_cast<unsigned char>(uri[i]);
        if (uri[i] == '%') {
            const std::string_view digits = uri.substr(i + 1, 2);
            const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
            if (error != std::errc() || end != digits.data() + 2) return "";
            i += 2;
        }
        // Neither control characters nor what ends a string of JSON or begins an escape, separators and drives.
        constexpr std::string_view kForbidden = "\"\\/:";
        if (byte < 0x20 || kForbidden.find(static_cast<char>(byte)) != kForbidden.npos) return "";
        name += static_cast<char>(byte);
    }
    return name;
}

bool is_own_file(const std::filesystem::path& folder, std::string_view name) {
    if (name.empty() || name.size() > 200 || name == ".." || name == "." || name.find_first_of("/\\:") != name.npos)
        return false;
    if (name.find('\0') != name.npos) return false;
    std::error_code error;
    return std::filesystem::is_regular_file(std::filesystem::symlink_status(folder / name, error));
}

std::string checked_gltf(std::string_view json, std::uint64_t binary_chunk_bytes, const std::string& source,
                         const std::filesystem::path& folder, const MeshLimits& limits) {
    const JsonValue document = parse_json_outline(json, source, limits.max_json_depth, limits.max_json_values);
    return GltfChecker(document, binary_chunk_bytes, source, folder, limits).run();
}

}  // namespace nearpose
