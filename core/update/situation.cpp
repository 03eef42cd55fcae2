#include "core/update/situation.hpp"

#include <cmath>

namespace nearpose {

int share_of(const Plan& plan, int count) {
    return static_cast<int>(std::ceil(plan.search_share * count));
}

Situation situation_of(const Belief& predicted, const Method& method) {
    Situation situation;
    situation.phase = phase_of(predicted.lock, method, predicted.particles.size() > 0);
    situation.plan = plan_of(situation.phase, method, false);
    situation.window.everywhere = situation.searching();
    if (situation.searching()) {
        situation.plan.search_share = search_share(predicted.lock, method.relocalisation);
        situation.plan.alternatives = share_of(situation.plan, situation.plan.alternatives);
    }
    if (!situation.searching() && predicted.tracked) situation.window.around = predicted.tracked->camera_from_object;
    return situation;
}

Situation after_search(Situation situation, const SearchResult& found) {
    situation.window.surfels = found.surfels;
    situation.best_from_pairs = found.best_from_pairs;
    return situation;
}

std::optional<Pose> pose_before_loss(const Belief& predicted, Phase phase, const Method& method) {
    if (phase != Phase::kSearching)
        return confirmed(predicted.lock, method) ? std::nullopt : predicted.pose_before_loss;
    if (predicted.pose_before_loss || !predicted.tracked) return predicted.pose_before_loss;
    return predicted.tracked->camera_from_object;
}

}  // namespace nearpose
