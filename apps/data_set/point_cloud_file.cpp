#include "apps/data_set/point_cloud_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/base/text_split.hpp"
#include "apps/data_set/cloud_fields.hpp"
#include "apps/data_set/image_files.hpp"

namespace nearpose::data_set {
namespace {

constexpr std::uintmax_t kMaxCloudBytes = std::uintmax_t{1} << 30;
constexpr std::size_t kMaxHeaderLine = 4096;

bool is_measured(const Eigen::Vector3f& point) {
    return point.allFinite() && !point.isZero(0.0F);
}

bool is_cloud(const std::string& extension) {
    return extension == ".pcd" || extension == ".ply" || extension == ".xyz" || extension == ".pts";
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

// The digits of `text` from `position` on without leading zeros; moves `position` behind them.
std::string_view take_number(const std::string& text, std::size_t& position) {
    while (position < text.size() && text[position] == '0') ++position;
    const std::size_t begin = position;
    while (position < text.size() && is_digit(text[position])) ++position;
    return std::string_view(text).substr(begin, position - begin);
}

}  // namespace

std::string_view header_line(std::string_view bytes, std::size_t& position, const std::string& file) {
    const std::size_t end = bytes.substr(position, kMaxHeaderLine).find('\n');
    if (end == bytes.npos) throw std::runtime_error(file + ": the header does not end");
    std::string_view line = bytes.substr(position, end);
    position += end + 1;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

std::vector<Eigen::Vector3f> read_text_points(std::string_view text, std::uint64_t count, std::size_t words_per_point,
                                              const CoordinateFields& fields, const std::string& file,
                                              bool more_words) {
    // A digit and a separator for each number is the least that a whole file has.
    if (count > text.size() / (2 * words_per_point) + 1) throw std::runtime_error(file + ": cut short: too few points");
    std::vector<Eigen::Vector3f> points;
    points.reserve(count);
    std::size_t position = 0;
    while (points.size() < count) {
        if (position >= text.size()) throw std::runtime_error(file + ": cut short: too few points");
        const std::size_t end = std::min(text.find('\n', position), text.size());
        const std::vector<std::string_view> numbers = words(text.substr(position, end - position));
        position = end + 1;
        if (numbers.empty()) continue;
        const std::string place = file + ": point " + std::to_string(points.size()) + ": ";
        const bool enough = more_words ? numbers.size() >= words_per_point : numbers.size() == words_per_point;
        if (!enough) throw std::runtime_error(place + "has a wrong number of values");
        Eigen::Vector3f point;
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view word =
                numbers[static_cast<std::size_t>(fields[static_cast<std::size_t>(axis)].word)];
            const std::optional<double> value = parse_number(word);
            if (!value) throw std::runtime_error(place + "\"" + std::string(word) + "\" is not a number");
            point[axis] = static_cast<float>(*value);
        }
        points.push_back(point);
    }
    return points;
}

CloudFile read_cloud(const std::filesystem::path& path) {
    const std::string extension = lower_extension(path);
    if (!is_cloud(extension)) throw std::runtime_error(path.string() + ": is no .pcd, .ply, .xyz or .pts file");
    const std::string bytes = read_whole_file(path, kMaxCloudBytes);
    CloudFile cloud = extension == ".pcd"   ? read_pcd(bytes, path.string())
                      : extension == ".ply" ? read_ply_cloud(bytes, path.string())
                                            : read_text_cloud(bytes, path.string());
    std::vector<Eigen::Vector3f>& points = cloud.points_in_camera;
    if (cloud.organised()) {
        constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
        for (Eigen::Vector3f& point : points) {
            if (!is_measured(point)) point.setConstant(kNone);
        }
        return cloud;
    }
    points.erase(std::remove_if(points.begin(), points.end(), [](const auto& point) { return !is_measured(point); }),
                 points.end());
    cloud.width = static_cast<int>(points.size());
    cloud.height = 1;
    return cloud;
}

bool numeric_less(const std::string& a, const std::string& b) {
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < a.size() && j < b.size()) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            const std::string_view x = take_number(a, i);
            const std::string_view y = take_number(b, j);
            if (x.size() != y.size()) return x.size() < y.size();
            if (x != y) return x < y;
        } else {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i;
            ++j;
        }
    }
    if ((i == a.size()) != (j == b.size())) return i == a.size();
    return a.size() != b.size() ? a.size() < b.size() : a < b;
}

std::vector<std::filesystem::path> list_clouds(const std::filesystem::path& folder) {
    if (!std::filesystem::is_directory(folder)) throw std::runtime_error(folder.string() + ": is not a folder");
    std::vector<std::filesystem::path> clouds;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (is_cloud(lower_extension(entry.path()))) clouds.push_back(entry.path());
    }
    if (clouds.empty()) {
        throw std::runtime_error(folder.string() + ": has no .pcd, .ply, .xyz or .pts file; " + contents_of(folder));
    }
    std::sort(clouds.begin(), clouds.end(),
              [](const auto& a, const auto& b) { return numeric_less(a.filename().string(), b.filename().string()); });
    return clouds;
}

}  // namespace nearpose::data_set
