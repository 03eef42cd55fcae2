#include "core/update/choose.hpp"

#include <algorithm>
#include <utility>

#include "core/update/hypotheses.hpp"
#include "core/update/ray_grids.hpp"
#include "core/update/refine.hpp"

namespace nearpose {
namespace {

bool less_evident(const Mode& a, const Mode& b) {
    return a.log_evidence < b.log_evidence;
}

// Where nothing is segmented a search compares modes all over the image with few rays on each. The chosen one and those
// around it are told apart by as many rays on the object alone. The best of them becomes the choice.
void disambiguate(Choice& choice, Situation situation, const Frame& frame, Ledger& ledger) {
    const Mode chosen = choice.mode;
    const Eigen::Vector3d centre = frame.model.centre_in_object();
    const double around_m = 0.5 * frame.model.diameter_m();
    std::vector<Mode> near = {chosen}, far;
    for (const Mode& mode : near_symmetric_modes(chosen, frame.model.symmetries)) near.push_back(mode);
    const std::size_t most = near.size() + static_cast<std::size_t>(frame.method().preselection.disambiguated);
    for (const Mode& mode : choice.modes) {
        const double away_m = (mode.camera_from_object * centre - chosen.camera_from_object * centre).norm();
        (away_m < around_m && near.size() < most ? near : far).push_back(mode);
    }
    situation.window.around = chosen.camera_from_object;
    if (frame.method().hypotheses.alternatives > 0)
        for (const Mode& mode : best_alternatives({chosen}, situation, frame, ledger)) near.push_back(mode);
    move_to_nearest_equivalents(near, frame.model);
    near = refine(near, situation, frame, ledger);
    const double shift = near.front().log_evidence - chosen.log_evidence;
    for (Mode& mode : far) {  // has lost by as much as before
        mode.log_evidence += shift;
        near.push_back(mode);
    }
    choice.mode = *std::max_element(near.begin(), near.end(), less_evident);
    choice.modes = frame.model.distinct(near, static_cast<int>(near.size()));
    std::stable_sort(choice.modes.begin(), choice.modes.end(),
                     [](const Mode& a, const Mode& b) { return a.log_evidence > b.log_evidence; });
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

bool overturns(double challenger_log_evidence, double tracked_log_evidence, int stride, const Lock& lock,
               const ChoiceOptions& options) {
    const double margin = std::max(options.challenge_nats, lock.accepted_evidence / (stride * stride));
    return challenger_log_evidence > tracked_log_evidence + margin;
}

Choice choose_mode(const Belief& belief, const MovedParticles& moved, const Situation& situation, const Frame& frame,
                   Ledger& ledger) {
    const Stopwatch watch;
    Choice choice;
    std::vector<Mode> hypotheses = propose(belief, moved, situation, frame, ledger);
    const int count = ledger.affordable(Stage::kModes, static_cast<int>(hypotheses.size()), 1);
    choice.all_refined = count == static_cast<int>(hypotheses.size());
    hypotheses.resize(count);
    std::vector<Mode> refined = refine(hypotheses, situation, frame, ledger);
    // Where little is in view, refinement may slide off what was accepted.
    if (belief.lock.accepted_evidence > 0.0 && !situation.searching()) {
        const RefinedMode prediction =
            situation.prediction ? *situation.prediction
                                 : evaluate_prediction(belief.tracked->camera_from_object, situation, frame, ledger);
        if (prediction.log_evidence > refined.front().log_evidence) refined.front() = mode_of(prediction);
    }
    choice.modes = frame.model.distinct(refined, static_cast<int>(refined.size()));
    if (choice.modes.empty()) return choice;
    const Mode& tracked = refined.front();
    const Mode& challenger = *std::max_element(choice.modes.begin(), choice.modes.end(), less_evident);
    const int stride = ray_grid(frame, situation.window.around, situation.plan.refinement.max_rays).stride;
    const bool replaces = !belief.tracked || overturns(challenger.log_evidence, tracked.log_evidence, stride,
                                                       belief.lock, frame.method().choice);
    choice.mode = replaces ? challenger : tracked;
    if (situation.searching() && !frame.observation.segmented()) disambiguate(choice, situation, frame, ledger);
    set_weights(choice.modes);
    ledger.seconds.refinement = watch.elapsed_s();
    choice.seen = !(choice.mode.support < frame.method().choice.min_support);
    choice.replaces_tracked = choice.seen && replaces && belief.tracked &&
                              !frame.model.same_mode(choice.mode.camera_from_object, tracked.camera_from_object);
    choice.score = std::clamp(1.0 - choice.mode.cost, 0.0, 1.0);
    return choice;
}

}  // namespace nearpose
