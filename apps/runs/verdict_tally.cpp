#include "apps/runs/verdict_tally.hpp"

#include <algorithm>
#include <optional>

namespace nearpose::program {
namespace {

std::optional<Requirement> requirement_of(std::string_view name) {
    for (int i = 0; i <= static_cast<int>(Requirement::kRotation); ++i) {
        const auto requirement = static_cast<Requirement>(i);
        if (name == to_string(requirement)) return requirement;
    }
    return std::nullopt;
}

struct Words {
    const char* title = "";
    const char* advice = "";
};

Words words_for(Requirement requirement) {
    switch (requirement) {
        case Requirement::kSeen:
            return {"sight of the part",
                    "is it in the image and in the mask? Check the model's unit and the depth's scale"};
        case Requirement::kPresence:
            return {"evidence that the part is there", "show more of its relief and edges: go nearer, or look aslant"};
        case Requirement::kAgreement:
            return {"agreement with the image",
                    "look at --pictures: is the pose wrong, the part covered, or the model not as built?"};
        case Requirement::kSupport:
            return {"a sufficient view of the model", "move to where more of the part is in view"};
        case Requirement::kOutline:
            return {"the model's outline in the image", "look from the side, or give masks"};
        case Requirement::kOverlap:
            return {"overlap of mask and model", "check that the masks are of this part and of these frames"};
        case Requirement::kAlternativesTried:
            return {"comparison with poses that look alike", "give it some more frames"};
        case Requirement::kAlternatives:
            return {"a clear lead over another pose",
                    "show a detail that tells them apart, or give --initial-pose; declare symmetries"};
        case Requirement::kNewImage:
            return {"a new image", "the camera repeats its image: check its driver and its cable"};
        case Requirement::kStands:
            return {"a part that stands", "wait some frames; where nobody moves the part, check the arm's motion"};
        case Requirement::kArmMotion:
            return {"images that move as the arm says",
                    "check the camera's mounting and the poses given with the frames"};
        case Requirement::kSetup:
            return {"a set-up that agrees with the images", "check intrinsics, depth scale and hand-eye calibration"};
        case Requirement::kTranslation:
            return {"precision of the position", "go nearer, look from another side, or widen --tolerance-mm"};
        case Requirement::kRotation:
            return {"precision of the rotation", "go nearer, look from another side, or widen --tolerance-deg"};
    }
    return {};
}

void add(std::vector<Lack>& lacks, const std::string& requirement, int frame_id) {
    const auto found =
        std::find_if(lacks.begin(), lacks.end(), [&](const Lack& lack) { return lack.requirement == requirement; });
    if (found != lacks.end()) {
        ++found->frames;
    } else {
        lacks.push_back({requirement, 1, frame_id});
    }
}

}  // namespace

VerdictTally tally_of(const std::vector<JudgedFrame>& frames) {
    VerdictTally tally;
    for (const JudgedFrame& frame : frames) {
        ++tally.frames;
        if (frame.verdict == Verdict::kAccept) ++tally.accepts;
        if (frame.verdict == Verdict::kContinue) ++tally.continues;
        if (frame.verdict == Verdict::kLost) ++tally.lost;
        for (const std::string& requirement : frame.missing) add(tally.lacks, requirement, frame.frame_id);
    }
    std::stable_sort(tally.lacks.begin(), tally.lacks.end(),
                     [](const Lack& a, const Lack& b) { return a.frames > b.frames; });
    return tally;
}

std::string title_of(std::string_view requirement) {
    const std::optional<Requirement> known = requirement_of(requirement);
    return known ? words_for(*known).title : std::string(requirement);
}

std::string advice_for(std::string_view requirement) {
    const std::optional<Requirement> known = requirement_of(requirement);
    return known ? words_for(*known).advice : "";
}

Verdict logged_verdict(const data_set::JsonValue& value) {
    const std::string text = value.text();
    std::string known;
    for (const Verdict verdict : {Verdict::kAccept, Verdict::kContinue, Verdict::kLost}) {
        if (text == to_string(verdict)) return verdict;
        known += (known.empty() ? "" : ", ") + std::string(to_string(verdict));
    }
    throw value.error("is \"" + text + "\", but must be one of " + known);
}

}  // namespace nearpose::program
