#include "core/update/choose.hpp"

#include <algorithm>
#include <utility>

#include "core/update/hypotheses.hpp"
#include "core/update/pose_evidence.hpp"
#include "core/update/ray_grids.hpp"
#include "core/update/refine.hpp"

namespace nearpose {
namespace {

bool less_likely(const Mode& a, const Mode& b) {
    return a.log_posterior() < b.log_posterior();
}

int stride_of(const Situation& situation, const Frame& frame) {
    return ray_grid(frame, situation.window.around, situation.plan.refinement.max_rays).stride;
}

// Gives the modes what the frames before said of them.
void set_priors(std::vector<Mode>& modes, const Belief& belief, const Frame& frame) {
    if (!belief.tracked) return;
    const ChoiceOptions& options = frame.method().choice;
    const double kept = frame.now_from_before ? options.log_odds_kept : options.log_odds_kept_unmeasured;
    nearpose::set_priors(modes, belief.alternatives, belief.tracked->camera_from_object, kept, frame.model);
}

// The likeliest of the modes that show something of the object; but the incumbent, the tracked one, where the likeliest
// does not overturn it.
Mode likeliest(const std::vector<Mode>& modes, const Mode* incumbent, int stride, const Belief& belief,
               const Frame& frame) {
    const double min_support = frame.method().choice.min_support;
    const Mode& best = *std::max_element(modes.begin(), modes.end(), [&](const Mode& a, const Mode& b) {
        const bool a_seen = !(a.support < min_support), b_seen = !(b.support < min_support);
        return a_seen == b_seen ? less_likely(a, b) : b_seen;
    });
    if (!incumbent ||
        overturns(best.log_posterior(), incumbent->log_posterior(), stride, belief.lock, frame.method().choice))
        return best;
    return *incumbent;
}

// Where nothing is segmented a search compares modes all over the image with few rays on each. The chosen one and those
// around it are told apart by as many rays on the object alone.
void disambiguate(Choice& choice, const Belief& belief, Situation situation, const Frame& frame, Ledger& ledger) {
    const Mode chosen = choice.mode;
    const Eigen::Vector3d centre = frame.model.centre_in_object();
    const double around_m = 0.5 * frame.model.diameter_m();
    const bool is_tracked = belief.tracked && !choice.replaces_tracked;
    std::vector<Mode> near = {chosen}, far;
    for (const Mode& mode : near_symmetric_modes(chosen, frame.model.symmetries)) near.push_back(mode);
    const std::size_t most =
        near.size() + static_cast<std::size_t>(share_of(situation.plan, frame.method().preselection.disambiguated));
    for (const Mode& mode : choice.modes) {
        const double away_m = (mode.camera_from_object * centre - chosen.camera_from_object * centre).norm();
        (away_m < around_m && near.size() < most ? near : far).push_back(mode);
    }
    situation.window.around = chosen.camera_from_object;
    if (frame.method().hypotheses.alternatives > 0)
        for (const Mode& mode : best_alternatives({chosen}, situation, frame, ledger)) near.push_back(mode);
    move_to_nearest_equivalents(near, frame.model);
    const int count = ledger.affordable(Stage::kModes, static_cast<int>(near.size()), 1);
    choice.alternatives_compared &= count == static_cast<int>(near.size());
    near.resize(count);
    near = refine(near, situation, frame, ledger);
    set_priors(near, belief, frame);
    const double shift = near.front().log_evidence - chosen.log_evidence;
    choice.mode = likeliest(near, is_tracked ? &near.front() : nullptr, stride_of(situation, frame), belief, frame);
    for (Mode& mode : far) {  // has lost by as much as before
        mode.log_evidence += shift;
        near.push_back(mode);
    }
    choice.modes = frame.model.distinct(near, static_cast<int>(near.size()));
    std::stable_sort(choice.modes.begin(), choice.modes.end(),
                     [](const Mode& a, const Mode& b) { return less_likely(b, a); });
}

// Where little is in view, refinement may slide off what was accepted.
void keep_prediction(Mode& tracked, const Belief& belief, const Situation& situation, const Frame& frame,
                     Ledger& ledger) {
    if (!(belief.lock.accepted_evidence > 0.0) || situation.searching()) return;
    const RefinedMode prediction =
        situation.prediction ? *situation.prediction
                             : evaluate_prediction(belief.tracked->camera_from_object, situation, frame, ledger);
    if (prediction.log_evidence > tracked.log_evidence) tracked = mode_of(prediction);
}

bool is_another(const Mode& mode, const Belief& belief, const Mode& tracked, const ObjectModel& model) {
    return belief.tracked && !model.same_mode(mode.camera_from_object, tracked.camera_from_object);
}

}  // namespace

Choice choose_map(const MovedParticles& moved, const Frame& frame) {
    const int best = map_index(moved.particles.negative_log_weights);
    Choice choice;
    choice.seen = true;
    choice.mode = mode_at(moved.particles.poses[best], moved.costs[best]);
    const double sigma_m = frame.observation.sensor().sigma_m(frame.observation.mean_distance_m());
    choice.score = frame.method().cost == Cost::kPixels ? std::clamp(1.0 - choice.mode.cost, 0.0, 1.0)
                                                        : 1.0 / (1.0 + choice.mode.cost / (sigma_m * sigma_m));
    return choice;
}

bool overturns(double challenger_log_posterior, double tracked_log_posterior, int stride, const Lock& lock,
               const ChoiceOptions& options) {
    const double margin = std::max(options.challenge_nats, lock.accepted_evidence / (stride * stride));
    return challenger_log_posterior > tracked_log_posterior + margin;
}

Choice choose_mode(const Belief& belief, const MovedParticles& moved, const Situation& situation, const Frame& frame,
                   Ledger& ledger) {
    const Stopwatch watch;
    const ChoiceOptions& options = frame.method().choice;
    Choice choice;
    std::vector<Mode> hypotheses = propose(belief, moved, situation, frame, ledger);
    const int count = ledger.affordable(Stage::kModes, static_cast<int>(hypotheses.size()), 1);
    choice.alternatives_compared =
        compares_alternatives(belief.lock, frame.method(), frame.step) && count == static_cast<int>(hypotheses.size());
    hypotheses.resize(count);
    std::vector<Mode> refined = refine(hypotheses, situation, frame, ledger);
    keep_prediction(refined.front(), belief, situation, frame, ledger);
    set_priors(refined, belief, frame);
    choice.modes = frame.model.distinct(refined, static_cast<int>(refined.size()));
    if (choice.modes.empty()) return choice;
    const bool found_anywhere = situation.searching() && !frame.observation.segmented();
    std::vector<Mode> tracked = {refined.front()};
    const auto choose = [&] {
        choice.mode = likeliest(choice.modes, belief.tracked ? &tracked.front() : nullptr, stride_of(situation, frame),
                                belief, frame);
        choice.replaces_tracked = is_another(choice.mode, belief, tracked.front(), frame.model);
    };
    choose();
    // What merely is not contradicted must not replace what the image shows.
    if ((found_anywhere || choice.replaces_tracked) && !frame.observation.segmented()) {
        penalise_absent(choice.modes, situation.plan.refinement, frame);
        penalise_absent(tracked, situation.plan.refinement, frame);
        choose();
    }
    if (found_anywhere) disambiguate(choice, belief, situation, frame, ledger);
    set_weights(choice.modes);
    ledger.seconds.refinement = watch.elapsed_s();
    choice.seen = !(choice.mode.support < options.min_support);
    choice.replaces_tracked = choice.seen && is_another(choice.mode, belief, tracked.front(), frame.model);
    choice.alternatives = choice.alternatives_compared || choice.replaces_tracked
                              ? alternatives_to(choice.mode, choice.modes, options, frame.model)
                              : belief.alternatives;
    choice.score = std::clamp(1.0 - choice.mode.cost, 0.0, 1.0);
    return choice;
}

}  // namespace nearpose
