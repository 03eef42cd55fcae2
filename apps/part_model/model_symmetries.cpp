#include "apps/part_model/model_symmetries.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/base/number_text.hpp"
#include "raycast/embree_view_generator.hpp"
#include "raycast/symmetry/find_symmetries.hpp"

namespace nearpose::program {
namespace {

// Turns about one axis.
struct TurnsAboutAxis {
    Eigen::Vector3d axis;            // its largest component is positive
    std::vector<double> angles_rad;  // in (0, 2 pi), ascending
};

Eigen::Vector3d upright(const Eigen::Vector3d& axis) {
    int largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    return axis[largest] < 0.0 ? -axis : axis;
}

std::vector<TurnsAboutAxis> by_axis(const std::vector<Pose>& turns) {
    constexpr double kSameAxis = 0.999;  // cosine
    std::vector<TurnsAboutAxis> result;
    for (const Pose& turn : turns) {
        const Eigen::AngleAxisd angle_axis(turn.rotation);
        const Eigen::Vector3d axis = upright(angle_axis.axis());
        auto known = std::find_if(result.begin(), result.end(), [&](const TurnsAboutAxis& other) {
            return std::abs(other.axis.dot(axis)) > kSameAxis;
        });
        if (known == result.end()) known = result.insert(known, {axis, {}});
        const double sign = known->axis.dot(angle_axis.axis()) < 0.0 ? -1.0 : 1.0;
        const double angle = sign * angle_axis.angle();
        known->angles_rad.push_back(angle < 0.0 ? angle + 2.0 * std::numbers::pi : angle);
    }
    for (TurnsAboutAxis& turns_about : result) std::sort(turns_about.angles_rad.begin(), turns_about.angles_rad.end());
    std::stable_sort(result.begin(), result.end(), [](const TurnsAboutAxis& a, const TurnsAboutAxis& b) {
        return a.angles_rad.size() > b.angles_rad.size();
    });
    return result;
}

std::string axis_name(const Eigen::Vector3d& axis) {
    constexpr double kAligned = 0.99985;  // cosine of a degree
    for (int i = 0; i < 3; ++i)
        if (std::abs(axis[i]) > kAligned) return std::string(1, static_cast<char>('x' + i));
    std::string text;
    for (int i = 0; i < 3; ++i) text += (i == 0 ? "(" : " ") + data_set::format_fixed(axis[i], 2);
    return text + ")";
}

std::string joined(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
    return text;
}

std::string exact_text(const Symmetries& symmetries) {
    constexpr std::size_t kNamed = 3;
    std::vector<std::string> parts, half_turns;
    for (const AxisOfRevolution& axis : symmetries.continuous)
        parts.push_back("any turn about " + axis_name(upright(axis.axis_in_object)));
    for (const TurnsAboutAxis& turns : by_axis(symmetries.discrete)) {
        const std::size_t fold = turns.angles_rad.size() + 1;
        if (fold > 2) {
            parts.push_back(std::to_string(fold) + "-fold about " + axis_name(turns.axis));
        } else {
            half_turns.push_back(axis_name(turns.axis));
        }
    }
    const std::size_t unnamed = half_turns.size() > kNamed ? half_turns.size() - kNamed : 0;
    half_turns.resize(half_turns.size() - unnamed);
    if (!half_turns.empty()) parts.push_back("half turns about " + joined(half_turns));
    if (unnamed > 0) parts.back() += " and " + std::to_string(unnamed) + " more";
    return joined(parts);
}

std::string near_text(const Symmetries& symmetries) {
    std::vector<std::string> parts;
    for (const TurnsAboutAxis& turns : by_axis(symmetries.near_symmetries)) {
        std::vector<std::string> degrees;
        for (const double angle : turns.angles_rad)
            degrees.push_back(data_set::format_fixed(angle * 180.0 / std::numbers::pi, 0));
        parts.push_back(joined(degrees) + " degrees about " + axis_name(turns.axis));
    }
    return joined(parts);
}

}  // namespace

Symmetries find_symmetries(const Mesh& mesh, std::optional<double> resolution_m) {
    constexpr double kResolution_m = 5e-4, kShareOfDiameter = 0.002;
    const EmbreeViewGenerator views(mesh);
    const double usual_m = std::max(kResolution_m, kShareOfDiameter * views.extent().diameter_m());
    return find_symmetries(views, resolution_m.value_or(usual_m));
}

Symmetries declared_symmetries(const data_set::ModelInfo& info) {
    return {info.discrete_symmetries, info.continuous_symmetries, {}};
}

void declare(const Symmetries& symmetries, data_set::ModelInfo& info) {
    info.discrete_symmetries = symmetries.discrete;
    info.continuous_symmetries = symmetries.continuous;
}

const std::vector<std::string>& symmetry_choices() {
    static const std::vector<std::string> choices{"auto", "none", "declared"};
    return choices;
}

std::string describe(const Symmetries& symmetries) {
    const std::string exact = exact_text(symmetries);
    const std::string text = exact.empty() ? "none" : exact;
    return symmetries.near_symmetries.empty() ? text : text + "; nearly the same after " + near_text(symmetries);
}

}  // namespace nearpose::program
