#include "apps/estimate/unit_check.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "apps/base/number_text.hpp"

namespace nearpose::program {
namespace {

// In sizes of what is seen.
struct Range {
    double low, high;
    bool holds(double ratio) const { return ratio >= low && ratio <= high; }
};

// A view shows one side of a part, which is 0.6 to 1 of its diameter across; masks err, and parts are cut or hidden.
// Without a mask a part may be a small thing in the view or a part of a large one.
Range possible(const SeenSize& seen) {
    if (!seen.is_segmented) return {0.03, 5.0};
    return {0.6, seen.is_cut ? 30.0 : 6.0};
}
Range likely(const SeenSize& seen) {
    if (!seen.is_segmented) return {0.08, 1.5};
    return {0.8, seen.is_cut ? 10.0 : 3.0};
}

std::string millimetres(double length_m) {
    return data_set::format_fixed(1e3 * length_m, length_m < 0.01 ? 1 : 0) + " mm";
}

const char* word_of(LengthUnit unit) {
    switch (unit) {
        case LengthUnit::kMetre:
            return "metres";
        case LengthUnit::kMillimetre:
            return "millimetres";
        case LengthUnit::kCentimetre:
            return "centimetres";
        case LengthUnit::kInch:
            return "inches";
    }
    return "";
}

}  // namespace

std::optional<SeenSize> seen_size(const Observation& observation) {
    constexpr std::size_t kFewest = 20;
    const std::vector<Eigen::Vector3f>& points = observation.points_in_camera();
    if (points.size() < kFewest) return std::nullopt;
    const auto quantile = [](std::vector<float> values, double share) {
        const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), place, values.end());
        return *place;
    };
    const PinholeCamera& camera = observation.camera();
    Eigen::Vector3f middle;
    std::vector<float> values(points.size());
    for (int axis = 0; axis < 3; ++axis) {
        std::transform(points.begin(), points.end(), values.begin(), [axis](const auto& point) { return point[axis]; });
        middle[axis] = quantile(values, 0.5);
    }
    SeenSize seen;
    seen.is_segmented = observation.segmented();
    if (!seen.is_segmented) {
        seen.size_m = static_cast<double>(middle.z()) * camera.width / camera.fx;
        return seen;
    }
    // A twentieth may lie beside the object, where its mask is too large.
    std::transform(points.begin(), points.end(), values.begin(),
                   [&](const auto& point) { return (point - middle).norm(); });
    seen.size_m = 2.0 * static_cast<double>(quantile(values, 0.95));
    const PixelBox& box = observation.candidate_box();
    seen.is_cut =
        box.first_u <= 1 || box.first_v <= 1 || box.last_u >= camera.width - 1 || box.last_v >= camera.height - 1;
    return seen;
}

std::optional<LengthUnit> fitting_unit(double diameter_m, LengthUnit unit, const SeenSize& seen) {
    if (possible(seen).holds(diameter_m / seen.size_m)) return std::nullopt;
    std::optional<LengthUnit> nearest;
    double nearest_distance = 0.0;
    for (const LengthUnit other :
         {LengthUnit::kMillimetre, LengthUnit::kMetre, LengthUnit::kInch, LengthUnit::kCentimetre}) {
        const double ratio = diameter_m / metres_per(unit) * metres_per(other) / seen.size_m;
        if (other == unit || !likely(seen).holds(ratio)) continue;
        const double distance = std::abs(std::log(ratio / (seen.is_segmented ? 1.2 : 0.3)));
        if (nearest && distance >= nearest_distance) continue;
        nearest = other;
        nearest_distance = distance;
    }
    return nearest;
}

std::optional<std::string> unit_notice(const ModelOptions& model, double diameter_m, const SeenSize& seen) {
    const std::optional<LengthUnit> fitting = fitting_unit(diameter_m, model_unit(model), seen);
    if (!fitting) return std::nullopt;
    return model_file(model).string() + ": the model measures " + millimetres(diameter_m) + ", the " +
           (seen.is_segmented ? "masked region " : "view at its middle ") + millimetres(seen.size_m) +
           ": is the file in " + word_of(*fitting) + "? " +
           (model.models.empty() ? "Say --unit " : "Import it again with --unit ") + to_string(*fitting);
}

std::optional<std::string> UnitCheck::after(const Observation& observation, Verdict verdict, bool is_last) {
    constexpr int kFrames = 5;
    if (is_done_) return std::nullopt;
    ++frames_;
    if (!seen_) seen_ = seen_size(observation);
    is_done_ = verdict == Verdict::kAccept || frames_ == kFrames || is_last;
    if (!is_done_ || verdict == Verdict::kAccept || !seen_) return std::nullopt;
    return unit_notice(model_, diameter_m_, *seen_);
}

}  // namespace nearpose::program
