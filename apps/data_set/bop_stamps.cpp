#include "apps/data_set/bop_stamps.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>

#include "apps/base/number_text.hpp"

namespace nearpose::data_set {
namespace {

constexpr double kGap = 5.0;  // usual intervals

std::optional<double> stamp_of(const JsonValue& entry, int frame_id, Notices& notices) {
    constexpr const char* kConsequence = "; it lies between its neighbours'";
    const std::optional<JsonValue> stamp = entry.find("timestamp");
    try {
        if (stamp) return stamp->number();
        notices.add(frame_id,
                    std::string(entry.error("has no timestamp, but other frames have").what()) + kConsequence);
    } catch (const std::runtime_error& error) {
        notices.add(frame_id, std::string(error.what()) + kConsequence);
    }
    return std::nullopt;
}

// The largest set of frames whose stamps grow, in order; of several as large the one that begins earliest.
std::vector<std::size_t> growing(const std::vector<std::optional<double>>& stamps) {
    std::vector<double> starts;                    // minus the latest stamp that begins a set of 1, 2, ... frames
    std::vector<std::size_t> size(stamps.size());  // of the largest set that begins at a frame
    for (std::size_t i = stamps.size(); i-- > 0;) {
        if (!stamps[i]) continue;
        const auto place = std::lower_bound(starts.begin(), starts.end(), -*stamps[i]);
        size[i] = static_cast<std::size_t>(place - starts.begin()) + 1;
        if (place == starts.end()) {
            starts.push_back(-*stamps[i]);
        } else {
            *place = -*stamps[i];
        }
    }
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < stamps.size(); ++i) {
        const bool later = kept.empty() || (stamps[i] && *stamps[i] > *stamps[kept.back()]);
        if (stamps[i] && later && size[i] == starts.size() - kept.size()) kept.push_back(i);
    }
    return kept;
}

// Where frame number `id` lies in time, by the stamps that are kept.
double between(const std::vector<Frame>& frames, const std::vector<std::size_t>& kept, int id,
               double frames_per_second) {
    const auto later = std::find_if(kept.begin(), kept.end(), [&](std::size_t i) { return frames[i].id > id; });
    const Frame& first = frames[later == kept.begin() ? *later : *(later - 1)];
    double second_per_frame = 1.0 / frames_per_second;
    if (kept.size() > 1) {
        const bool inside = later != kept.begin() && later != kept.end();
        const Frame& from = inside ? first : frames[kept.front()];
        const Frame& to = frames[inside ? *later : kept.back()];
        second_per_frame = (to.stamp_s - from.stamp_s) / (to.id - from.id);
    }
    return first.stamp_s + (id - first.id) * second_per_frame;
}

void note_gaps(const std::vector<Frame>& frames, Notices& notices) {
    constexpr std::size_t kFewest = 4;  // below that there is no usual interval
    std::vector<double> intervals_s;
    for (std::size_t i = 1; i < frames.size(); ++i) intervals_s.push_back(frames[i].stamp_s - frames[i - 1].stamp_s);
    if (intervals_s.size() < kFewest) return;
    std::vector<double> sorted = intervals_s;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    const double usual_s = sorted[sorted.size() / 2];
    const auto gaps = std::count_if(intervals_s.begin(), intervals_s.end(),
                                    [&](double interval_s) { return interval_s > kGap * usual_s; });
    if (gaps == 0) return;
    const auto longest = std::max_element(intervals_s.begin(), intervals_s.end());
    const int frame_id = frames[static_cast<std::size_t>(longest - intervals_s.begin()) + 1].id;
    notices.add(frame_id, "the time stamps have " + std::to_string(gaps) + (gaps == 1 ? " gap" : " gaps") +
                              ", the longest of " + format_fixed(*longest, 2) + " s before frame " +
                              std::to_string(frame_id) + "; usual are " + format_fixed(usual_s, 3) + " s");
}

}  // namespace

bool set_stamps(std::vector<Frame>& frames, const std::vector<JsonValue>& entries, double frames_per_second,
                Notices& notices) {
    std::vector<std::optional<double>> given(frames.size());
    const bool any = std::any_of(entries.begin(), entries.end(),
                                 [](const JsonValue& entry) { return entry.find("timestamp").has_value(); });
    for (std::size_t i = 0; any && i < frames.size(); ++i) given[i] = stamp_of(entries[i], frames[i].id, notices);
    if (std::none_of(given.begin(), given.end(), [](const auto& stamp) { return stamp.has_value(); })) {
        for (Frame& frame : frames) frame.stamp_s = frame.id / frames_per_second;
        return false;
    }
    const std::vector<std::size_t> kept = growing(given);
    for (const std::size_t i : kept) frames[i].stamp_s = *given[i];
    for (std::size_t i = 0; i < frames.size(); ++i) {
        if (std::binary_search(kept.begin(), kept.end(), i)) continue;
        const double stamp_s = between(frames, kept, frames[i].id, frames_per_second);
        if (given[i]) {
            notices.add(frames[i].id,
                        entries[i]
                            .error("the timestamp " + format_number(*given[i]) + " repeats or goes backwards; " +
                                   format_fixed(stamp_s, 3) + " s is taken, between its neighbours'")
                            .what());
        }
        frames[i].stamp_s = stamp_s;
    }
    note_gaps(frames, notices);
    return true;
}

}  // namespace nearpose::data_set
