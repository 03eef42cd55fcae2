#include "apps/data_set/image_files.hpp"

#include <algorithm>
#include <cstddef>

#include "apps/base/number_text.hpp"
#include "apps/data_set/point_cloud_file.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDigits = "0123456789";

// The files of a folder in the order of their names. A broken link is a file here: opening it tells.
std::vector<fs::path> files_of(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code not_there;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, not_there)) {
        std::error_code ignored;
        if (!entry.is_directory(ignored)) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
        return numeric_less(a.filename().string(), b.filename().string());
    });
    return files;
}

std::optional<int> frame_number(const std::string& digits) {
    const auto number = parse_integer(digits);
    if (!number || *number > 1'000'000'000) return std::nullopt;
    return static_cast<int>(*number);
}

// The numbers in a name, in order; none where one of them is too large for a frame.
std::vector<int> numbers_in(const std::string& name) {
    std::vector<int> numbers;
    std::size_t end = 0;
    for (std::size_t begin = name.find_first_of(kDigits); begin != name.npos;
         begin = name.find_first_of(kDigits, end)) {
        end = std::min(name.find_first_not_of(kDigits, begin), name.size());
        const std::optional<int> number = frame_number(name.substr(begin, end - begin));
        if (!number) return {};
        numbers.push_back(*number);
    }
    return numbers;
}

// Smaller is preferred, of files with the same number.
std::pair<std::ptrdiff_t, bool> rank_of(const fs::path& file, int number) {
    const auto found = std::find(kDepthExtensions.begin(), kDepthExtensions.end(), lower_extension(file));
    return {found - kDepthExtensions.begin(), file.stem().string() != zero_padded(number)};
}

}  // namespace

const std::vector<std::string> kDepthExtensions = {".png", ".tif", ".tiff", ".npy", ".exr"};

std::string lower_extension(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& letter : extension) letter = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter + 32) : letter;
    return extension;
}

std::optional<int> trailing_number(const fs::path& path) {
    const std::string name = path.stem().string();
    const std::size_t last = name.find_last_not_of(kDigits);
    return frame_number(name.substr(last == std::string::npos ? 0 : last + 1));
}

std::map<int, fs::path> depth_images_in(const fs::path& folder) {
    std::map<int, fs::path> images;
    for (const fs::path& file : files_of(folder)) {
        const auto& known = kDepthExtensions;
        const std::optional<int> number = trailing_number(file);
        if (!number || std::find(known.begin(), known.end(), lower_extension(file)) == known.end()) continue;
        const auto [image, is_new] = images.emplace(*number, file);
        if (!is_new && rank_of(file, *number) < rank_of(image->second, *number)) image->second = file;
    }
    return images;
}

MaskFiles masks_in(const fs::path& folder) {
    MaskFiles masks;
    for (const fs::path& file : files_of(folder)) {
        if (lower_extension(file) != ".png") continue;
        const std::vector<int> numbers = numbers_in(file.stem().string());
        if (numbers.size() == 1) masks.by_frame.emplace(numbers[0], file);
        if (numbers.size() < 2) continue;
        const int frame_id = numbers[numbers.size() - 2], index = numbers.back();
        const auto [mask, is_new] = masks.by_index.emplace(std::pair(frame_id, index), file);
        const std::string usual = zero_padded(frame_id) + "_" + zero_padded(index);
        if (!is_new && file.stem().string() == usual) mask->second = file;
    }
    return masks;
}

std::string contents_of(const fs::path& folder) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) return "there is no folder " + folder.string();
    const std::vector<fs::path> files = files_of(folder);
    if (files.empty()) return "the folder holds no file";
    std::string text =
        "the folder holds " + std::to_string(files.size()) + (files.size() == 1 ? " file: " : " files: ");
    text += files.front().filename().string();
    if (files.size() > 1) text += (files.size() > 2 ? " ... " : ", ") + files.back().filename().string();
    return text;
}

}  // namespace nearpose::data_set
