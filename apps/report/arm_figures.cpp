#include "apps/report/arm_figures.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "apps/base/degrees.hpp"
#include "apps/base/number_text.hpp"
#include "core/base/statistics.hpp"

namespace nearpose::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMillimetres = 1e3;

bool lacks(const LoggedFrame& frame, Requirement requirement) {
    return std::any_of(frame.missing.begin(), frame.missing.end(),
                       [&](const LoggedLack& lack) { return lack.requirement == to_string(requirement); });
}

// The places that count: of the accepted frames, else of those in which the part was seen, else all.
std::vector<PlaceInWorld> counted_places(const std::vector<LoggedFrame>& log) {
    const auto places_where = [&](const std::function<bool(const LoggedFrame&)>& counts) {
        std::vector<PlaceInWorld> places;
        for (const LoggedFrame& frame : log)
            if (frame.in_world && counts(frame)) places.push_back(*frame.in_world);
        return places;
    };
    std::vector<PlaceInWorld> places = places_where([](const auto& f) { return f.verdict == Verdict::kAccept; });
    if (places.empty()) places = places_where([](const auto& f) { return f.status == "estimated"; });
    return places.empty() ? places_where([](const auto&) { return true; }) : places;
}

// The one of some that are spread over the run whose angles to the others have the smallest sum: no few turned poses
// pull it, as they would a mean.
Eigen::Quaterniond middle_rotation(const std::vector<PlaceInWorld>& places) {
    constexpr std::size_t kMost = 300;
    const std::size_t step = (places.size() + kMost - 1) / kMost;
    Eigen::Quaterniond middle = places.front().world_from_object.rotation;
    double least = INFINITY;
    for (std::size_t i = 0; i < places.size(); i += step) {
        const Eigen::Quaterniond& candidate = places[i].world_from_object.rotation;
        double sum = 0.0;
        for (std::size_t k = 0; k < places.size(); k += step)
            sum += angle_between(candidate, places[k].world_from_object.rotation);
        if (sum < least) least = sum, middle = candidate;
    }
    return middle;
}

// In how many frames, and which was the last.
struct Held {
    int frames = 0;
    const LoggedFrame* last = nullptr;
};

Held held(const std::vector<LoggedFrame>& log, const std::function<bool(const LoggedFrame&)>& holds) {
    Held found;
    for (const LoggedFrame& frame : log)
        if (holds(frame)) ++found.frames, found.last = &frame;
    return found;
}

std::string where(const Held& held) {
    return held.frames == 1
               ? "in frame " + std::to_string(held.last->frame_id)
               : "in " + std::to_string(held.frames) + " frames, last in frame " + std::to_string(held.last->frame_id);
}

bool moves_otherwise(const LoggedFrame& frame) {
    return frame.arm && !frame.arm->moves.empty();
}

bool has_cause(const LoggedFrame& frame) {
    return frame.arm && !frame.arm->cause.empty();
}

std::string sentence_of_cause(const Held& cause) {
    const LoggedArm& arm = *cause.last->arm;
    if (arm.cause == to_string(Cause::kObjectMotion)) return "The part itself moves: found " + where(cause) + ".";
    return "The part seems to move with the camera, by an error of the " + arm.cause + ": found " + where(cause) +
           ", where the pose may be off by " + data_set::format_fixed(kMillimetres * arm.error_bound_m, 1) + " mm.";
}

Json xyz_json(const Eigen::Vector3d& vector) {
    return {vector.x(), vector.y(), vector.z()};
}

Json deviation_json(const PlaceDeviation& deviation) {
    return {{"shift_mm", xyz_json(deviation.shift_mm)},
            {"sigma_mm", xyz_json(deviation.sigma_mm)},
            {"turn_deg", xyz_json(deviation.turn_deg)},
            {"sigma_deg", xyz_json(deviation.sigma_deg)}};
}

const char* name_of(ArmEvent event) {
    switch (event) {
        case ArmEvent::kNone:
            return "";
        case ArmEvent::kRepeated:
            return "repeated";
        case ArmEvent::kMotion:
            return "motion";
        case ArmEvent::kCause:
            return "cause";
        case ArmEvent::kContradicted:
            return "contradicted";
    }
    return "";
}

}  // namespace

std::optional<CommonPlace> common_place(const std::vector<LoggedFrame>& log, const Eigen::Vector3d& centre_in_object) {
    const std::vector<PlaceInWorld> places = counted_places(log);
    if (places.empty()) return std::nullopt;
    CommonPlace common{Eigen::Vector3d::Zero(), middle_rotation(places)};
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const PlaceInWorld& place : places) values.push_back((place.world_from_object * centre_in_object)[axis]);
        common.centre_in_world[axis] = median(std::move(values));
    }
    return common;
}

PlaceDeviation deviation_from(const CommonPlace& common, const PlaceInWorld& place,
                              const Eigen::Vector3d& centre_in_object) {
    const Eigen::Matrix3d R = place.world_from_object.rotation_matrix();
    Eigen::Matrix<double, 3, 6> shift;  // a turn about the origin moves the centre
    shift << -R * skew(centre_in_object), R;
    const Eigen::Matrix3d shifts = shift * place.covariance * shift.transpose();
    const Eigen::Matrix3d turns = R * place.covariance.topLeftCorner<3, 3>() * R.transpose();
    const Pose turn{place.world_from_object.rotation * common.world_from_object.conjugate(), Eigen::Vector3d::Zero()};
    return {kMillimetres * (place.world_from_object * centre_in_object - common.centre_in_world),
            kMillimetres * shifts.diagonal().cwiseMax(0.0).cwiseSqrt(), kDegrees * log(turn).head<3>(),
            kDegrees * turns.diagonal().cwiseMax(0.0).cwiseSqrt()};
}

ArmEvent event_of(const LoggedFrame& frame) {
    if (lacks(frame, Requirement::kNewImage)) return ArmEvent::kRepeated;
    if (moves_otherwise(frame)) return ArmEvent::kMotion;
    if (has_cause(frame)) return ArmEvent::kCause;
    if (lacks(frame, Requirement::kStands)) return ArmEvent::kContradicted;
    return ArmEvent::kNone;
}

std::vector<std::string> conclusions(const std::vector<LoggedFrame>& log) {
    std::vector<std::string> sentences;
    if (const Held motion = held(log, moves_otherwise); motion.frames > 0)
        sentences.push_back("The image moves " + motion.last->arm->moves + ": found " + where(motion) +
                            ", where the arm's motion is off by " +
                            data_set::format_fixed(motion.last->arm->off_share, 2) + " of itself.");
    if (const Held cause = held(log, has_cause); cause.frames > 0) sentences.push_back(sentence_of_cause(cause));
    if (const Held repeated = held(log, [](const auto& f) { return lacks(f, Requirement::kNewImage); });
        repeated.frames > 0)
        sentences.push_back("The camera gave the image before once more " + where(repeated) + ".");
    if (const Held contradicted = held(log, [](const auto& f) { return lacks(f, Requirement::kStands); });
        contradicted.frames > 0)
        sentences.push_back(
            "Image and arm contradicted each other: the part was moved, or the set-up is at fault. So " +
            where(contradicted) + ".");
    if (sentences.empty()) sentences.push_back("Nothing contradicts the arm.");
    return sentences;
}

Json arm_json(const std::vector<LoggedFrame>& log, const Eigen::Vector3d& centre_in_object) {
    const std::optional<CommonPlace> common = common_place(log, centre_in_object);
    if (!common) return nullptr;
    Json frames = Json::array(), events = Json::array();
    for (const LoggedFrame& frame : log) {
        frames.push_back(frame.in_world ? deviation_json(deviation_from(*common, *frame.in_world, centre_in_object))
                                        : Json(nullptr));
        events.push_back(name_of(event_of(frame)));
    }
    return {{"conclusions", conclusions(log)},
            {"centre_m", xyz_json(common->centre_in_world)},
            {"frames", frames},
            {"events", events}};
}

}  // namespace nearpose::report
