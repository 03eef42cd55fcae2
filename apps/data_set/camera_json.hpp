// BOP's camera.json: cx cy fx fy width height depth_scale.
#pragma once

#include <filesystem>
#include <optional>

#include "apps/data_set/json_file.hpp"
#include "core/base/camera.hpp"

namespace nearpose::data_set {

struct CameraFile {
    PinholeCamera camera;
    std::optional<double> depth_scale_mm;  // millimetres per count of a depth image; not every use of a camera needs it
};

// Takes fx, fy, cx, cy or a row-major cam_K of 9 numbers; both must agree where both are there. Throws
// std::runtime_error naming file and key where one is missing or out of range, or where the lens has distortion
// coefficients other than 0.
CameraFile read_camera_json(const std::filesystem::path& path);
void write_camera_json(const std::filesystem::path& path, const PinholeCamera& camera, double depth_scale_mm);

// Sets the focal lengths and principal point from a 3x3 row-major matrix (BOP's cam_K), leaves width and height alone.
void set_intrinsics(const JsonValue& cam_K, PinholeCamera& camera);
// Throws where the object has a known key for lens distortion with a value other than 0.
void refuse_distortion(const JsonValue& camera);
// The positive number under "depth_scale" [mm per count].
double depth_scale_of(const JsonValue& frame_or_camera);

}  // namespace nearpose::data_set
