// Which image of a folder belongs to which frame, by the numbers in the names: 7.png, 00007.PNG and frame_000007.tif
// are all frame 7.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearpose::data_set {

// The number that a file's name ends in, its ending left out; nullopt for other names.
std::optional<int> trailing_number(const std::filesystem::path& path);

// The name's ending in small letters: ".png".
std::string lower_extension(const std::filesystem::path& path);

// Depth images by frame. Where several have the same number: the one whose ending stands first in kDepthExtensions,
// then the one with a name of six digits, then the first by name. Empty where there is no such folder.
std::map<int, std::filesystem::path> depth_images_in(const std::filesystem::path& folder);
extern const std::vector<std::string> kDepthExtensions;

// Masks by frame and index, from the last two numbers in the name (000007_000001.png); by frame alone where the name
// has one number (7.png).
struct MaskFiles {
    std::map<std::pair<int, int>, std::filesystem::path> by_index;
    std::map<int, std::filesystem::path> by_frame;
};
MaskFiles masks_in(const std::filesystem::path& folder);

// For messages: "the folder holds 6 files: 00000.tif ... 00005.tif", or that it is empty or not there.
std::string contents_of(const std::filesystem::path& folder);

}  // namespace nearpose::data_set
