// What breaks into a run: frames that do not show the part, and a part that is put down elsewhere.
#pragma once

#include <optional>
#include <vector>

#include "apps/error_measures/frame_errors.hpp"

namespace nearpose::evaluation {

// Frames after an interruption in which the pose may be found again: no loss is counted in them.
inline constexpr int kFramesToRecover = 3;

// For each frame whether a pose that is not there is no loss: in frames that do not show the part, in the first
// kFramesToRecover that show it again, and in as many from where it was put down elsewhere.
std::vector<bool> excused_frames(const std::vector<FrameErrors>& frames);

// The first frame in which the part lies elsewhere than before, or is in view again after it was not. Frames of
// nonsense are no absence: the part did not go. Nothing where nothing of the kind happens.
std::optional<int> return_index(const std::vector<FrameErrors>& frames);

// The first frame after the recording's faults; nothing where there is no fault or one lasts to the end.
std::optional<int> end_of_fault(const std::vector<FrameErrors>& frames);

}  // namespace nearpose::evaluation
