#include "raycast/mesh_files/gltf_nodes.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace nearpose {

std::string GltfNodes::node(const JsonValue& item, std::size_t num_meshes) {
    std::string out;
    const std::vector<std::size_t> children = fields_.indices_of(item, "children", count_);
    for (std::size_t child : children) out += (out.empty() ? "" : ",") + std::to_string(child);
    out = children.empty() ? "{" : "{\"children\":[" + out + "]";
    children_.push_back(children);
    const auto separate = [&out] { return out.back() == '{' ? "" : ","; };
    if (item.find("mesh") != nullptr) {
        out += separate() + std::string("\"mesh\":") + std::to_string(fields_.index_of(item, "mesh", num_meshes));
    }
    constexpr std::array<std::pair<std::string_view, std::size_t>, 4> kPlacements{
        {{"matrix", 16}, {"translation", 3}, {"rotation", 4}, {"scale", 3}}};
    for (const auto& [key, size] : kPlacements) {
        const JsonValue* numbers = item.find(key);
        if (numbers == nullptr) continue;
        bool valid = numbers->kind == JsonValue::Kind::kArray && numbers->items.size() == size;
        for (const JsonValue& number : numbers->items) valid = valid && number.kind == JsonValue::Kind::kNumber;
        if (!valid) fields_.fail("the " + std::string(key) + " of a node is not " + std::to_string(size) + " numbers");
        out += separate() + ("\"" + std::string(key) + "\":") + std::string(numbers->text);
    }
    return out + "}";
}

// For each node how many nodes stand below it, counted as often as they are placed, itself included. Children
// first: a node is done once all that it contains are, so that what is left over contains itself.
void GltfNodes::count_instances() {
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
        if (instances_[n] > fields_.limits().max_instances)
            fields_.fail("its nodes are placed more often than the limit");
        if (height[n] > fields_.limits().max_node_depth) fields_.fail("its nodes are nested deeper than the limit");
        for (std::size_t parent : parents[n]) {
            instances_[parent] += instances_[n];
            height[parent] = std::max(height[parent], height[n] + 1);
            if (instances_[parent] > fields_.limits().max_instances)
                fields_.fail("its nodes are placed more often than the limit");
            if (--open[parent] == 0) ready.push_back(parent);
        }
    }
    if (num_done != children_.size()) fields_.fail("a node contains itself");
}

std::string GltfNodes::scene(const JsonValue& item) {
    std::string out;
    for (std::size_t root : fields_.indices_of(item, "nodes", children_.size())) {
        scene_instances_ += instances_[root];
        if (scene_instances_ > fields_.limits().max_instances)
            fields_.fail("its nodes are placed more often than the limit");
        out += (out.empty() ? "" : ",") + std::to_string(root);
    }
    ++num_scenes_;
    return "{\"nodes\":[" + out + "]}";
}

}  // namespace nearpose
