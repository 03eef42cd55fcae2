// What the tracked pose may be mistaken for, and how much less likely that is by all frames so far: a Bayes filter over
// the modes of the posterior. A part that nearly looks the same after half a turn shows little of the difference in one
// image, and enough in several.
#pragma once

#include <vector>

#include "core/update/object_model.hpp"

namespace nearpose {

// In axes of the object, so that neither the camera's motion nor the object's changes it.
struct Alternative {
    Pose tracked_from_alternative;  // camera_from_alternative = camera_from_tracked * this
    double log_odds = 0.0;          // against the tracked mode [nats]
};

// The alternatives as modes, to be refined.
std::vector<Mode> modes_of(const std::vector<Alternative>& alternatives, const Pose& camera_from_tracked);

// Gives each mode what the frames before said of it: 0 for the tracked mode, and for one that was not known before;
// else `kept` of the log-odds.
void set_priors(std::vector<Mode>& modes, const std::vector<Alternative>& alternatives, const Pose& camera_from_tracked,
                double kept, const ObjectModel& model);

// What a frame that compared the chosen mode with its alternatives carries to the next one: the likeliest of the modes
// beside it. One that is elsewhere in the image is no alternative, but another thing.
std::vector<Alternative> alternatives_to(const Mode& chosen, const std::vector<Mode>& modes,
                                         const ChoiceOptions& options, const ObjectModel& model);

// Share of the probability that the alternatives have, in 0..1.
double weight_of(const std::vector<Alternative>& alternatives);

}  // namespace nearpose
