#include "raycast/mesh_files/gltf_guard.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace nearpose {
namespace {

using Kind = JsonValue::Kind;

class GltfChecker {
  public:
    GltfChecker(const JsonValue& document, std::uint64_t binary_chunk_bytes, std::string source,
                const std::filesystem::path& folder, const MeshLimits& limits)
        : document_(document),
          binary_chunk_bytes_(binary_chunk_bytes),
          source_(std::move(source)),
          folder_(folder),
          limits_(limits) {}

    std::string run() {
        if (document_.kind != Kind::kObject) fail("the document is not an object");
        check_asset();
        std::string out = R"({"asset":{"version":"2.0"})";
        // In this order: what is referred to is checked before what refers to it.
        out += list("buffers", [this](const JsonValue& item) { return buffer(item); });
        out += list("bufferViews", [this](const JsonValue& item) { return view(item); });
        out += list("accessors", [this](const JsonValue& item) { return accessor(item); });
        out += list("meshes", [this](const JsonValue& item) { return mesh(item); });
        out += list("nodes", [this](const JsonValue& item) { return node(item); });
        count_instances();
        out += list("scenes", [this](const JsonValue& item) { return scene(item); });
        if (num_scenes_ == 0) fail("it has no scene");
        const std::int64_t shown = count_of(document_, "scene", 0);
        if (shown >= num_scenes_) fail("its scene does not exist");
        return out + ",\"scene\":" + std::to_string(shown) + "}";
    }

  private:
    struct View {
        std::int64_t bytes = 0;
        std::int64_t stride = 0;  // 0: packed
    };
    struct Accessor {
        std::int64_t count = 0;
        std::int64_t component = 0;  // glTF's code of the type
        std::string_view type;
        bool is_packed = false;
    };

    [[noreturn]] void fail(const std::string& cause) const { throw std::runtime_error(source_ + ": glTF: " + cause); }

    // `,"name":[...]` with what `check` returns for each item, which is an object; nothing where there is none.
    template <typename Check>
    std::string list(const std::string& name, Check check) {
        const JsonValue* items = document_.find(name);
        if (items == nullptr) return "";
        if (items->kind != Kind::kArray) fail(name + " is not an array");
        std::string out = ",\"" + name + "\":[";
        for (const JsonValue& item : items->items) {
            if (item.kind != Kind::kObject) fail("an entry of " + name + " is not an object");
            if (out.back() != '[') out += ',';
            out += check(item);
        }
        return out + "]";
    }

    // The integer of a member, `otherwise` where it is missing.
    std::int64_t count_of(const JsonValue& object, const std::string& key, std::int64_t otherwise) const {
        const JsonValue* value = object.find(key);
        if (value == nullptr) return otherwise;
        const std::optional<std::int64_t> count = value->as_count();
        // Sums of several such numbers stay within 64 bits.
        if (!count || *count > (std::int64_t{1} << 48)) fail(key + " is not a number of 0 or more");
        return *count;
    }
    std::int64_t index_of(const JsonValue& object, const std::string& key, std::size_t size) const {
        const std::int64_t index = count_of(object, key, -1);
        if (index < 0 || static_cast<std::size_t>(index) >= size) fail(key + " is missing or refers to nothing");
        return index;
    }
    std::vector<std::size_t> indices_of(const JsonValue& object, const std::string& key, std::size_t size) const {
        std::vector<std::size_t> indices;
        const JsonValue* values = object.find(key);
        if (values == nullptr) return indices;
        if (values->kind != Kind::kArray) fail(key + " is not an array");
        for (const JsonValue& value : values->items) {
            const std::optional<std::int64_t> index = value.as_count();
            if (!index || static_cast<std::uint64_t>(*index) >= size) fail(key + " refers to nothing");
            indices.push_back(static_cast<std::size_t>(*index));
        }
        return indices;
    }

    void check_asset() const {
        const JsonValue* asset = document_.find("asset");
        const JsonValue* version = asset == nullptr ? nullptr : asset->find("version");
        if (version == nullptr || !version->text.starts_with("2.")) fail("the version is not 2");
        const JsonValue* required = document_.find("extensionsRequired");
        if (required == nullptr) return;
        for (const JsonValue& name : required->items) {
            // How a surface looks does not matter here; every other extension may change where it is.
            if (!name.text.starts_with("KHR_materials") && !name.text.starts_with("KHR_texture")) {
                fail("it needs the extension " + std::string(name.text.substr(0, 60)) +
                     ", which is not supported: export without compression or quantisation");
            }
        }
    }

    std::string buffer(const JsonValue& item) {
        const std::int64_t bytes = count_of(item, "byteLength", 0);
        total_buffer_bytes_ += static_cast<std::uint64_t>(bytes);
        if (bytes == 0 || total_buffer_bytes_ > limits_.max_file_bytes)
            fail("the size of a buffer is 0 or above the limit");
        const JsonValue* uri = item.find("uri");
        std::string out = "{\"byteLength\":" + std::to_string(bytes);
        if (uri == nullptr) {
            const bool is_chunk = buffer_bytes_.empty() && static_cast<std::uint64_t>(bytes) <= binary_chunk_bytes_;
            if (!is_chunk) fail("a buffer has neither a uri nor enough bytes in the file");
        } else {
            check_uri(*uri, bytes);
            out += ",\"uri\":\"" + std::string(uri->text) + "\"";
        }
        buffer_bytes_.push_back(bytes);
        return out + "}";
    }

    void check_uri(const JsonValue& uri, std::int64_t bytes) const {
        if (uri.kind != Kind::kString) fail("the uri of a buffer is not a string");
        if (uri.text.starts_with("data:")) {
            constexpr std::string_view kMarker = ";base64,";
            const std::size_t marker = uri.text.substr(0, 256).find(kMarker);
            if (marker == uri.text.npos) fail("a data uri is not in base64");
            std::string_view data = uri.text.substr(marker + kMarker.size());
            const std::size_t num_letters = data.find_last_not_of('=') + 1;
            const bool is_base64 =
                data.size() % 4 == 0 && data.size() - num_letters <= 2 &&
                data.substr(0, num_letters)
                        .find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/") ==
                    data.npos;
            if (!is_base64) fail("a data uri is not valid base64");
            const std::size_t decoded = num_letters * 3 / 4;
            if (decoded < static_cast<std::uint64_t>(bytes) || decoded > limits_.max_file_bytes) {
                fail("a data uri is shorter than its buffer");
            }
            return;
        }
        const std::string name(uri.text.substr(0, 200));
        if (!is_own_file(folder_, uri.text)) {
            fail("the buffer \"" + name + "\" is not a regular file beside it with a plain name");
        }
        std::error_code error;
        const std::uintmax_t size = std::filesystem::file_size(folder_ / name, error);
        if (error || size < static_cast<std::uint64_t>(bytes) || size > limits_.max_file_bytes) {
            fail("the file \"" + name + "\" is shorter than its buffer, or above the limit");
        }
    }

    std::string view(const JsonValue& item) {
        const std::int64_t buffer = index_of(item, "buffer", buffer_bytes_.size());
        const std::int64_t offset = count_of(item, "byteOffset", 0);
        const std::int64_t bytes = count_of(item, "byteLength", 0);
        const std::int64_t stride = count_of(item, "byteStride", 0);
        if (bytes == 0 || offset + bytes > buffer_bytes_[static_cast<std::size_t>(buffer)]) {
            fail("a buffer view is empty or reaches beyond its buffer");
        }
        if (stride != 0 && (stride < 4 || stride > 252)) fail("the stride of a buffer view is not in 4..252");
        views_.push_back({bytes, stride});
        std::string out = "{\"buffer\":" + std::to_string(buffer) + ",\"byteOffset\":" + std::to_string(offset) +
                          ",\"byteLength\":" + std::to_string(bytes);
        if (stride != 0) out += ",\"byteStride\":" + std::to_string(stride);
        return out + "}";
    }

    std::string accessor(const JsonValue& item) {
        const std::int64_t component = count_of(item, "componentType", 0);
        const JsonValue* type = item.find("type");
        const std::int64_t num_components = type == nullptr ? 0 : components_of(type->text);
        const std::int64_t element = bytes_of(component) * num_components;
        const std::int64_t count = count_of(item, "count", 0);
        if (element == 0 || count == 0) fail("an accessor has no known type or no entries");
        if (count > 3 * limits_.max_triangles) fail("an accessor is above the limit of vertices");
        Accessor accessor{count, component, type->text, true};
        // Accessors without a view or with sparse changes hold nothing of a plain model's shape. They stay in place,
        // since indices count them, but as one number; used for positions, they are refused there.
        if (item.find("bufferView") == nullptr || item.find("sparse") != nullptr) {
            accessors_.push_back({});
            return R"({"componentType":5126,"count":1,"type":"SCALAR"})";
        }
        const std::int64_t view = index_of(item, "bufferView", views_.size());
        const std::int64_t offset = count_of(item, "byteOffset", 0);
        const View& bytes = views_[static_cast<std::size_t>(view)];
        accessor.is_packed = bytes.stride == 0 || bytes.stride == element;
        const std::int64_t stride = bytes.stride == 0 ? element : bytes.stride;
        if (stride < element || offset + (count - 1) * stride + element > bytes.bytes) {
            fail("an accessor reaches beyond its buffer view");
        }
        accessors_.push_back(accessor);
        return "{\"bufferView\":" + std::to_string(view) + ",\"byteOffset\":" + std::to_string(offset) +
               ",\"componentType\":" + std::to_string(component) + ",\"count\":" + std::to_string(count) +
               ",\"type\":\"" + std::string(type->text) + "\"}";
    }

    static std::int64_t components_of(std::string_view type) {
        constexpr std::array<std::pair<std::string_view, int>, 7> kTypes{
            {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
        for (const auto& [name, components] : kTypes) {
            if (name == type) return components;
        }
        return 0;
    }
    static std::int64_t bytes_of(std::int64_t component) {
        switch (component) {
            case 5120:
            case 5121:
                return 1;
            case 5122:
            case 5123:
                return 2;
            case 5125:
            case 5126:
                return 4;
            default:
                return 0;
        }
    }

    std::string mesh(const JsonValue& item) {
        const JsonValue* primitives = item.find("primitives");
        if (primitives == nullptr || primitives->kind != Kind::kArray || primitives->items.empty()) {
            fail("a mesh has no primitives");
        }
        std::string out;
        for (const JsonValue& primitive : primitives->items) {
            const JsonValue* attributes = primitive.find("attributes");
            if (attributes == nullptr) fail("a primitive has no attributes");
            const std::int64_t position = index_of(*attributes, "POSITION", accessors_.size());
            const Accessor& points = accessors_[static_cast<std::size_t>(position)];
            if (points.component != 5126 || points.type != "VEC3") fail("positions are not three floats from a buffer");
            total_entries_ += points.count;
            out += (out.empty() ? "" : ",") + std::string("{\"attributes\":{\"POSITION\":") + std::to_string(position) +
                   "}";
            if (primitive.find("indices") != nullptr) {
                const std::int64_t indices = index_of(primitive, "indices", accessors_.size());
                const Accessor& corners = accessors_[static_cast<std::size_t>(indices)];
                const bool is_unsigned =
                    corners.component == 5121 || corners.component == 5123 || corners.component == 5125;
                if (!is_unsigned || corners.type != "SCALAR" || !corners.is_packed)
                    fail("indices are not unsigned numbers");
                total_entries_ += corners.count;
                out += ",\"indices\":" + std::to_string(indices);
            }
            const std::int64_t mode = count_of(primitive, "mode", 4);
            if (mode > 6) fail("a primitive has an unknown mode");
            out += ",\"mode\":" + std::to_string(mode) + "}";
            // The same accessor may be used by many primitives, and is copied for each.
            if (total_entries_ > 4 * limits_.max_triangles) fail("its meshes are above the limit of triangles");
        }
        ++num_meshes_;
        return "{\"primitives\":[" + out + "]}";
    }

    std::string node(const JsonValue& item) {
        std::string out;
        const JsonValue* all = document_.find("nodes");
        const std::vector<std::size_t> children = indices_of(item, "children", all->items.size());
        for (std::size_t child : children) out += (out.empty() ? "" : ",") + std::to_string(child);
        out = children.empty() ? "{" : "{\"children\":[" + out + "]";
        children_.push_back(children);
        const auto separate = [&out] { return out.back() == '{' ? "" : ","; };
        if (item.find("mesh") != nullptr) {
            out += separate() + std::string("\"mesh\":") + std::to_string(index_of(item, "mesh", num_meshes_));
        }
        constexpr std::array<std::pair<std::string_view, std::size_t>, 4> kPlacements{
            {{"matrix", 16}, {"translation", 3}, {"rotation", 4}, {"scale", 3}}};
        for (const auto& [key, size] : kPlacements) {
            const JsonValue* numbers = item.find(key);
            if (numbers == nullptr) continue;
            bool valid = numbers->kind == Kind::kArray && numbers->items.size() == size;
            for (const JsonValue& number : numbers->items) valid = valid && number.kind == Kind::kNumber;
            if (!valid) fail("the " + std::string(key) + " of a node is not " + std::to_string(size) + " numbers");
            out += separate() + ("\"" + std::string(key) + "\":") + std::string(numbers->text);
        }
        return out + "}";
    }

    // For each node how many nodes stand below it, counted as often as they are placed, itself included. Children
    // first: a node is done once all that it contains are, so that what is left over contains itself.
    void count_instances() {
        std::vector<std::vector<std::size_t>> parents(children_.size());
        std::vector<std::size_t> open(children_.size());
        std::vector<std::size_t> ready;
        for (std::size_t n = 0; n < children_.size(); ++n) {
            for (std::size_t child : children_[n]) parents[child].push_back(n);
            open[n] = children_[n].size();
            if (open[n] == 0) ready.push_back(n);
        }
        std::vector<int> height(children_.size(), 1);
        instances_.assign(children_.size(), 1);
        std::size_t num_done = 0;
        for (; !ready.empty(); ++num_done) {
            const std::size_t n = ready.back();
            ready.pop_back();
            if (instances_[n] > limits_.max_instances) fail("its nodes are placed more often than the limit");
            if (height[n] > limits_.max_node_depth) fail("its nodes are nested deeper than the limit");
            for (std::size_t parent : parents[n]) {
                instances_[parent] += instances_[n];
                height[parent] = std::max(height[parent], height[n] + 1);
                if (instances_[parent] > limits_.max_instances) fail("its nodes are placed more often than the limit");
                if (--open[parent] == 0) ready.push_back(parent);
            }
        }
        if (num_done != children_.size()) fail("a node contains itself");
    }

    std::string scene(const JsonValue& item) {
        std::string out;
        for (std::size_t root : indices_of(item, "nodes", children_.size())) {
            scene_instances_ += instances_[root];
            if (scene_instances_ > limits_.max_instances) fail("its nodes are placed more often than the limit");
            out += (out.empty() ? "" : ",") + std::to_string(root);
        }
        ++num_scenes_;
        return "{\"nodes\":[" + out + "]}";
    }

    const JsonValue& document_;
    std::uint64_t binary_chunk_bytes_;
    std::string source_;
    const std::filesystem::path& folder_;
    const MeshLimits& limits_;

    std::vector<std::int64_t> buffer_bytes_;
    std::uint64_t total_buffer_bytes_ = 0;
    std::vector<View> views_;
    std::vector<Accessor> accessors_;
    std::int64_t total_entries_ = 0;
    std::size_t num_meshes_ = 0;
    std::vector<std::vector<std::size_t>> children_;
    std::vector<std::int64_t> instances_;
    std::int64_t scene_instances_ = 0;
    std::int64_t num_scenes_ = 0;
};

}  // namespace

bool is_own_file(const std::filesystem::path& folder, std::string_view uri) {
    // Neither separators and drives, nor escapes of JSON or of uris, which could spell them.
    if (uri.empty() || uri.size() > 200 || uri == ".." || uri == "." || uri.find_first_of("/\\:%") != uri.npos)
        return false;
    if (uri.find('\0') != uri.npos) return false;
    std::error_code error;
    return std::filesystem::is_regular_file(std::filesystem::symlink_status(folder / uri, error));
}

std::string checked_gltf(std::string_view json, std::uint64_t binary_chunk_bytes, const std::string& source,
                         const std::filesystem::path& folder, const MeshLimits& limits) {
    const JsonValue document = parse_json_outline(json, source, limits.max_json_depth, limits.max_json_values);
    return GltfChecker(document, binary_chunk_bytes, source, folder, limits).run();
}

}  // namespace nearpose
