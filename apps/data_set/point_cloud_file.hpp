// Point clouds in the camera's frame, metres: .pcd (ascii, binary, binary_compressed), .ply, and text (.xyz, .pts).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace nearpose::data_set {

struct CloudFile {
    int width = 0;   // of an organised cloud [pixels]; of another the number of points
    int height = 0;  // 1 where the cloud is not organised
    // Row-major where organised, and then NaN where nothing was measured; otherwise finite points only. May be empty.
    // The point (0, 0, 0), which many writers use for no measurement, counts as none.
    std::vector<Eigen::Vector3f> points_in_camera;  // [m]

    bool organised() const { return height > 1; }
};

// By the name's ending. Throws std::runtime_error naming the file and the cause; sizes that the header claims are
// compared with the bytes that are there before anything is allocated.
CloudFile read_cloud(const std::filesystem::path& path);

// The clouds of a folder, numbers in names ordered as numbers (2 before 10). None is an error.
std::vector<std::filesystem::path> list_clouds(const std::filesystem::path& folder);

// Order of names with the numbers in them compared as numbers; for equal numbers the shorter name first.
bool numeric_less(const std::string& a, const std::string& b);

}  // namespace nearpose::data_set
