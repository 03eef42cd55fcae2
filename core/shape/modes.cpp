#include "core/shape/modes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/random.hpp"

namespace nearpose {

bool same_mode(const Pose& a, const Pose& b, const Eigen::Vector3d& centre_in_object, const ModeDistance& distance) {
    return angle_between(a.rotation, b.rotation) < distance.rotation_rad &&
           (a * centre_in_object - b * centre_in_object).norm() < distance.translation_m;
}

std::vector<Mode> distinct_modes(const std::vector<Mode>& modes, int max_count, const Eigen::Vector3d& centre_in_object,
                                 const ModeDistance& distance) {
    std::vector<int> order(modes.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return modes[a].cost < modes[b].cost; });
    std::vector<Mode> chosen;
    for (const int index : order) {
        if (static_cast<int>(chosen.size()) >= max_count) break;
        const Mode& mode = modes[index];
        const auto is_same = [&](const Mode& other) {
            return same_mode(mode.camera_from_object, other.camera_from_object, centre_in_object, distance);
        };
        if (std::isfinite(mode.cost) && std::none_of(chosen.begin(), chosen.end(), is_same)) chosen.push_back(mode);
    }
    return chosen;
}

void set_weights(std::vector<Mode>& modes) {
    double best = -std::numeric_limits<double>::infinity(), sum = 0.0;
    for (const Mode& mode : modes) best = std::max(best, mode.log_posterior());
    for (Mode& mode : modes) sum += mode.weight = std::exp(mode.log_posterior() - best);
    for (Mode& mode : modes) mode.weight /= sum;
}

std::vector<Pose> alternatives_of(const Pose& camera_from_object, const ModelExtent& extent, int count,
                                  std::uint64_t seed, std::uint64_t step, const AlternativeOptions& options) {
    RandomStream random(seed, step, 0, RandomPurpose::kAlternatives);
    const Eigen::Vector3d size_m = extent.box_max_in_object - extent.box_min_in_object;
    std::vector<Pose> alternatives;
    for (int k = 0; k < count; ++k) {
        Twist change = Twist::Zero();
        const int turn_axis = random.below(4);  // 3: no turn
        const int steps = 1 + random.below(options.steps_per_turn - 1);
        if (turn_axis < 3) change[turn_axis] = steps * 2.0 * M_PI / options.steps_per_turn;
        const int shift_axis = random.below(4);  // 3: no shift
        const double shift = random.uniform(-options.max_shift, options.max_shift);
        if (shift_axis < 3) change[3 + shift_axis] = shift * size_m[shift_axis];
        if (turn_axis == 3 && shift_axis == 3) change[3 + k % 3] = shift * size_m[k % 3];  // never the pose itself
        alternatives.push_back(perturb_about(camera_from_object, change, extent.centre_in_object()));
    }
    return alternatives;
}

}  // namespace nearpose
