// Errors over frames as a picture.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace nearpose::pictures {

// One frame; no errors where there is no pose.
struct ErrorPoint {
    int frame_id = 0;
    std::optional<double> translation_mm;
    std::optional<double> rotation_deg;
};

// Two panels above each other with a common frame axis. An axis is logarithmic where its values span a lot. Frames
// without a pose are shaded. Throws std::runtime_error naming the file, std::invalid_argument for no points.
void write_error_plot(const std::filesystem::path& path, const std::string& title,
                      const std::vector<ErrorPoint>& points);

}  // namespace nearpose::pictures
