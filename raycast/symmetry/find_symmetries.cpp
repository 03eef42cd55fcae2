#include "raycast/symmetry/find_symmetries.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "raycast/symmetry/self_similarity.hpp"
#include "raycast/symmetry/symmetry_axes.hpp"

namespace nearpose {
namespace {

constexpr int kMaxElements = 64;  // the largest finite group of turns beside those of prisms has 60 (icosahedron)
// No part of a finite fold has all of these turns: a surface that looks the same after each is one of revolution.
constexpr double kIrregularTurns_rad[] = {2.0, 0.7, 1.1, 0.27};

class SymmetrySearch {
  public:
    SymmetrySearch(const ViewGenerator& views, double resolution_m, const SymmetrySearchOptions& options)
        : options_(options),
          resolution_m_(resolution_m),
          diameter_m_(views.extent().diameter_m()),
          coarse_(look_from_all_around(views, options.views.coarse_directions, options.views.coarse_pixels_across)) {}

    Symmetries run();

  private:
    void try_axis(const AxisOfRevolution& axis);
    bool take_revolution(const AxisOfRevolution& axis);
    bool take_near_turns(const AxisOfRevolution& axis, int fold);
    void take_near_revolution(const AxisOfRevolution& axis);
    void add_dihedral_axis(const AxisOfRevolution& axis);
    void try_half_turns_across(const AxisOfRevolution& dihedral_axis);
    bool take_exact(const Pose& turn);
    void list_elements();
    bool is_listed(const Pose& turn) const;
    bool take_near_symmetry(const Pose& turn);
    double coarse_agreement(const Pose& turn) const;
    double refined_agreement(const Pose& turn, int stride, double least_share) const;
    bool stands_out(const Pose& turn) const;
    bool is_exact(const Pose& turn);
    std::optional<AxisOfRevolution> refined_axis(const AxisOfRevolution& axis, double angle_rad) const;
    AxisOfRevolution snapped(const AxisOfRevolution& axis) const;

    const SymmetrySearchOptions options_;
    const double resolution_m_, diameter_m_;
    ViewsAround coarse_;
    std::optional<ViewsAround> fine_;  // made when first needed
    std::vector<Pose> generators_;
    std::vector<AxisOfRevolution> dihedral_axes_;  // perpendiculars of any direction may be axes of half turns
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

double SymmetrySearch::coarse_agreement(const Pose& turn) const {
    const SelfAgreementOptions& options = options_.agreement;
    const double tolerance_m = resolution_m_ + options.coarse_tolerance_diameters * diameter_m_;
    return self_agreement(coarse_, turn, tolerance_m, options.coarse_stride, options.min_coarse_agreement).share();
}

double SymmetrySearch::refined_agreement(const Pose& turn, int stride, double least_share) const {
    const double tolerance_m = resolution_m_ + options_.agreement.near_tolerance_diameters * diameter_m_;
    return self_agreement(coarse_, turn, tolerance_m, stride, least_share).share();
}

// The axis moved so that a turn by `angle_rad` about it aligns the surface with itself; nothing where the alignment
// ends in another turn.
std::optional<AxisOfRevolution> SymmetrySearch::refined_axis(const AxisOfRevolution& axis, double angle_rad) const {
    const Pose turn = turn_about(axis, angle_rad);
    const Pose refined = refined_turn(coarse_, turn, resolution_m_, options_.refinement);
    if (!is_valid(refined) || !same_turn(turn, refined)) return std::nullopt;
    return snapped(axis_of(refined, axis.axis_in_object, coarse_.views->extent().centre_in_object()));
}

// The axis made parallel to one of the object frame, and made to pass through the centre of the box, where that moves
// the surface by less than the sensor can tell: CAD parts are drawn so, and products of exact turns are exact.
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
    if (shows_a_difference(coarse_, turn, resolution_m_, options_.difference)) return false;
    if (!fine_) {
        const SurroundingViewOptions& options = options_.views;
        fine_ = look_from_all_around(*coarse_.views, options.fine_directions, options.fine_pixels_across);
    }
    return !shows_a_difference(*fine_, turn, resolution_m_, options_.difference);
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
    for (const Pose& element : closed_under_products(generators_, kMaxElements))
        if (!contains(found_, element)) found_.discrete.push_back(element);
}

// Whether it is an exact symmetry, or equal to a near-symmetry that is listed, also followed by an exact symmetry.
bool SymmetrySearch::is_listed(const Pose& turn) const {
    const auto equal = [&](const Pose& other) { return contains(found_, other.inverse() * turn); };
    return contains(found_, turn) || std::any_of(found_.near_symmetries.begin(), found_.near_symmetries.end(), equal);
}

// Whether turns a little farther or less far about the same axis agree less. Only then would tracking that went wrong
// settle at this turn.
bool SymmetrySearch::stands_out(const Pose& turn) const {
    const SelfAgreementOptions& options = options_.agreement;
    const double differing = 1.0 - refined_agreement(turn, options.near_stride, 0.0);
    const AxisOfRevolution axis = axis_of(turn, Eigen::Vector3d::UnitZ(), coarse_.views->extent().centre_in_object());
    for (const double aside_rad : {-options.aside_rad, options.aside_rad}) {
        const Pose other = turn_about(axis, aside_rad) * turn;
        if (1.0 - refined_agreement(other, options.near_stride, 0.0) < options.min_contrast * differing) return false;
    }
    return true;
}

// Lists the turn if it is a near-symmetry. False where the part looks too different after it.
bool SymmetrySearch::take_near_symmetry(const Pose& turn) {
    if (is_listed(turn)) return true;
    const double least = options_.agreement.min_near_agreement;
    const bool is_near = refined_agreement(turn, 1, least) >= least && stands_out(turn);
    if (is_near) found_.near_symmetries.push_back(turn);
    return is_near;
}

bool SymmetrySearch::take_revolution(const AxisOfRevolution& axis) {
    for (const double angle : kIrregularTurns_rad)
        if (coarse_agreement(turn_about(axis, angle)) < options_.agreement.min_coarse_agreement) return false;
    const auto refined = refined_axis(axis, kIrregularTurns_rad[0]);
    if (!refined) return false;
    for (const double angle : kIrregularTurns_rad)
        if (!is_exact(turn_about(*refined, angle))) return false;
    found_.continuous.push_back(*refined);
    return true;
}

bool SymmetrySearch::take_near_turns(const AxisOfRevolution& axis, int fold) {
    if (!take_near_symmetry(turn_about(axis, 2.0 * M_PI / fold))) return false;
    for (int k = 2; k < fold; ++k) take_near_symmetry(turn_about(axis, 2.0 * M_PI * k / fold));
    return true;
}

// A shaft with a keyway looks nearly the same after any turn: some of them stand for all.
void SymmetrySearch::take_near_revolution(const AxisOfRevolution& axis) {
    const SelfAgreementOptions& options = options_.agreement;
    const double least = options.min_near_agreement;
    for (const double angle : kIrregularTurns_rad)
        if (refined_agreement(turn_about(axis, angle), options.near_stride, least) < least) return;
    for (int k = 1; k < options_.max_fold; ++k) {
        const Pose turn = turn_about(axis, 2.0 * M_PI * k / options_.max_fold);
        if (!is_listed(turn)) found_.near_symmetries.push_back(turn);
    }
}

void SymmetrySearch::try_axis(const AxisOfRevolution& axis) {
    if (!found_.continuous.empty() && contains(found_, turn_about(axis, 1.0))) return;
    if (take_revolution(axis)) return add_dihedral_axis(axis);
    std::vector<std::pair<AxisOfRevolution, int>> not_exact;
    int exact_fold = 1;
    for (int fold = options_.max_fold; fold >= 2; --fold) {
        const double angle = 2.0 * M_PI / fold;
        if (exact_fold % fold == 0 || contains(found_, turn_about(axis, angle))) continue;
        if (coarse_agreement(turn_about(axis, angle)) < options_.agreement.min_coarse_agreement) continue;
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
    if (exact_fold > 2) add_dihedral_axis(axis);
}

void SymmetrySearch::add_dihedral_axis(const AxisOfRevolution& axis) {
    const auto same = [&](const AxisOfRevolution& other) {
        return std::abs(other.axis_in_object.dot(axis.axis_in_object)) > 0.999;
    };
    if (std::none_of(dihedral_axes_.begin(), dihedral_axes_.end(), same)) dihedral_axes_.push_back(axis);
}

// Half turns about axes that cross the dihedral axis at right angles: where a scan of their directions has a local
// maximum of the self-agreement.
void SymmetrySearch::try_half_turns_across(const AxisOfRevolution& dihedral_axis) {
    const int steps = options_.half_turn_steps;
    const double least = options_.agreement.min_coarse_agreement;
    const Eigen::Vector3d first = dihedral_axis.axis_in_object.unitOrthogonal();
    const auto axis_at = [&](int step) {
        const Eigen::AngleAxisd turn(M_PI * step / steps, dihedral_axis.axis_in_object);
        return AxisOfRevolution{turn * first, dihedral_axis.offset_in_object_m};
    };
    std::vector<double> agreement(steps);
    for (int step = 0; step < steps; ++step) agreement[step] = coarse_agreement(turn_about(axis_at(step), M_PI));
    for (int step = 0; step < steps; ++step) {
        const double before = agreement[(step + steps - 1) % steps], after = agreement[(step + 1) % steps];
        if (agreement[step] < least || agreement[step] < before || agreement[step] <= after) continue;
        if (contains(found_, turn_about(axis_at(step), M_PI))) continue;
        const auto refined = refined_axis(axis_at(step), M_PI);
        if (refined && !take_exact(turn_about(*refined, M_PI))) take_near_symmetry(turn_about(*refined, M_PI));
    }
}

Symmetries SymmetrySearch::run() {
    if (coarse_.hits == 0) return {};
    const CandidateAxes candidates = candidate_axes(coarse_, options_.axes);
    for (const AxisOfRevolution& axis : candidates.axes) try_axis(axis);
    for (const AxisOfRevolution& axis : candidates.dihedral_axes) add_dihedral_axis(axis);
    for (const AxisOfRevolution& axis : dihedral_axes_) try_half_turns_across(axis);
    // Turns that were found before an axis of revolution may be equal but for a turn about it: one of them is kept.
    const std::vector<Pose> near = std::exchange(found_.near_symmetries, {});
    list_elements();
    for (const Pose& turn : near)
        if (!is_listed(turn)) found_.near_symmetries.push_back(turn);
    return found_;
}

void require(bool holds, const char* field_and_range) {
    if (!holds) throw std::invalid_argument(std::string("symmetries: ") + field_and_range);
}

}  // namespace

void validate(const SymmetrySearchOptions& options) {
    const SurroundingViewOptions& views = options.views;
    require(views.coarse_directions > 0 && views.fine_directions > 0, "directions must be at least 1");
    require(views.coarse_pixels_across > 1 && views.fine_pixels_across > 1, "pixels_across must be at least 2");
    require(options.agreement.coarse_stride > 0 && options.agreement.near_stride > 0, "stride must be at least 1");
    require(options.axes.max_faces >= 0, "max_faces must not be negative");
    require(options.refinement.steps >= 0, "refinement.steps must not be negative");
    require(options.difference.detail_rays > 0, "detail_rays must be at least 1");
    require(options.max_fold >= 2, "max_fold must be at least 2");
    require(options.half_turn_steps >= 3, "half_turn_steps must be at least 3");
}

Symmetries find_symmetries(const ViewGenerator& views, double resolution_m, const SymmetrySearchOptions& options) {
    validate(options);
    if (!(resolution_m > 0.0)) throw std::invalid_argument("symmetries: resolution_m must be positive");
    if (!(views.extent().diameter_m() > 0.0)) return {};
    return SymmetrySearch(views, resolution_m, options).run();
}

}  // namespace nearpose
