// Faults of a set-up that a recording may have: by names, values and the frames in which they are there.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "apps/scenes/disturbance.hpp"
#include "core/base/camera.hpp"

namespace nearpose::simulate {

enum class FaultKind {
    // Of the image.
    kFrozen,
    kRotated,
    kMirrored,
    kShift,
    kEdges,
    kRowsMissing,
    kSaltPepper,
    kHoles,
    kHand,
    kQuantised,
    kWaves,
    kDepthScale,
    kTemporalFilter,
    kDecimation,
    kHoleFilling,
    kExposureHoles,
    // Of the written intrinsics.
    kPrincipalPoint,
    kFocal,
    kHalfIntrinsics,
    // Of the arm's poses.
    kArmInverted,
    kArmTransposed,
    kArmLate,
    kArmUnits,
    kArmNoise,
    kArmOutlier,
    kArmFrozen,
    kHandEye,
    // Of frames and their stamps.
    kDropped,
    kLate,
    kDuplicated,
    // Of the part, which really moves.
    kPushed,
    kCarried,
};

struct FaultRule {
    FaultKind kind;
    const char* name;
    const char* value;             // what the value is called; empty: there is none
    double low = 0.0, high = 0.0;  // of the value
    bool whole = false;
    const char* meaning = "";
};
// In the order of the enumeration.
const std::vector<FaultRule>& fault_rules();

struct Fault {
    static constexpr int kToTheEnd = std::numeric_limits<int>::max();

    FaultKind kind = FaultKind::kFrozen;
    double value = 0.0;               // in the unit of its rule
    int first = 0, last = kToTheEnd;  // frames by their place on the path, both included

    bool is_in(int frame) const { return frame >= first && frame <= last; }
    const FaultRule& rule() const { return fault_rules()[static_cast<std::size_t>(kind)]; }
};

// Of NAME[:VALUE]@FRAMES, with FRAMES as 10-39, 10-, 20 or all. Throws std::invalid_argument of one line, which for an
// unknown name lists all with their meaning.
Fault parse_fault(const std::string& text);
std::string text_of(const Fault& fault);

// One line a fault, for help: "rotated:DEGREES  the camera is ...".
std::string described_faults();

// What a recording with faults is of.
struct FaultSetting {
    PinholeCamera camera;
    Scenario scenario = Scenario::kPiston;
    int num_frames = 0;  // of the path, with those that are dropped
    Disturbances disturbances;
};
// Throws std::invalid_argument for a fault that this recording cannot have, naming it, why, and what to do.
void validate(const std::vector<Fault>& faults, const FaultSetting& setting);

// Whether images depend on those before them, so that frames are best asked for in order.
bool remembers_images(const std::vector<Fault>& faults);

}  // namespace nearpose::simulate
