// Why the frames of a run were not accepted: counted, named, and what to do about it. The words are those of the log,
// which a newer program may have written: one that is not known here is counted under its own name.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apps/data_set/json_file.hpp"
#include "core/evidence/verdict.hpp"

namespace nearpose::program {

struct JudgedFrame {
    int frame_id = 0;
    Verdict verdict = Verdict::kContinue;
    std::vector<std::string> missing;  // requirements, as to_string(Requirement) names them
};

// A requirement that frames did not meet.
struct Lack {
    std::string requirement;
    int frames = 0;
    int first_frame = 0;  // its id
};

struct VerdictTally {
    int frames = 0, accepts = 0, continues = 0, lost = 0;
    std::vector<Lack> lacks;  // the most frequent first, and of equal ones that which came first
};

VerdictTally tally_of(const std::vector<JudgedFrame>& frames);

// What such a frame lacks, as "precision of the position"; the requirement itself where it is not known.
std::string title_of(std::string_view requirement);
// What to do next; empty where the requirement is not known.
std::string advice_for(std::string_view requirement);

// The verdict that a log states. Throws std::runtime_error, naming file and place, where it is none.
Verdict logged_verdict(const data_set::JsonValue& value);

}  // namespace nearpose::program
