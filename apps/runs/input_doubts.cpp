#include "apps/runs/input_doubts.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

#include "apps/base/number_text.hpp"
#include "core/base/statistics.hpp"

namespace nearpose::program {
namespace {

using data_set::format_fixed;

constexpr double kOffMiddle = 0.1;  // of the image's side; sensors are off by at most half of that
constexpr double kNarrowest_deg = 12.0, kWidest_deg = 140.0;

std::string size_text(double width, double height) {
    return format_fixed(width, 0) + " x " + format_fixed(height, 0);
}

bool near(double value, double wanted, double side) {
    return std::abs(value - wanted) <= kOffMiddle * side;
}

// Why the principal point may lie where it does.
std::string likely_cause(const PinholeCamera& camera) {
    const double middle_u = 0.5 * (camera.width - 1), middle_v = 0.5 * (camera.height - 1);
    const double width = 2.0 * camera.cx + 1.0,
                 height = 2.0 * camera.cy + 1.0;  // of an image that has it in the middle
    const double ratio_u = width / camera.width, ratio_v = height / camera.height;
    if (near(camera.cx, middle_v, camera.height) && near(camera.cy, middle_u, camera.width)) {
        return "cx and cy look exchanged";
    }
    if (width > 0.0 && std::abs(ratio_u - ratio_v) <= kOffMiddle * std::max(ratio_u, ratio_v)) {
        return "they look like those of an image of about " + size_text(width, height) + ": of another resolution?";
    }
    if (near(camera.cx, middle_u, camera.width) || near(camera.cy, middle_v, camera.height)) {
        return "they look like those of an image of about " + size_text(width, height) +
               ": were rows or columns cut off? Then cx and cy must be less by what was cut at the left and the top";
    }
    return "are they of this stream?";
}

std::optional<double> median_of(const std::vector<float>& values) {
    if (values.empty()) return std::nullopt;
    return median(values);
}

bool holds_border(const Mask& mask) {
    const auto at = [&](int u, int v) { return mask.value[static_cast<std::size_t>(v * mask.width + u)] != 0 ? 1 : 0; };
    int held = 0;
    for (int u = 0; u < mask.width; ++u) held += at(u, 0) + at(u, mask.height - 1);
    for (int v = 0; v < mask.height; ++v) held += at(0, v) + at(mask.width - 1, v);
    return held >= 0.98 * 2.0 * (mask.width + mask.height);
}

// The measured pixels of the mask: their box, and their median depth.
struct Masked {
    int first_u = 0, first_v = 0, last_u = -1, last_v = -1;  // both included
    std::optional<double> depth_m;

    bool inside(const PinholeCamera& camera) const {
        return first_u > 0 && first_v > 0 && last_u < camera.width - 1 && last_v < camera.height - 1;
    }
};

Masked measured_in(const DepthImage& depth, const Mask& mask) {
    Masked masked{depth.width, depth.height, -1, -1, {}};
    std::vector<float> depths_m;
    for (std::size_t i = 0; i < depth.depth_m.size(); ++i) {
        if (mask.value[i] == 0 || !(depth.depth_m[i] > 0.0F)) continue;
        const int u = static_cast<int>(i) % depth.width, v = static_cast<int>(i) / depth.width;
        masked = {std::min(masked.first_u, u),
                  std::min(masked.first_v, v),
                  std::max(masked.last_u, u),
                  std::max(masked.last_v, v),
                  {}};
        depths_m.push_back(depth.depth_m[i]);
    }
    masked.depth_m = median_of(depths_m);
    return masked;
}

std::string millimetres(double length_m) {
    return format_fixed(1e3 * length_m, 0) + " mm";
}

constexpr const char* kScaleAdvice =
    ": check depth_scale (millimetres per count; 1000 for floating point metres) and the model's unit";

std::string doubt_of_masked(const Masked& masked, const PinholeCamera& camera, const ModelExtent& extent) {
    const double width_m = (masked.last_u - masked.first_u) / camera.fx * *masked.depth_m;
    const double height_m = (masked.last_v - masked.first_v) / camera.fy * *masked.depth_m;
    const double shown_m = std::hypot(width_m, height_m);
    // No view of a box is smaller than that along its longest side. Half of that may be hidden.
    Eigen::Vector3d sides_m = extent.box_max_in_object - extent.box_min_in_object;
    std::sort(sides_m.begin(), sides_m.end());
    const double smallest_m = 0.5 * std::hypot(sides_m[0], sides_m[1]);
    if (shown_m >= smallest_m && shown_m <= 1.5 * extent.diameter_m()) return {};
    return "by mask and depth the object is " + millimetres(shown_m) + " across, and the model " +
           millimetres(extent.diameter_m()) + kScaleAdvice;
}

// Of the changes of depth between neighbours along one side of the image, by the place of the later pixel.
std::vector<int> changes_along(const DepthImage& depth, bool columns) {
    std::vector<int> changes(static_cast<std::size_t>(columns ? depth.width : depth.height), 0);
    for (int v = columns ? 0 : 1; v < depth.height; ++v) {
        for (int u = columns ? 1 : 0; u < depth.width; ++u) {
            const std::size_t now = static_cast<std::size_t>(v) * depth.width + u;
            const float here = depth.depth_m[now], before = depth.depth_m[columns ? now - 1 : now - depth.width];
            if (here > 0.0F && before > 0.0F && here != before) ++changes[columns ? u : v];
        }
    }
    return changes;
}

// Whether nearly all lie a whole number of `step` apart.
bool all_in_steps(const std::vector<int>& changes, int step) {
    constexpr int kLeast = 500;
    constexpr double kNearlyAll = 0.98;
    std::vector<int> by_place(static_cast<std::size_t>(step), 0);
    for (std::size_t i = 0; i < changes.size(); ++i) by_place[i % by_place.size()] += changes[i];
    const int most = *std::max_element(by_place.begin(), by_place.end());
    const int all = std::accumulate(by_place.begin(), by_place.end(), 0);
    return all >= kLeast && most >= kNearlyAll * all;
}

}  // namespace

std::string camera_doubt(const PinholeCamera& camera) {
    const double degrees = 180.0 / std::numbers::pi;
    const double view_deg = 2.0 * degrees * std::atan(0.5 * camera.width / camera.fx);
    const std::string image = size_text(camera.width, camera.height) + " pixels";
    if (!near(camera.cx, 0.5 * (camera.width - 1), camera.width) ||
        !near(camera.cy, 0.5 * (camera.height - 1), camera.height)) {
        return "the intrinsics may be wrong: cx = " + format_fixed(camera.cx, 1) +
               ", cy = " + format_fixed(camera.cy, 1) + " is far from the middle of images of " + image + "; " +
               likely_cause(camera);
    }
    if (view_deg >= kNarrowest_deg && view_deg <= kWidest_deg) return {};
    return "the intrinsics may be wrong: fx = " + format_fixed(camera.fx, 1) + " gives images of " + image +
           " a field of view of " + format_fixed(view_deg, 0) + " degrees; are they of another resolution?";
}

std::string mask_doubt(const DepthImage& depth, const Mask& mask) {
    if (!holds_border(mask)) return {};
    std::vector<float> covered_m, left_out_m;
    std::size_t left_out = 0;
    for (std::size_t i = 0; i < mask.value.size(); ++i) {
        left_out += mask.value[i] == 0 ? 1 : 0;
        if (depth.depth_m[i] > 0.0F) (mask.value[i] != 0 ? covered_m : left_out_m).push_back(depth.depth_m[i]);
    }
    const double share = static_cast<double>(left_out) / static_cast<double>(mask.value.size());
    const std::optional<double> inner_m = median_of(left_out_m), outer_m = median_of(covered_m);
    constexpr double kLeast = 0.002, kMost = 0.6, kNearer = 0.97;
    if (share < kLeast || share > kMost || !inner_m || (outer_m && *inner_m > kNearer * *outer_m)) return {};
    return "the mask covers everything but " + format_fixed(100.0 * share, 1) +
           " % of the image, which is nearer than the rest: is it inverted?";
}

std::string decimation_doubt(const DepthImage& depth) {
    constexpr int kLargestStep = 8;
    const std::vector<int> along_rows = changes_along(depth, true), along_columns = changes_along(depth, false);
    for (int step = kLargestStep; step > 1; --step) {
        if (!all_in_steps(along_rows, step) || !all_in_steps(along_columns, step)) continue;
        return "depth changes only where blocks of " + size_text(step, step) +
               " pixels meet: turn the sensor's decimation filter off, or give its small images and their "
               "intrinsics";
    }
    return {};
}

std::string scale_doubt(const DepthImage& depth, const Mask* mask, const PinholeCamera& camera,
                        const ModelExtent& extent) {
    if (mask != nullptr) {
        const Masked masked = measured_in(depth, *mask);
        if (masked.depth_m && masked.inside(camera)) return doubt_of_masked(masked, camera, extent);
    }
    std::vector<float> depths_m;
    for (const float depth_m : depth.depth_m)
        if (depth_m > 0.0F) depths_m.push_back(depth_m);
    const std::optional<double> median_m = median_of(depths_m);
    if (!median_m) return {};
    const double shown_m = *median_m * std::max(camera.width / camera.fx, camera.height / camera.fy);
    constexpr double kShareInView = 0.8;
    if (shown_m >= kShareInView * extent.diameter_m()) return {};
    return "the scene is implausibly small: at the median depth of " + millimetres(*median_m) + " the image is " +
           millimetres(shown_m) + " wide, and the part " + millimetres(extent.diameter_m()) + kScaleAdvice;
}

}  // namespace nearpose::program
