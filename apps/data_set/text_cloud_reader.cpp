#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/base/number_text.hpp"
#include "apps/base/text_split.hpp"
#include "apps/data_set/cloud_fields.hpp"

namespace nearpose::data_set {
namespace {

// The first three numbers of a line; nullopt where it does not begin with as many.
std::optional<Eigen::Vector3f> point_of(const std::vector<std::string_view>& parts) {
    if (parts.size() < 3) return std::nullopt;
    Eigen::Vector3f point;
    for (int axis = 0; axis < 3; ++axis) {
        const std::optional<double> value = parse_number(parts[static_cast<std::size_t>(axis)]);
        if (!value) return std::nullopt;
        point[axis] = static_cast<float>(*value);
    }
    return point;
}

}  // namespace

CloudFile read_text_cloud(std::string_view bytes, const std::string& file) {
    CloudFile cloud;
    std::string text(bytes);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
    std::size_t number = 0;
    bool first = true;  // nothing but comments before
    for (const std::string_view line : lines(text)) {
        ++number;
        const std::vector<std::string_view> parts = words(line);
        if (parts.empty() || parts[0].front() == '#') continue;
        const std::optional<Eigen::Vector3f> point = point_of(parts);
        const bool heading = first && (parts.size() == 1 || !parse_number(parts[0]));
        first = false;
        if (point) {
            cloud.points_in_camera.push_back(*point);
        } else if (!heading) {
            throw std::runtime_error(file + ": line " + std::to_string(number) + ": must begin with x, y and z");
        }
        if (cloud.points_in_camera.size() > kMaxCloudPoints) throw std::runtime_error(file + ": has too many points");
    }
    cloud.width = static_cast<int>(cloud.points_in_camera.size());
    cloud.height = 1;
    return cloud;
}

}  // namespace nearpose::data_set
