#include "raycast/symmetry/find_symmetries.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "raycast/symmetry/self_similarity.hpp"
#include "raycast/symmetry/symmetry_axes.hpp"

namespace nearpose {
namespace {

constexpr int kMostFold = 12;
constexpr int kMostElements = 64;      // the largest finite group of turns that is no prism's has 60
constexpr double kLooselyAlike = 0.7;  // share of rays, before the axis is refined
constexpr double kNearlyAlike = 0.88;  // share of rays, after it
constexpr int kScreeningStride = 3;
constexpr double kNoFold_rad[] = {2.0, 0.7, 1.1, 0.27};  // turns that only a surface of revolution has together

class SymmetrySearch {
  public:
    SymmetrySearch(const ViewGenerator& views, double resolution_m)
        : resolution_m_(resolution_m),
          diameter_m_(views.extent().diameter_m()),
          coarse_(look_from_all_around(views, 16, 48)) {}

    Symmetries run();

  private:
    void try_axis(const AxisOfRevolution& axis);
    bool take_revolution(const AxisOfRevolution& axis);
    bool take_near_turns(const AxisOfRevolution& axis, int fold);
    void take_near_revolution(const AxisOfRevolution& axis);
    void add_spindle(const AxisOfRevolution& axis);
    void try_half_turns_across(const AxisOfRevolution& spindle);
    bool take_exact(const Pose& turn);
    void list_elements();
    bool is_listed_near(const Pose& turn) const;
    bool take_near(const Pose& turn);
    double loosely_alike(const Pose& turn) const;
    double nearly_alike(const Pose& turn, int stride, double least_share) const;
    bool stands_out(const Pose& turn) const;
    bool is_exact(const Pose& turn);
    std::optional<AxisOfRevolution> refined_axis(const AxisOfRevolution& axis, double angle_rad) const;
    AxisOfRevolution snapped(const AxisOfRevolution& axis) const;

    double resolution_m_, diameter_m_;
    ViewsAround coarse_;
    std::optional<ViewsAround> fine_;  // made when first needed
    std::vector<Pose> generators_;
    std::vector<AxisOfRevolution> spindles_;  // axes whose perpendiculars may be axes of half turns, in any direction
    Symmetries found_;
};

// The axis of a turn, pointing to the side of `towards`, with its point nearest to `centre`.
AxisOfRevolution axis_of(const Pose& turn, const Eigen::Vector3d& towards, const Eigen::Vector3d& centre) {
    const Eigen::AngleAxisd angle_axis(turn.rotation);
    const double sign = angle_axis.axis().dot(towards) < 0.0 ? -1.0 : 1.0;
    const Eigen::Vector3d axis = sign * angle_axis.axis();
    const double angle = sign * angle_axis.angle();
    // With `centre` for the origin the turn is x -> R x + shift; its fixed points solve (1 - R) x = shift across the
    // axis. A shift along the axis, which no symmetry has, is left out.
    const Eigen::Vector3d shift = turn * centre - centre;
    const Eigen::Vector3d across = shift - axis * axis.dot(shift);
    return {axis, centre + 0.5 * (across + axis.cross(across) / std::tan(0.5 * angle))};
}

double SymmetrySearch::loosely_alike(const Pose& turn) const {
    return likeness(coarse_, turn, resolution_m_ + 0.02 * diameter_m_, kScreeningStride, kLooselyAlike).share();
}

double SymmetrySearch::nearly_alike(const Pose& turn, int stride, double least_share) const {
    return likeness(coarse_, turn, resolution_m_ + 0.005 * diameter_m_, stride, least_share).share();
}

// An axis that a turn by `angle_rad` about lays the surface on itself; nothing where it strays.
std::optional<AxisOfRevolution> SymmetrySearch::refined_axis(const AxisOfRevolution& axis, double angle_rad) const {
    const Pose turn = turn_about(axis, angle_rad);
    const Pose refined = refined_turn(coarse_, turn, resolution_m_);
    if (!is_valid(refined) || !same_turn(turn, refined)) return std::nullopt;
    return snapped(axis_of(refined, axis.axis_in_object, coarse_.views->extent().centre_in_object()));
}

// The nearby axis of the object frame, or through the box centre, where no sensor can tell the two apart: CAD parts are
// drawn so, and products of exact turns are exact.
AxisOfRevolution SymmetrySearch::snapped(const AxisOfRevolution& axis) const {
    AxisOfRevolution result = axis;
    int nearest = 0;
    axis.axis_in_object.cwiseAbs().maxCoeff(&nearest);
    const double sign = axis.axis_in_object[nearest] < 0.0 ? -1.0 : 1.0;
    const Eigen::Vector3d unit = sign * Eigen::Vector3d::Unit(nearest);
    if ((unit - axis.axis_in_object).norm() * diameter_m_ < resolution_m_) result.axis_in_object = unit;
    const Eigen::Vector3d centre = coarse_.views->extent().centre_in_object();
    const Eigen::Vector3d off = result.offset_in_object_m - centre;
    if (off.cross(result.axis_in_object).norm() < 0.5 * resolution_m_) result.offset_in_object_m = centre;
    return result;
}

bool SymmetrySearch::is_exact(const Pose& turn) {
    if (shows_a_difference(coarse_, turn, resolution_m_)) return false;
    if (!fine_) fine_ = look_from_all_around(*coarse_.views, 20, 112);
    return !shows_a_difference(*fine_, turn, resolution_m_);
}

bool SymmetrySearch::take_exact(const Pose& turn) {
    if (contains(found_, turn)) return true;
    if (!is_exact(turn)) return false;
    generators_.push_back(turn);
    list_elements();
    return true;
}

void SymmetrySearch::list_elements() {
    found_.discrete.clear();
    for (const Pose& element : closed_under_products(generators_, kMostElements))
        if (!contains(found_, element)) found_.discrete.push_back(element);
}

// Also true where an exact symmetry, or a near one before an exact one, amounts to it.
bool SymmetrySearch::is_listed_near(const Pose& turn) const {
    const auto equal = [&](const Pose& other) { return contains(found_, other.inverse() * turn); };
    return contains(found_, turn) || std::any_of(found_.near.begin(), found_.near.end(), equal);
}

// Turns by other angles about the same axis are less alike: a tracker that is led astray stays there.
bool SymmetrySearch::stands_out(const Pose& turn) const {
    constexpr int kStride = 2;
    constexpr double kAside_rad = 0.12;
    constexpr double kWorse = 1.4;
    const double differing = 1.0 - nearly_alike(turn, kStride, 0.0);
    const AxisOfRevolution axis = axis_of(turn, Eigen::Vector3d::UnitZ(), coarse_.views->extent().centre_in_object());
    for (const double aside : {-kAside_rad, kAside_rad}) {
        if (1.0 - nearly_alike(turn_about(axis, aside) * turn, kStride, 0.0) < kWorse * differing) return false;
    }
    return true;
}

// False where the turn shows another part.
bool SymmetrySearch::take_near(const Pose& turn) {
    if (is_listed_near(turn)) return true;
    const bool near = nearly_alike(turn, 1, kNearlyAlike) >= kNearlyAlike && stands_out(turn);
    if (near) found_.near.push_back(turn);
    return near;
}

bool SymmetrySearch::take_revolution(const AxisOfRevolution& axis) {
    for (const double angle : kNoFold_rad)
        if (loosely_alike(turn_about(axis, angle)) < kLooselyAlike) return false;
    const auto refined = refined_axis(axis, kNoFold_rad[0]);
    if (!refined) return false;
    for (const double angle : kNoFold_rad)
        if (!is_exact(turn_about(*refined, angle))) return false;
    found_.continuous.push_back(*refined);
    return true;
}

bool SymmetrySearch::take_near_turns(const AxisOfRevolution& axis, int fold) {
    if (!take_near(turn_about(axis, 2.0 * M_PI / fold))) return false;
    for (int k = 2; k < fold; ++k) take_near(turn_about(axis, 2.0 * M_PI * k / fold));
    return true;
}

// A shaft with a keyway looks nearly the same after any turn: some of them stand for all.
void SymmetrySearch::take_near_revolution(const AxisOfRevolution& axis) {
    for (const double angle : kNoFold_rad)
        if (nearly_alike(turn_about(axis, angle), 2, kNearlyAlike) < kNearlyAlike) return;
    for (int k = 1; k < kMostFold; ++k) {
        const Pose turn = turn_about(axis, 2.0 * M_PI * k / kMostFold);
        if (!is_listed_near(turn)) found_.near.push_back(turn);
    }
}

void SymmetrySearch::try_axis(const AxisOfRevolution& axis) {
    if (!found_.continuous.empty() && contains(found_, turn_about(axis, 1.0))) return;
    if (take_revolution(axis)) return add_spindle(axis);
    std::vector<std::pair<AxisOfRevolution, int>> not_exact;
    int exact_fold = 1;
    for (int fold = kMostFold; fold >= 2; --fold) {
        const double angle = 2.0 * M_PI / fold;
        if (exact_fold % fold == 0 || contains(found_, turn_about(axis, angle))) continue;
        if (loosely_alike(turn_about(axis, angle)) < kLooselyAlike) continue;
        const auto refined = refined_axis(axis, angle);
        if (!refined) continue;
        if (take_exact(turn_about(*refined, angle))) {
            exact_fold = std::max(exact_fold, fold);
        } else {
            not_exact.emplace_back(*refined, fold);
        }
    }
    bool any_near = false;
    for (const auto& [near_axis, fold] : not_exact) any_near = take_near_turns(near_axis, fold) || any_near;
    if (!any_near && !not_exact.empty()) take_near_revolution(not_exact.front().first);
    if (exact_fold > 2) add_spindle(axis);
}

void SymmetrySearch::add_spindle(const AxisOfRevolution& axis) {
    const auto same = [&](const AxisOfRevolution& other) {
        return std::abs(other.axis_in_object.dot(axis.axis_in_object)) > 0.999;
    };
    if (std::none_of(spindles_.begin(), spindles_.end(), same)) spindles_.push_back(axis);
}

// Half turns about axes across the spindle: the direction of the best of a scan, and of other local maxima.
void SymmetrySearch::try_half_turns_across(const AxisOfRevolution& spindle) {
    constexpr int kSteps = 60;  // of 3 degrees
    const Eigen::Vector3d first = spindle.axis_in_object.unitOrthogonal();
    const auto axis_at = [&](int step) {
        const Eigen::AngleAxisd turn(M_PI * step / kSteps, spindle.axis_in_object);
        return AxisOfRevolution{turn * first, spindle.offset_in_object_m};
    };
    std::vector<double> alike(kSteps);
    for (int step = 0; step < kSteps; ++step) alike[step] = loosely_alike(turn_about(axis_at(step), M_PI));
    for (int step = 0; step < kSteps; ++step) {
        const double before = alike[(step + kSteps - 1) % kSteps], after = alike[(step + 1) % kSteps];
        if (alike[step] < kLooselyAlike || alike[step] < before || alike[step] <= after) continue;
        if (contains(found_, turn_about(axis_at(step), M_PI))) continue;
        const auto refined = refined_axis(axis_at(step), M_PI);
        if (refined && !take_exact(turn_about(*refined, M_PI))) take_near(turn_about(*refined, M_PI));
    }
}

Symmetries SymmetrySearch::run() {
    if (coarse_.hits == 0) return {};
    const CandidateAxes candidates = candidate_axes(coarse_);
    for (const AxisOfRevolution& axis : candidates.axes) try_axis(axis);
    for (const AxisOfRevolution& spindle : candidates.spindles) add_spindle(spindle);
    for (const AxisOfRevolution& spindle : spindles_) try_half_turns_across(spindle);
    // An axis of revolution that was found late makes some of what was found before it equal.
    const std::vector<Pose> near = std::exchange(found_.near, {});
    list_elements();
    for (const Pose& turn : near)
        if (!is_listed_near(turn)) found_.near.push_back(turn);
    return found_;
}

}  // namespace

Symmetries find_symmetries(const ViewGenerator& views, double resolution_m) {
    if (!(resolution_m > 0.0)) throw std::invalid_argument("symmetries: resolution_m must be positive");
    if (!(views.extent().diameter_m() > 0.0)) return {};
    return SymmetrySearch(views, resolution_m).run();
}

}  // namespace nearpose
