// Which frames of a path a recording delivers, what each of them shows, and when.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/scenes/fault.hpp"

namespace nearpose::simulate {

struct Delivery {
    std::vector<int> ids;  // of the frames that are delivered, ascending

    // Of every frame of the path, delivered or not:
    std::vector<int> copy_of;   // the frame whose image, stamp and arm's pose it has; itself unless kDuplicated
    std::vector<int> image_of;  // the frame whose image it has; itself unless kFrozen
    std::vector<double> stamp;  // when its image arrives [frame times]; its own number unless kLate
};

// `dropped_fraction` of the frames are lost by chance, never the first; those of kDropped beside them. An image waits
// for late ones before it and arrives a tenth of a frame time behind them.
Delivery delivery_of(int num_frames, double dropped_fraction, const std::vector<Fault>& faults, std::uint64_t seed);

}  // namespace nearpose::simulate
