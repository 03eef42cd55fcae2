#include "apps/set_up/setup_errors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace nearpose::program {

SetupVector in_order(const SetupErrors& errors, double frame_s) {
    const Eigen::AngleAxisd turn(errors.given_from_camera.rotation);
    SetupVector vector;
    vector << errors.focal_length, errors.principal_point_pixels, errors.depth_scale, turn.angle() * turn.axis(),
        errors.given_from_camera.translation, errors.time_offset_s / frame_s;
    return vector;
}

SetupErrors errors_of(const SetupVector& vector, double frame_s) {
    const Eigen::Vector3d turn = vector.segment<3>(kHandEyeTurn);
    SetupErrors errors;
    errors.focal_length = vector[kFocalLengthError];
    errors.principal_point_pixels = vector.segment<2>(kImageColumns);
    errors.depth_scale = vector[kDepthScaleError];
    if (turn.norm() > 0.0) errors.given_from_camera.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized());
    errors.given_from_camera.translation = vector.segment<3>(kHandEyeShift);
    errors.time_offset_s = vector[kTimeOffset] * frame_s;
    return errors;
}

const std::vector<std::string>& setup_parts() {
    static const std::vector<std::string> parts = {"focal", "principal-point", "depth-scale", "hand-eye", "time"};
    return parts;
}

namespace {

// First and count of a part's unknowns.
std::pair<Eigen::Index, Eigen::Index> place_of(const std::string& part) {
    constexpr std::array<std::pair<Eigen::Index, Eigen::Index>, 5> kPlaces = {
        {{kFocalLengthError, 1}, {kImageColumns, 2}, {kDepthScaleError, 1}, {kHandEyeTurn, 6}, {kTimeOffset, 1}}};
    const auto found = std::find(setup_parts().begin(), setup_parts().end(), part);
    if (found == setup_parts().end()) throw std::invalid_argument("no part of a set-up is called '" + part + "'");
    return kPlaces[static_cast<std::size_t>(found - setup_parts().begin())];
}

// `values` for the parts, `others` for the rest.
SetupVector mixed(const std::vector<std::string>& parts, const SetupVector& values, SetupVector others) {
    for (const std::string& part : parts) {
        const auto [first, count] = place_of(part);
        others.segment(first, count) = values.segment(first, count);
    }
    return others;
}

}  // namespace

SetupVector prior_with_unknown(const std::vector<std::string>& parts) {
    return mixed(parts, in_order(StillWorldOptions{}.faulty), in_order(StillWorldOptions{}.usual));
}

SetupVector only_of(const std::vector<std::string>& parts, const SetupVector& errors) {
    return mixed(parts, errors, SetupVector::Zero());
}

bool is_told_from_zero(double error, double sigma) {
    constexpr double kSigmas = 3.0;
    return std::abs(error) > kSigmas * sigma;
}

SetupErrors composed(const SetupErrors& first, const SetupErrors& left) {
    SetupErrors both;
    both.focal_length = (1.0 + first.focal_length) * (1.0 + left.focal_length) - 1.0;
    both.principal_point_pixels = first.principal_point_pixels + left.principal_point_pixels;
    both.depth_scale = (1.0 + first.depth_scale) * (1.0 + left.depth_scale) - 1.0;
    both.given_from_camera = first.given_from_camera * left.given_from_camera;
    both.time_offset_s = first.time_offset_s + left.time_offset_s;
    return both;
}

PinholeCamera corrected(PinholeCamera given, const SetupErrors& errors) {
    given.fx /= 1.0 + errors.focal_length;
    given.fy /= 1.0 + errors.focal_length;
    given.cx -= errors.principal_point_pixels.x();
    given.cy -= errors.principal_point_pixels.y();
    return given;
}

Pose corrected(const Pose& given_from_world, const SetupErrors& errors) {
    return errors.given_from_camera.inverse() * given_from_world;
}

}  // namespace nearpose::program
