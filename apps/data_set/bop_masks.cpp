#include "apps/data_set/bop_masks.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "apps/data_set/png_file.hpp"

namespace nearpose::data_set {
namespace {

// Nobody makes masks at more than this, and a file may claim any size.
constexpr int kLargestRatio = 8;

bool is_whole_ratio(ImageSize large, ImageSize small) {
    const int ratio = large.width / small.width;
    return ratio <= kLargestRatio && large.width == ratio * small.width && large.height == ratio * small.height;
}

// One size is a whole multiple of the other. A coarser pixel takes the value at the middle of those that it covers.
Mask scaled(const Mask& mask, ImageSize size) {
    const bool down = mask.width > size.width;
    const int ratio = down ? mask.width / size.width : size.width / mask.width;
    const auto source = [&](int at) { return down ? at * ratio + ratio / 2 : at / ratio; };
    Mask result{size.width, size.height, {}};
    for (int v = 0; v < size.height; ++v) {
        for (int u = 0; u < size.width; ++u) {
            result.value.push_back(mask.value[static_cast<std::size_t>(source(v) * mask.width + source(u))]);
        }
    }
    return result;
}

}  // namespace

MaskSource::MaskSource(const BopScene& scene, int object_id, std::optional<int> mask_index)
    : folder_(scene.folder),
      object_id_(object_id),
      available_(std::filesystem::is_directory(scene.folder / "mask_visib")),
      files_(masks_in(scene.folder / "mask_visib")),
      fixed_index_(mask_index) {
    if (fixed_index_ && available_) {
        const auto has_index = [&](const auto& file) { return file.first.second == *mask_index; };
        if (std::any_of(files_.by_index.begin(), files_.by_index.end(), has_index)) return;
        throw std::runtime_error(mask_path(folder_, scene.frames.front().id, *mask_index).string() +
                                 ": no mask has the index of --mask-index; " + contents_of(folder_ / "mask_visib"));
    }
    if (!available_) return;
    const std::filesystem::path truth = folder_ / "scene_gt.json";
    if (!std::filesystem::exists(truth)) {
        fixed_index_ = 0;
        return;
    }
    const JsonFile file(truth);
    for (const auto& [frame_id, objects] : file.root().numbered_members()) {
        int index = 0;
        for (const JsonValue& object : objects.elements()) {
            // Of several instances the first, which emplace keeps.
            if (object.at("obj_id").integer() == object_id) index_of_frame_.emplace(frame_id, index);
            ++index;
        }
    }
}

int MaskSource::mask_index_of(int frame_id) const {
    if (fixed_index_) return *fixed_index_;
    const auto found = index_of_frame_.find(frame_id);
    if (found == index_of_frame_.end()) {
        throw std::runtime_error((folder_ / "scene_gt.json").string() + ": " + std::to_string(frame_id) + ": object " +
                                 std::to_string(object_id_) +
                                 " is not listed, so its mask has no number: give --mask-index or --no-mask");
    }
    return found->second;
}

std::optional<std::filesystem::path> MaskSource::file_of(int frame_id) const {
    if (files_.by_index.empty()) {
        // A name without an index is the one object's, which scene_gt.json need not list.
        const auto named = files_.by_frame.find(frame_id);
        return named == files_.by_frame.end() ? std::nullopt : std::optional(named->second);
    }
    const auto found = files_.by_index.find({frame_id, mask_index_of(frame_id)});
    return found == files_.by_index.end() ? std::nullopt : std::optional(found->second);
}

FrameMask MaskSource::load(const Frame& frame) const {
    if (!available_) return {};
    const std::optional<std::filesystem::path> file = file_of(frame.id);
    if (!file) {
        const int index = files_.by_index.empty() ? 0 : mask_index_of(frame.id);
        return {std::nullopt, mask_path(folder_, frame.id, index).string() +
                                  ": there is no such mask, and the frame is estimated without one; " +
                                  contents_of(folder_ / "mask_visib")};
    }
    const ImageSize size = read_png_size(*file), wanted{frame.camera.width, frame.camera.height};
    if (size == wanted) return {read_mask_png(*file, wanted.width, wanted.height), {}};
    const std::string sizes = file->string() + ": has " + std::to_string(size.width) + " x " +
                              std::to_string(size.height) + " pixels, the depth image " + std::to_string(wanted.width) +
                              " x " + std::to_string(wanted.height);
    if (!is_whole_ratio(size, wanted) && !is_whole_ratio(wanted, size)) {
        throw std::runtime_error(sizes + ", which is no whole ratio: mask and depth must show the same");
    }
    return {scaled(read_mask_png(*file, size.width, size.height), wanted), sizes + "; the mask is scaled"};
}

}  // namespace nearpose::data_set
