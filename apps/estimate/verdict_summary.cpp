#include "apps/estimate/verdict_summary.hpp"

#include <algorithm>

namespace nearpose::program {
namespace {

constexpr std::size_t kMaxLacks = 3;

std::string line_of(const Lack& lack, int frames) {
    const std::string advice = advice_for(lack.requirement);
    return std::to_string(lack.frames) + " of " + std::to_string(frames) + (frames == 1 ? " frame" : " frames") +
           (lack.frames == 1 ? " lacks " : " lack ") + title_of(lack.requirement) +
           " (first: " + std::to_string(lack.first_frame) + ")" + (advice.empty() ? "" : ": " + advice);
}

}  // namespace

std::vector<std::string> summary_lines(const VerdictTally& tally) {
    std::vector<std::string> lines = {"verdicts of " + std::to_string(tally.frames) +
                                      (tally.frames == 1 ? " frame: " : " frames: ") + std::to_string(tally.accepts) +
                                      " accept, " + std::to_string(tally.continues) + " continue, " +
                                      std::to_string(tally.lost) + " lost"};
    for (std::size_t i = 0; i < std::min(kMaxLacks, tally.lacks.size()); ++i)
        lines.push_back(line_of(tally.lacks[i], tally.frames));
    return lines;
}

void gather(ArmSentences& sentences, int frame_id, const std::vector<Shortfall>& missing) {
    for (const Shortfall& shortfall : missing) {
        const Requirement requirement = shortfall.requirement;
        if (requirement == Requirement::kNewImage || requirement == Requirement::kArmMotion ||
            requirement == Requirement::kSetup)
            sentences[requirement] = "frame " + std::to_string(frame_id) + ": " + describe(shortfall);
    }
}

}  // namespace nearpose::program
