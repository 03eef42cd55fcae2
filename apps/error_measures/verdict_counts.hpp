// How often the estimator said that its pose may be acted on, and how often that was wrong.
#pragma once

#include <optional>
#include <vector>

#include "apps/error_measures/frame_errors.hpp"
#include "core/evidence/verdict.hpp"

namespace nearpose::evaluation {

// Counts over all frames of a run, the burn-in included.
struct VerdictCounts {
    int frames = 0;         // with a verdict
    int accepts = 0;        //
    int false_accepts = 0;  // of the accepts
    int continues = 0;
    int lost = 0;
    int missed = 0;                         // of the lost
    std::optional<int> first_right_accept;  // index into the frames
    std::optional<int> frames_to_recover;   // from the end of faults (interruptions.hpp) to the next right accept
    // Frames whose pose is within half the tolerance, and of them the accepted: an estimator that knows its errors
    // accepts these, while near the tolerance itself it may as well not.
    int well_within = 0, well_within_accepts = 0;
};

// The pose is accepted, but wrong: by more than the tolerance at the centre of the box, or of a part that the image
// does not show, so that nothing in it speaks for the pose.
bool is_false_accept(const FrameErrors& frame, const Tolerance& tolerance);

// The pose is given up, but right: the part is shown, and its pose within the tolerance.
bool is_missed(const FrameErrors& frame, const Tolerance& tolerance);

VerdictCounts count_verdicts(const std::vector<FrameErrors>& frames, const Tolerance& tolerance);

}  // namespace nearpose::evaluation
