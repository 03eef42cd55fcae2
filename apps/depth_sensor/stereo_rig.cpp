#include "apps/depth_sensor/stereo_rig.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/check.hpp"

namespace nearpose::simulate {
namespace {

const std::vector<std::pair<std::string, Material>>& materials() {
    static const std::vector<std::pair<std::string, Material>> all = {
        {"cast_iron", {0.3, 0.1, 8.0}}, {"machined_aluminium", {0.4, 0.8, 40.0}}, {"plastic", {0.6, 0.1, 20.0}}};
    return all;
}

}  // namespace

const std::vector<std::string>& material_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> result;
        for (const auto& [name, material] : materials()) result.push_back(name);
        return result;
    }();
    return names;
}

Material material_of(const std::string& name) {
    std::string known;
    for (const auto& [other, material] : materials()) {
        if (other == name) return material;
        known += (known.empty() ? "" : ", ") + other;
    }
    throw std::invalid_argument("'" + name + "' is no material; there are " + known);
}

std::optional<StereoRig> scaled(std::optional<StereoRig> rig, double scale) {
    if (!rig || scale == 0.0) return std::nullopt;
    rig->infrared_sigma_grey *= scale;
    return rig;
}

std::string section_of(const StereoRig& rig) {
    return rig.structured_light ? "structured_light" : "active_stereo";
}

void validate(const StereoRig& rig) {
    const std::string section = section_of(rig) + ".";
    const auto check = [&](const char* field, double value, double low, double high) {
        check_option(section + field, value, low, high);
    };
    check("baseline_m", rig.baseline_m, 1e-3, 1.0);
    check("projector_m", rig.projector_m, -1.0, 1.0);
    check("dots", rig.dots, 0, 1e6);
    check("dot_sigma_tan", rig.dot_sigma_tan, 1e-5, 0.1);
    check("projector_width_tan", rig.projector_width_tan, 0.01, 10.0);
    check("projector_height_tan", rig.projector_height_tan, 0.01, 10.0);
    check("ambient", rig.ambient, 0.0, 100.0);
    check("infrared_sigma_grey", rig.infrared_sigma_grey, 0.0, 255.0);
    check("blur_pixels", rig.blur_pixels, 0.0, 10.0);
    check("rays_per_pixel", rig.rays_per_pixel, 1, 4);
    check("window_pixels", rig.window_pixels, 1, 51);
    if (rig.window_pixels % 2 == 0)
        throw std::invalid_argument(section + "window_pixels is " + std::to_string(rig.window_pixels) +
                                    ", but must be odd: a window has a pixel in its middle");
    if (rig.structured_light && rig.projector_m != rig.baseline_m)
        throw std::invalid_argument(section + "projector_m is " + std::to_string(rig.projector_m) +
                                    ", but must be baseline_m, " + std::to_string(rig.baseline_m) +
                                    ": the pattern is seen from the projector");
    check("penalty_step", rig.penalty_step, 0, 100);
    check("penalty_jump", rig.penalty_jump, rig.penalty_step + 1, 101);
    check("uniqueness_percent", rig.uniqueness_percent, 0, 100);
    check("left_right_pixels", rig.left_right_pixels, 0, 100);
    check("speckle_pixels", rig.speckle_pixels, 0, 1e6);
    check("speckle_range_pixels", rig.speckle_range_pixels, 1, 100);
    check("min_range_m", rig.min_range_m, 0.01, 1e3);
    check("max_range_m", rig.max_range_m, rig.min_range_m, 1e3);
}

}  // namespace nearpose::simulate
