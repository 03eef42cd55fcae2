#include "core/update/alternatives.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose {
namespace {

Pose camera_from(const Alternative& alternative, const Pose& camera_from_tracked, const ObjectModel& model) {
    const Pose pose = camera_from_tracked * alternative.tracked_from_alternative;
    if (model.symmetries.empty()) return pose;
    return nearest_equivalent(pose, camera_from_tracked, model.symmetries, model.centre_in_object());
}

}  // namespace

std::vector<Mode> modes_of(const std::vector<Alternative>& alternatives, const Pose& camera_from_tracked) {
    std::vector<Mode> modes;
    for (const Alternative& alternative : alternatives)
        modes.push_back(mode_at(camera_from_tracked * alternative.tracked_from_alternative));
    return modes;
}

void set_priors(std::vector<Mode>& modes, const std::vector<Alternative>& alternatives, const Pose& camera_from_tracked,
                double kept, const ObjectModel& model) {
    for (Mode& mode : modes) {
        mode.log_prior = 0.0;
        if (model.same_mode(mode.camera_from_object, camera_from_tracked)) continue;
        for (const Alternative& alternative : alternatives) {
            if (!model.same_mode(mode.camera_from_object, camera_from(alternative, camera_from_tracked, model)))
                continue;
            mode.log_prior = kept * alternative.log_odds;
            break;
        }
    }
}

std::vector<Alternative> alternatives_to(const Mode& chosen, const std::vector<Mode>& modes,
                                         const ChoiceOptions& options, const ObjectModel& model) {
    const Pose chosen_from_camera = chosen.camera_from_object.inverse();
    const Eigen::Vector3d centre = model.centre_in_object();
    std::vector<Alternative> alternatives;
    for (const Mode& mode : modes) {
        const double log_odds = mode.log_posterior() - chosen.log_posterior();
        const Pose chosen_from_mode = chosen_from_camera * mode.camera_from_object;
        const double away_m = (chosen_from_mode * centre - centre).norm();
        if (!model.same_mode(mode.camera_from_object, chosen.camera_from_object) &&
            away_m < options.alternatives_within_diameters * model.diameter_m() && log_odds > options.least_log_odds)
            alternatives.push_back({chosen_from_mode, log_odds});
    }
    std::stable_sort(alternatives.begin(), alternatives.end(),
                     [](const Alternative& a, const Alternative& b) { return a.log_odds > b.log_odds; });
    alternatives.resize(std::min(alternatives.size(), static_cast<std::size_t>(options.alternatives_remembered)));
    return alternatives;
}

double weight_of(const std::vector<Alternative>& alternatives) {
    double best = 0.0;  // the tracked mode's
    for (const Alternative& alternative : alternatives) best = std::max(best, alternative.log_odds);
    double sum = 0.0;
    for (const Alternative& alternative : alternatives) sum += std::exp(alternative.log_odds - best);
    return sum / (sum + std::exp(-best));
}

}  // namespace nearpose
