// Reads fields of the objects in a glTF document, and refuses those that are not of the kind they must be.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "raycast/mesh_files/json_outline.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose {

class GltfFields {
  public:
    // `source` names the file in errors; `limits` must live longer.
    GltfFields(std::string source, const MeshLimits& limits) : source_(std::move(source)), limits_(limits) {}

    const MeshLimits& limits() const { return limits_; }
    [[noreturn]] void fail(const std::string& cause) const { throw std::runtime_error(source_ + ": glTF: " + cause); }

    // `,"name":[...]` with what `check` returns for each item of that array in the document; nothing where there is no
    // such array. All items must be objects.
    template <typename Check>
    std::string list(const JsonValue& document, const std::string& name, Check check) const {
        const JsonValue* items = document.find(name);
        if (items == nullptr) return "";
        if (items->kind != JsonValue::Kind::kArray) fail(name + " is not an array");
        std::string out = ",\"" + name + "\":[";
        for (const JsonValue& item : items->items) {
            if (item.kind != JsonValue::Kind::kObject) fail("an entry of " + name + " is not an object");
            if (out.back() != '[') out += ',';
            out += check(item);
        }
        return out + "]";
    }

    // The integer of a field, `otherwise` where it is missing.
    std::int64_t count_of(const JsonValue& object, const std::string& key, std::int64_t otherwise) const;
    // A field that must be there, an index below `size`.
    std::int64_t index_of(const JsonValue& object, const std::string& key, std::size_t size) const;
    // An array of such indices; empty where it is missing.
    std::vector<std::size_t> indices_of(const JsonValue& object, const std::string& key, std::size_t size) const;

  private:
    std::string source_;
    const MeshLimits& limits_;
};

}  // namespace nearpose
