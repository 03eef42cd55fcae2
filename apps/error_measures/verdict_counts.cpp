#include "apps/error_measures/verdict_counts.hpp"

#include "apps/error_measures/interruptions.hpp"

namespace nearpose::evaluation {
namespace {

bool is_right(const FrameErrors& frame, const Tolerance& tolerance) {
    return frame.shown == Shown::kPart && frame.errors && frame.errors->translation_m <= tolerance.translation_m &&
           frame.errors->rotation_rad <= tolerance.rotation_rad;
}

std::optional<int> frames_to_recover(const std::vector<FrameErrors>& frames, const Tolerance& tolerance) {
    const std::optional<int> from = end_of_fault(frames);
    for (int i = from.value_or(0); from && i < static_cast<int>(frames.size()); ++i) {
        const FrameErrors& frame = frames[static_cast<std::size_t>(i)];
        if (frame.verdict == Verdict::kAccept && is_right(frame, tolerance)) return i - *from + 1;
    }
    return std::nullopt;
}

}  // namespace

bool is_false_accept(const FrameErrors& frame, const Tolerance& tolerance) {
    return frame.verdict == Verdict::kAccept && !is_right(frame, tolerance);
}

bool is_missed(const FrameErrors& frame, const Tolerance& tolerance) {
    return frame.verdict == Verdict::kLost && is_right(frame, tolerance);
}

VerdictCounts count_verdicts(const std::vector<FrameErrors>& frames, const Tolerance& tolerance) {
    VerdictCounts counts;
    counts.frames_to_recover = frames_to_recover(frames, tolerance);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const FrameErrors& frame = frames[i];
        if (!frame.verdict) continue;
        ++counts.frames;
        if (is_right(frame, {0.5 * tolerance.translation_m, 0.5 * tolerance.rotation_rad})) {
            ++counts.well_within;
            if (*frame.verdict == Verdict::kAccept) ++counts.well_within_accepts;
        }
        if (*frame.verdict == Verdict::kContinue) ++counts.continues;
        if (*frame.verdict == Verdict::kLost) ++counts.lost;
        if (is_missed(frame, tolerance)) ++counts.missed;
        if (*frame.verdict != Verdict::kAccept) continue;
        ++counts.accepts;
        if (is_false_accept(frame, tolerance)) {
            ++counts.false_accepts;
        } else if (!counts.first_right_accept) {
            counts.first_right_accept = static_cast<int>(i);
        }
    }
    return counts;
}

}  // namespace nearpose::evaluation
