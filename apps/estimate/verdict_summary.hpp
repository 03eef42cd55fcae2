// What `nearpose estimate` says at its end about its verdicts.
#pragma once

#include <string>
#include <vector>

#include "apps/runs/verdict_tally.hpp"

namespace nearpose::program {

// The counts of the verdicts, then a line for each of the most frequent lacks, at most three, with what to do next.
std::vector<std::string> summary_lines(const VerdictTally& tally);

}  // namespace nearpose::program
