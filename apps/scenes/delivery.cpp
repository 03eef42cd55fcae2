#include "apps/scenes/delivery.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/base/simulation_draws.hpp"

namespace nearpose::simulate {
namespace {

// The frames that are left, of which there are as many as the fraction says.
std::vector<int> kept_by_chance(int num_frames, double dropped_fraction, std::uint64_t seed) {
    const int num_dropped = std::min(static_cast<int>(std::lround(dropped_fraction * num_frames)), num_frames - 1);
    std::vector<std::pair<double, int>> later;  // a draw each: those with the least are dropped
    for (int frame = 1; frame < num_frames; ++frame)
        later.emplace_back(RandomStream(seed, static_cast<std::uint64_t>(frame), 0, kDropDraw).uniform(), frame);
    std::sort(later.begin(), later.end());
    std::vector<int> kept{0};
    for (auto it = later.begin() + num_dropped; it != later.end(); ++it) kept.push_back(it->second);
    std::sort(kept.begin(), kept.end());
    return kept;
}

bool has(const std::vector<Fault>& faults, FaultKind kind, int frame) {
    return std::any_of(faults.begin(), faults.end(),
                       [&](const Fault& fault) { return fault.kind == kind && fault.is_in(frame); });
}

// Every other frame of the fault, from the first that has one before it.
bool is_duplicate(const std::vector<Fault>& faults, int frame) {
    return std::any_of(faults.begin(), faults.end(), [&](const Fault& fault) {
        return fault.kind == FaultKind::kDuplicated && fault.is_in(frame) && frame > 0 &&
               (frame - std::max(1, fault.first)) % 2 == 0;
    });
}

// The frame before it hangs, or the one that this one shows.
int shown_in(const std::vector<Fault>& faults, int frame, const std::vector<int>& image_of_earlier) {
    for (const Fault& fault : faults) {
        const int before = std::max(0, fault.first - 1);
        if (fault.kind == FaultKind::kFrozen && fault.is_in(frame) && before < frame)
            return image_of_earlier[static_cast<std::size_t>(before)];
    }
    return frame;
}

}  // namespace

Delivery delivery_of(int num_frames, double dropped_fraction, const std::vector<Fault>& faults, std::uint64_t seed) {
    constexpr double kDelay = 1.5, kQueue = 0.1;  // [frame times]
    Delivery delivery;
    for (int frame = 0; frame < num_frames; ++frame) {
        delivery.copy_of.push_back(is_duplicate(faults, frame) ? delivery.copy_of[static_cast<std::size_t>(frame) - 1]
                                                               : frame);
        delivery.image_of.push_back(shown_in(faults, frame, delivery.image_of));
        const double stamp = frame + (has(faults, FaultKind::kLate, frame) ? kDelay : 0.0);
        delivery.stamp.push_back(frame == 0 ? stamp : std::max(stamp, delivery.stamp.back() + kQueue));
    }
    for (const int frame : kept_by_chance(num_frames, dropped_fraction, seed)) {
        if (!has(faults, FaultKind::kDropped, frame)) delivery.ids.push_back(frame);
    }
    return delivery;
}

}  // namespace nearpose::simulate
