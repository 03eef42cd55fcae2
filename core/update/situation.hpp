// What is decided about a frame before its particles move.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/filter/gradient_step.hpp"
#include "core/search/surfels.hpp"
#include "core/update/belief.hpp"
#include "core/update/phase.hpp"

namespace nearpose {

// Where poses are compared with the image. Particles of a search are judged wherever each of them puts the object. A
// ray grid for all poses lies around `around`, where that is set and nothing is segmented.
struct Window {
    bool everywhere = false;     // the object may be anywhere: during a search
    std::optional<Pose> around;  // camera_from_object: the predicted pose, or the one that a search has chosen
    // How much each place of the image says about the pose, for a search. None: all places say the same.
    std::shared_ptr<const SurfelGrid> surfels;
};

// What a search found.
struct SearchResult {
    ParticleSet particles;
    std::shared_ptr<const SurfelGrid> surfels;  // where it went by pairs of points
    std::vector<Pose> best_from_pairs;          // its best hypotheses, best first, where nothing is segmented
};

struct Situation {
    Phase phase = Phase::kSearching;
    Plan plan;  // what the phase is worth
    Window window;
    std::vector<Pose> best_from_pairs;      // as found by a search
    std::optional<RefinedMode> prediction;  // the predicted pose, where the image agrees with it

    bool searching() const { return phase == Phase::kSearching; }
};

// The share of `count` that a search of this frame makes, rounded up.
int share_of(const Plan& plan, int count);

// By the record of the frames before.
Situation situation_of(const Belief& predicted, const Method& method);
// The same after a search: poses are compared where its surfels say something.
Situation after_search(Situation situation, const SearchResult& found);

// Where the lost pose is by the arm's motion, from a search on until the track is confirmed again: the object may only
// have been occluded for a while.
std::optional<Pose> pose_before_loss(const Belief& predicted, Phase phase, const Method& method);

}  // namespace nearpose
