#include "core/update/hypotheses.hpp"

#include <algorithm>

#include "core/base/parallel.hpp"
#include "core/update/pose_evidence.hpp"
#include "core/update/ray_grids.hpp"

namespace nearpose {
namespace {

std::vector<Mode> modes_of(const MovedParticles& moved) {
    std::vector<Mode> modes;
    for (int i = 0; i < moved.particles.size(); ++i) modes.push_back(mode_at(moved.particles.poses[i], moved.costs[i]));
    return modes;
}

// The particles' modes and the best hypotheses from pairs, by turns.
std::vector<Mode> interleaved(const std::vector<Mode>& modes, const std::vector<Pose>& poses) {
    std::vector<Mode> all;
    for (std::size_t k = 0; k < std::max(modes.size(), poses.size()); ++k) {
        if (k < modes.size()) all.push_back(modes[k]);
        if (k < poses.size()) all.push_back(mode_at(poses[k]));
    }
    return all;
}

// What speaks for planes alone where a pose puts the object [pixels that cost 1].
double cost_of_absence(const Pose& pose, const RefinementOptions& refinement, const Frame& frame) {
    const PreselectionOptions& options = frame.method().preselection;
    if (options.presence_rays == 0) return 0.0;
    const ObservedGrid around = observe(frame.observation, ray_grid(frame, pose, options.rays));
    const PoseEvidence shown = evidence_at(pose, frame.context(around, frame.method().step), refinement, frame);
    return std::max(0.0, -shown.positive.total()) * around.grid.stride * around.grid.stride;
}

// The particles' modes and the hypotheses from pairs that explain most of the image. Each is refined a little first, on
// few rays where it puts the object: before that a wrong one may score better than the right one.
std::vector<Mode> preselect(const std::vector<Mode>& particles, const Situation& situation, const Frame& frame,
                            Ledger& ledger) {
    const PreselectionOptions& options = frame.method().preselection;
    constexpr int kLeastKept = 2;
    const Stopwatch watch;
    RefinementOptions refinement = situation.plan.refinement;
    refinement.rounds = std::min(refinement.rounds, options.rounds);
    const auto tried = static_cast<std::size_t>(share_of(situation.plan, options.tried));
    std::vector<Pose> from_pairs = situation.best_from_pairs;
    from_pairs.resize(std::min(from_pairs.size(), tried));
    std::vector<Mode> modes = interleaved(frame.model.distinct(particles, static_cast<int>(tried)), from_pairs);
    const int count = ledger.affordable(Stage::kPreselection, static_cast<int>(modes.size()), 1);
    modes.resize(count);
    std::vector<RefinedMode> moved(modes.size());
    parallel_for(count, frame.options.num_threads, [&](int k) {
        const Pose& pose = modes[k].camera_from_object;
        const ObservedGrid observed = observe(frame.observation, ray_grid_on_model(frame, pose, options.rays));
        moved[k] = refine_mode(pose, frame.context(observed, frame.method().step), refinement);
        modes[k] =
            mode_at(moved[k].camera_from_object, -moved[k].gain * observed.grid.stride * observed.grid.stride +
                                                     cost_of_absence(moved[k].camera_from_object, refinement, frame));
    });
    for (const RefinedMode& mode : moved) ledger.add(mode.counts, mode.seconds);
    ledger.budget.took(Stage::kPreselection, count, watch.elapsed_s());
    return frame.model.distinct(modes, std::max(kLeastKept, share_of(situation.plan, options.kept)));
}

void append(std::vector<Mode>& modes, const std::vector<Mode>& more) {
    modes.insert(modes.end(), more.begin(), more.end());
}

// Those that are no mode of `known`.
void append_new(std::vector<Mode>& modes, const std::vector<Mode>& more, const std::vector<Mode>& known,
                const ObjectModel& model) {
    for (const Mode& mode : more)
        if (std::none_of(known.begin(), known.end(), [&](const Mode& other) {
                return model.same_mode(mode.camera_from_object, other.camera_from_object);
            }))
            modes.push_back(mode);
}

}  // namespace

std::vector<Mode> propose(const Belief& belief, const MovedParticles& moved, const Situation& situation,
                          const Frame& frame, Ledger& ledger) {
    const HypothesisOptions& options = frame.method().hypotheses;
    const bool preselected = frame.method().preselection.tried > 0;
    const bool found_anywhere = situation.searching() && !frame.observation.segmented();
    const std::vector<Mode> particles = modes_of(moved);
    std::vector<Mode> leaders = found_anywhere && preselected ? preselect(particles, situation, frame, ledger)
                                                              : frame.model.distinct(particles, options.modes);
    // Once a pose is established, one hypothesis is enough for its mode: its prediction where the image agrees with it,
    // else the particle that came nearest, as where the object moves.
    const bool leads = is_established(situation.phase) && !leaders.empty() &&
                       frame.model.same_mode(leaders.front().camera_from_object, belief.tracked->camera_from_object);
    std::vector<Mode> modes;
    if (leads && !situation.prediction)
        modes.push_back(leaders.front());
    else if (belief.tracked)
        modes.push_back(*belief.tracked);
    if (leads) leaders.erase(leaders.begin());
    if (belief.pose_before_loss) modes.push_back(mode_at(*belief.pose_before_loss));
    std::vector<Mode> known;
    if (belief.tracked && compares_alternatives(belief.lock, frame.method(), frame.step))
        known = modes_of(belief.alternatives, belief.tracked->camera_from_object);
    append(modes, known);
    append_new(modes, leaders, known, frame.model);
    if (!preselected)
        for (const Pose& pose : situation.best_from_pairs) modes.push_back(mode_at(pose));
    // A search everywhere tries those of the mode that it has chosen, see disambiguate.
    if (options.alternatives > 0 && alternatives_due(belief.lock, frame.method(), frame.step) && !found_anywhere) {
        const std::vector<Mode> alternatives = best_alternatives(modes, situation, frame, ledger);
        if (!modes.empty())
            append_new(modes, near_symmetric_modes(modes.front(), frame.model.symmetries), known, frame.model);
        append_new(modes, alternatives, known, frame.model);
    }
    move_to_nearest_equivalents(modes, frame.model);
    return modes;
}

std::vector<Mode> near_symmetric_modes(const Mode& mode, const Symmetries& symmetries) {
    std::vector<Mode> modes;
    for (const Pose& turn : symmetries.near_symmetries) {
        modes.push_back(mode);
        modes.back().camera_from_object = mode.camera_from_object * turn;
    }
    return modes;
}

std::vector<Mode> best_alternatives(const std::vector<Mode>& leaders, const Situation& situation, const Frame& frame,
                                    Ledger& ledger) {
    const Stopwatch watch;
    const HypothesisOptions& options = frame.method().hypotheses;
    const int wanted = ledger.affordable(Stage::kAlternatives, situation.plan.alternatives, 0);
    if (wanted == 0) return {};
    const std::size_t used = std::min(leaders.size(), static_cast<std::size_t>(options.leaders));
    std::vector<Pose> proposals;
    for (std::size_t k = 0; k < used; ++k) {
        const auto first = wanted * k / used, last = wanted * (k + 1) / used;
        const std::vector<Pose> of_leader =
            alternatives_of(leaders[k].camera_from_object, frame.model.extent(), static_cast<int>(last - first),
                            frame.options.seed + k, frame.step, options.changes);
        proposals.insert(proposals.end(), of_leader.begin(), of_leader.end());
    }
    GradientStep step = frame.method().search.step;
    step.max_rays = std::min(step.max_rays, situation.plan.step.max_rays);
    const std::vector<MovedParticle> moved =
        move_poses(proposals, step, RandomPurpose::kAlternatives, situation.window, frame, ledger);
    ledger.effort.alternatives = static_cast<int>(moved.size());
    ledger.budget.took(Stage::kAlternatives, ledger.effort.alternatives, watch.elapsed_s());
    std::vector<Mode> modes;
    for (const MovedParticle& pose : moved) modes.push_back({pose.camera_from_object, pose.cost, pose.support});
    return frame.model.distinct(modes, options.alternatives_refined);
}

void move_to_nearest_equivalents(std::vector<Mode>& modes, const ObjectModel& model) {
    if (model.symmetries.empty() || modes.empty()) return;
    const Pose reference = modes.front().camera_from_object;
    for (Mode& mode : modes)
        mode.camera_from_object =
            nearest_equivalent(mode.camera_from_object, reference, model.symmetries, model.centre_in_object());
}

}  // namespace nearpose
