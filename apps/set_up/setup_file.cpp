#include "apps/set_up/setup_file.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/base/degrees.hpp"
#include "apps/base/file_io.hpp"
#include "apps/data_set/bop_pose.hpp"
#include "apps/data_set/json_file.hpp"

namespace nearpose::program {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "nearpose set-up";
constexpr int kVersion = 1;
constexpr double kPercent = 100.0, kMillimetres = 1e3, kMilliseconds = 1e3;

Json numbers(const Eigen::Ref<const Eigen::VectorXd>& values) {
    return std::vector<double>(values.begin(), values.end());
}

Json rows_of(const Eigen::Matrix3d& matrix) {
    Json rows = Json::array();
    for (Eigen::Index row = 0; row < 3; ++row)
        for (Eigen::Index column = 0; column < 3; ++column) rows.push_back(matrix(row, column));
    return rows;
}

}  // namespace

void write_setup_file(const std::filesystem::path& path, const Calibration& calibration) {
    const SetupErrors& errors = calibration.errors;
    const SetupVector& sigma = calibration.sigma;
    const Json json = {{"format", kFormat},
                       {"version", kVersion},
                       {"focal_length_percent", kPercent * errors.focal_length},
                       {"principal_point_pixels", numbers(errors.principal_point_pixels)},
                       {"depth_scale_percent", kPercent * errors.depth_scale},
                       {"given_R_camera", rows_of(errors.given_from_camera.rotation_matrix())},
                       {"given_t_camera_mm", numbers(kMillimetres * errors.given_from_camera.translation)},
                       {"time_offset_ms", kMilliseconds * errors.time_offset_s},
                       {"sigma",
                        {{"focal_length_percent", kPercent * sigma[kFocalLengthError]},
                         {"principal_point_pixels", numbers(sigma.segment<2>(kImageColumns))},
                         {"depth_scale_percent", kPercent * sigma[kDepthScaleError]},
                         {"turn_deg", numbers(kDegrees * sigma.segment<3>(kHandEyeTurn))},
                         {"shift_mm", numbers(kMillimetres * sigma.segment<3>(kHandEyeShift))},
                         {"time_offset_ms", kMilliseconds * calibration.frame_s * sigma[kTimeOffset]}}},
                       {"frames", calibration.frames},
                       {"sightings", calibration.sightings},
                       {"unit_sigma", calibration.unit_sigma}};
    data_set::write_file_atomically(path, json.dump(2) + "\n");
}

SetupErrors read_setup_file(const std::filesystem::path& path) {
    const data_set::JsonFile file(path);
    const data_set::JsonValue root = file.root();
    if (!root.is_object() || !root.find("format") || root.at("format").text() != kFormat)
        throw root.error("is no set-up: take a file that `nearpose calibrate --out` wrote");
    if (root.at("version").integer() != kVersion)
        throw root.error("is of version " + std::to_string(root.at("version").integer()) + ", not " +
                         std::to_string(kVersion));
    SetupErrors errors;
    errors.focal_length = root.at("focal_length_percent").number() / kPercent;
    const std::vector<double> point = root.at("principal_point_pixels").numbers(2);
    errors.principal_point_pixels = {point[0], point[1]};
    errors.depth_scale = root.at("depth_scale_percent").number() / kPercent;
    errors.given_from_camera = data_set::read_bop_pose(root, "given_R_camera", "given_t_camera_mm");
    errors.time_offset_s = root.at("time_offset_ms").number() / kMilliseconds;
    if (!(errors.focal_length > -0.9) || !(errors.depth_scale > -0.9))
        throw root.error("has a focal length or depth scale that would be no tenth of what is given");
    return errors;
}

}  // namespace nearpose::program
