// What `nearpose estimate` says at its end about its verdicts.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/runs/verdict_tally.hpp"

namespace nearpose::program {

// The counts of the verdicts, then a line for each of the most frequent lacks, at most three, with what to do next.
std::vector<std::string> summary_lines(const VerdictTally& tally);

// What image and arm say against each other: of each such requirement the last sentence, with its frame.
using ArmSentences = std::map<Requirement, std::string>;
void gather(ArmSentences& sentences, int frame_id, const std::vector<Shortfall>& missing);

}  // namespace nearpose::program
