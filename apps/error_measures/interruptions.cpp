#include "apps/error_measures/interruptions.hpp"

#include <algorithm>

namespace nearpose::evaluation {

std::vector<bool> excused_frames(const std::vector<FrameErrors>& frames) {
    std::vector<bool> excused;
    int left = 0;  // frames in which there is still time
    for (const FrameErrors& frame : frames) {
        if (frame.shown != Shown::kPart || frame.part_moved) left = kFramesToRecover;
        excused.push_back(frame.shown != Shown::kPart || left > 0);
        if (frame.shown == Shown::kPart && left > 0) --left;
    }
    return excused;
}

std::optional<int> return_index(const std::vector<FrameErrors>& frames) {
    bool seen = false, gone = false;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const bool returns = gone && frames[i].shown != Shown::kNothing;
        if (frames[i].part_moved || returns) return static_cast<int>(i);
        seen = seen || frames[i].shown == Shown::kPart;
        gone = seen && frames[i].shown == Shown::kNothing;
    }
    return std::nullopt;
}

std::optional<int> end_of_fault(const std::vector<FrameErrors>& frames) {
    const auto end =
        std::find_if(frames.begin(), frames.end(), [](const FrameErrors& frame) { return frame.after_fault; });
    return end == frames.end() ? std::nullopt : std::optional(static_cast<int>(end - frames.begin()));
}

}  // namespace nearpose::evaluation
