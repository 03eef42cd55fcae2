#include "apps/data_set/camera_json.hpp"

#include <cmath>
#include <stdexcept>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"

namespace nearpose::data_set {
namespace {

// Throws where `key` is there and differs from `value` by more than the rounding of a text file.
void require_equal(const JsonValue& object, const std::string& key, double value) {
    const std::optional<JsonValue> found = object.find(key);
    if (found && std::abs(found->number() - value) > 1e-3) throw found->error("contradicts cam_K");
}

void read_focal_lengths(const JsonValue& root, PinholeCamera& camera) {
    if (const std::optional<JsonValue> matrix = root.find("cam_K")) {
        set_intrinsics(*matrix, camera);
        require_equal(root, "fx", camera.fx);
        require_equal(root, "fy", camera.fy);
        require_equal(root, "cx", camera.cx);
        require_equal(root, "cy", camera.cy);
        return;
    }
    if (!root.find("fx")) throw root.error("has no intrinsics: neither fx, fy, cx, cy nor cam_K");
    camera.fx = root.at("fx").number();
    camera.fy = root.at("fy").number();
    camera.cx = root.at("cx").number();
    camera.cy = root.at("cy").number();
}

}  // namespace

void set_intrinsics(const JsonValue& cam_K, PinholeCamera& camera) {
    const std::vector<double> k = cam_K.numbers(9);
    // Files round, and some are inverted matrices of others.
    const auto differs = [](double value, double wanted) { return std::abs(value - wanted) > 1e-9; };
    // A column-major matrix has its principal point in the last row.
    if (differs(k[6], 0.0) || differs(k[7], 0.0) || differs(k[8], 1.0)) {
        throw cam_K.error("must end in 0, 0, 1: is it column-major?");
    }
    for (const double skew : {k[1], k[3]}) {
        if (std::abs(skew) <= 1e-6 * std::abs(k[0])) continue;
        throw cam_K.error(
            "has a skew of " + format_number(skew) +
            " pixels, which is not supported: rectify the depth images, and give the matrix that is left");
    }
    if (!(k[0] > 0.0) || !(k[4] > 0.0)) throw cam_K.error("has a focal length that is not positive");
    camera.fx = k[0];
    camera.cx = k[2];
    camera.fy = k[4];
    camera.cy = k[5];
}

void refuse_distortion(const JsonValue& camera) {
    for (const char* key : {"distortion", "distortion_coefficients", "dist_coeffs", "coeffs", "cam_dist", "D", "d",
                            "k1", "k2", "k3", "p1", "p2"}) {
        const std::optional<JsonValue> found = camera.find(key);
        if (!found || (!found->is_array() && !found->is_number() && !found->is_string())) continue;
        if (found->is_string() && !parse_number(found->text())) continue;  // the name of a model of lenses
        for (const double coefficient : found->is_array() ? found->numbers() : std::vector{found->number()}) {
            if (coefficient == 0.0) continue;
            throw found->error("the lens has distortion (" + format_number(coefficient) +
                               "), which is not supported: rectify the depth images first");
        }
    }
}

double depth_scale_of(const JsonValue& frame_or_camera) {
    const JsonValue value = frame_or_camera.at("depth_scale");
    const double scale_mm = value.number();
    if (!(scale_mm > 0.0)) throw value.error("must be positive (millimetres per count)");
    return scale_mm;
}

CameraFile read_camera_json(const std::filesystem::path& path) {
    const JsonFile file(path);
    const JsonValue root = file.root();
    CameraFile result;
    read_focal_lengths(root, result.camera);
    result.camera.width = root.at("width").integer();
    result.camera.height = root.at("height").integer();
    refuse_distortion(root);
    if (root.find("depth_scale")) result.depth_scale_mm = depth_scale_of(root);
    try {
        validate(result.camera);
    } catch (const std::invalid_argument& error) {
        throw root.error(error.what());
    }
    return result;
}

void write_camera_json(const std::filesystem::path& path, const PinholeCamera& camera, double depth_scale_mm) {
    validate(camera);
    if (!(depth_scale_mm > 0.0) || !std::isfinite(depth_scale_mm)) {
        throw std::invalid_argument(path.string() + ": depth_scale is " + format_number(depth_scale_mm));
    }
    std::string text = "{\n";
    text += "  \"cx\": " + format_number(camera.cx) + ",\n  \"cy\": " + format_number(camera.cy) + ",\n";
    text += "  \"depth_scale\": " + format_number(depth_scale_mm) + ",\n";
    text += "  \"fx\": " + format_number(camera.fx) + ",\n  \"fy\": " + format_number(camera.fy) + ",\n";
    text +=
        "  \"height\": " + std::to_string(camera.height) + ",\n  \"width\": " + std::to_string(camera.width) + "\n}\n";
    write_file_atomically(path, text);
}

}  // namespace nearpose::data_set
