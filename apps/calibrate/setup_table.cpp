#include "apps/calibrate/setup_table.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "apps/base/degrees.hpp"
#include "apps/base/number_text.hpp"

namespace nearpose::program {
namespace {

using data_set::format_fixed;

constexpr double kPercent = 100.0, kMillimetres = 1e3, kMilliseconds = 1e3;

// How an unknown is shown.
struct Quantity {
    const char* name;
    const char* unit;
    double factor;  // to that unit
    int decimals;
};

std::array<Quantity, kSetupUnknowns> quantities(double frame_s) {
    return {{{"focal length", "%", kPercent, 3},
             {"principal point, column", "px", 1.0, 2},
             {"principal point, row", "px", 1.0, 2},
             {"depth scale", "%", kPercent, 3},
             {"hand-eye turn about x", "deg", kDegrees, 3},
             {"hand-eye turn about y", "deg", kDegrees, 3},
             {"hand-eye turn about z", "deg", kDegrees, 3},
             {"hand-eye shift along x", "mm", kMillimetres, 2},
             {"hand-eye shift along y", "mm", kMillimetres, 2},
             {"hand-eye shift along z", "mm", kMillimetres, 2},
             {"arm later than image", "ms", kMilliseconds * frame_s, 2}}};
}

std::string to_left(std::string text, std::size_t width) {
    if (text.size() < width) text.append(width - text.size(), ' ');
    return text;
}

std::string to_right(const std::string& text, std::size_t width) {
    return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

const char* words_of(SetupFinding finding) {
    switch (finding) {
        case SetupFinding::kAsGiven:
            return "as given";
        case SetupFinding::kContradicted:
            return "contradicted";
        case SetupFinding::kNotShown:
            return "not shown by this motion";
    }
    return "";
}

bool any_contradicted(const Calibration& calibration, const SetupVector& errors, Eigen::Index first,
                      Eigen::Index count) {
    for (Eigen::Index i = first; i < first + count; ++i) {
        if (finding_of(errors[i], calibration.sigma[i], calibration.prior_sigma[i]) == SetupFinding::kContradicted)
            return true;
    }
    return false;
}

// Parts that are contradicted though they were taken to be as good as usual.
std::string contradicted_beside(const Calibration& calibration) {
    std::string names;
    for (const std::string& part : setup_parts()) {
        const auto& unknown = calibration.unknown;
        if (std::find(unknown.begin(), unknown.end(), part) != unknown.end()) continue;
        if (any_contradicted(calibration, only_of({part}, calibration.estimate), 0, kSetupUnknowns))
            names += (names.empty() ? "" : ", ") + part;
    }
    return names;
}

std::string matrix_rows(const Pose& pose) {
    const Eigen::Matrix3d rotation = pose.rotation_matrix();
    std::string text;
    for (int row = 0; row < 3; ++row) {
        text += "   ";
        for (int column = 0; column < 3; ++column) text += to_right(format_fixed(rotation(row, column), 7), 12);
        text += to_right(format_fixed(kMillimetres * pose.translation[row], 3), 12) + "\n";
    }
    return text + "   " + to_right("0", 12) + to_right("0", 12) + to_right("0", 12) + to_right("1", 12) + "\n";
}

}  // namespace

SetupFinding finding_of(double error, double sigma, double prior_sigma) {
    constexpr double kNothingLearned = 0.8;
    if (is_told_from_zero(error, sigma)) return SetupFinding::kContradicted;
    return sigma > kNothingLearned * prior_sigma ? SetupFinding::kNotShown : SetupFinding::kAsGiven;
}

std::string setup_table(const Calibration& calibration) {
    const SetupVector& errors = calibration.estimate;
    const std::array<Quantity, kSetupUnknowns> shown = quantities(calibration.frame_s);
    std::string text = "given is larger than true by        error    1 sigma     before\n";
    for (Eigen::Index i = 0; i < kSetupUnknowns; ++i) {
        const Quantity& quantity = shown[static_cast<std::size_t>(i)];
        const auto figure = [&](double value) {
            return to_right(format_fixed(quantity.factor * value, quantity.decimals), 11);
        };
        text += to_left(std::string(quantity.name) + " [" + quantity.unit + "]", 30) + figure(errors[i]) +
                figure(calibration.sigma[i]) + figure(calibration.prior_sigma[i]) + "  " +
                words_of(finding_of(errors[i], calibration.sigma[i], calibration.prior_sigma[i])) + "\n";
    }
    return text;
}

std::string advice_of(const Calibration& calibration, const PinholeCamera& given) {
    const SetupVector errors = in_order(calibration.errors, calibration.frame_s);  // of what is at fault
    const auto contradicted = [&](Eigen::Index first, Eigen::Index count) {
        return any_contradicted(calibration, errors, first, count);
    };
    const PinholeCamera right = corrected(given, calibration.errors);
    std::string text;
    if (contradicted(kFocalLengthError, 1))
        text += "- camera: write fx = " + format_fixed(right.fx, 2) + ", fy = " + format_fixed(right.fy, 2) +
                " px instead of " + format_fixed(given.fx, 2) + ", " + format_fixed(given.fy, 2) + "\n";
    if (contradicted(kImageColumns, 2))
        text += "- camera: write cx = " + format_fixed(right.cx, 2) + ", cy = " + format_fixed(right.cy, 2) +
                " px instead of " + format_fixed(given.cx, 2) + ", " + format_fixed(given.cy, 2) + "\n";
    if (contradicted(kDepthScaleError, 1))
        text +=
            "- depth: multiply depth_scale by " + format_fixed(1.0 / (1.0 + calibration.errors.depth_scale), 5) + "\n";
    if (contradicted(kHandEyeTurn, 6))
        text +=
            "- hand-eye calibration: the camera's frame is not where it is given. With this matrix (mm),\n"
            "  the right camera_from_world is matrix * the given one:\n" +
            matrix_rows(calibration.errors.given_from_camera.inverse());
    if (contradicted(kTimeOffset, 1))
        text += "- clocks: take the arm's pose of " +
                format_fixed(kMilliseconds * std::abs(calibration.errors.time_offset_s), 1) + " ms " +
                (calibration.errors.time_offset_s > 0.0 ? "earlier" : "later") + " for each image\n";
    const std::string others = contradicted_beside(calibration);
    if (!others.empty())
        text += "- the recording contradicts " + others + " too, which may not be at fault: add it to --unknown\n";
    return text.empty() ? "nothing to change\n" : "to change:\n" + text;
}

}  // namespace nearpose::program
