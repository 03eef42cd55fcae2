#include "apps/scenes/fault.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "apps/base/nearest_word.hpp"
#include "apps/base/number_text.hpp"

namespace nearpose::simulate {
namespace {

std::string with_value(const FaultRule& rule) {
    return *rule.value == '\0' ? std::string(rule.name) : std::string(rule.name) + ":" + rule.value;
}

const FaultRule& rule_named(const std::string& name) {
    std::vector<std::string> names;
    std::string known;
    for (const FaultRule& rule : fault_rules()) {
        if (name == rule.name) return rule;
        names.emplace_back(rule.name);
        known += (known.empty() ? "" : ", ") + with_value(rule) + " (" + rule.meaning + ")";
    }
    throw std::invalid_argument("'" + name + "' is no fault; did you mean " + program::nearest_word(name, names) +
                                "? There are: " + known);
}

double value_of(const FaultRule& rule, const std::string& text) {
    const std::string name = rule.name;
    if (*rule.value == '\0')
        throw std::invalid_argument("the fault " + name + " (" + rule.meaning +
                                    ") takes no value: leave out ':" + text + "'");
    const std::optional<double> value = data_set::parse_number(text);
    const bool fits = value && *value >= rule.low && *value <= rule.high &&
                      (!rule.whole || *value == std::floor(*value)) &&
                      (rule.kind != FaultKind::kRotated || std::fmod(*value, 90.0) == 0.0);
    if (fits) return *value;
    throw std::invalid_argument(
        "the fault " + with_value(rule) + " (" + rule.meaning + ") has '" + text + "', but takes " +
        (rule.kind == FaultKind::kRotated
             ? "90, 180 or 270"
             : (rule.whole ? "a whole number in " : "a number in ") + data_set::format_number(rule.low) + ".." +
                   data_set::format_number(rule.high)));
}

std::invalid_argument bad_frames(const std::string& fault) {
    return std::invalid_argument("the fault '" + fault +
                                 "' must end in the frames that have it: @10-39, @10- (to the end), @20 or @all");
}

int frame_of(const std::string& text, const std::string& fault) {
    const std::optional<std::int64_t> frame = data_set::parse_integer(text);
    if (!frame || *frame < 0 || *frame >= Fault::kToTheEnd) throw bad_frames(fault);
    return static_cast<int>(*frame);
}

void read_frames(const std::string& text, const std::string& fault_text, Fault& fault) {
    if (text == "all") return;
    const std::size_t dash = text.find('-');
    fault.first = frame_of(text.substr(0, dash), fault_text);
    if (dash == std::string::npos) fault.last = fault.first;
    if (dash != std::string::npos && dash + 1 < text.size()) fault.last = frame_of(text.substr(dash + 1), fault_text);
    if (fault.last < fault.first)
        throw std::invalid_argument("the fault '" + fault_text + "' ends before it begins: give the first frame first");
}

bool moves_part(FaultKind kind) {
    return kind == FaultKind::kPushed || kind == FaultKind::kCarried;
}

std::invalid_argument refused(const Fault& fault, const std::string& why) {
    return std::invalid_argument("the fault " + text_of(fault) + " " + why);
}

void check_motion(const Fault& fault, const FaultSetting& setting) {
    const std::string why = std::string("the fault ") + fault.rule().name;
    refuse_moving_parts(why.c_str(), setting.scenario);
    if (setting.disturbances.scene != SceneContent::kPart)
        throw refused(fault, "is of a part that is there: leave out the scene");
    if (setting.disturbances.object_moves) throw refused(fault, "and object_moves both move the part: leave out one");
    if (fault.kind == FaultKind::kPushed && fault.first == 0)
        throw refused(fault, "moves the part before there is a frame: let its frames begin at 1 or later");
}

}  // namespace

const std::vector<FaultRule>& fault_rules() {
    using K = FaultKind;
    static const std::vector<FaultRule> rules = {
        {K::kFrozen, "frozen", "", 0, 0, false,
         "the camera hangs: the image before comes again, while the arm moves on"},
        {K::kRotated, "rotated", "DEGREES", 90, 270, true,
         "the camera is mounted turned; its intrinsics are as before"},
        {K::kMirrored, "mirrored", "", 0, 0, false, "images are flipped, left for right"},
        {K::kShift, "shift", "PIXELS", -1000, 1000, true, "depth is shifted to the right, the mask is not"},
        {K::kEdges, "edges", "PIXELS", 1, 50, true, "near surfaces are grown over farther ones"},
        {K::kRowsMissing, "rows-missing", "", 0, 0, false, "bands of rows, three of ten, have no depth"},
        {K::kSaltPepper, "salt-pepper", "SHARE", 0, 1, false, "pixels have the nearest or the farthest depth"},
        {K::kHoles, "holes", "SHARE", 0, 0.9, false, "round patches have no depth"},
        {K::kHand, "hand", "", 0, 0, false, "a hand and its forearm are between camera and part"},
        {K::kQuantised, "quantised", "MM", 0.001, 1000, false, "depth comes in steps"},
        {K::kWaves, "waves", "MM", 0, 1000, false, "depth has waves of this amplitude across the image"},
        {K::kDepthScale, "depth-scale", "PERCENT", -90, 900, false, "depth is too large by this"},
        {K::kTemporalFilter, "temporal-filter", "ALPHA", 0, 1, false,
         "the camera's filter: ALPHA of the new depth, the rest of the one before"},
        {K::kDecimation, "decimation", "N", 1, 64, true, "one median depth for blocks of N x N pixels"},
        {K::kHoleFilling, "hole-filling", "", 0, 0, false, "holes take the depth to their left"},
        {K::kExposureHoles, "exposure-holes", "SHARE", 0, 1, false, "the brightest pixels have no depth"},
        {K::kPrincipalPoint, "principal-point", "PIXELS", -1000, 1000, false,
         "the written principal point is too far right"},
        {K::kFocal, "focal", "PERCENT", -90, 900, false, "the written focal lengths are too large"},
        {K::kHalfIntrinsics, "half-intrinsics", "", 0, 0, false,
         "the written intrinsics are those of a stream of half the size"},
        {K::kArmInverted, "arm-inverted", "", 0, 0, false, "the inverse of the camera's pose is written"},
        {K::kArmTransposed, "arm-transposed", "", 0, 0, false, "the rotation alone is inverted"},
        {K::kArmLate, "arm-late", "FRAMES", 0, 1000, false, "the arm's pose is that of so many frames before"},
        {K::kArmUnits, "arm-units", "", 0, 0, false, "the arm's translation is in m where mm belong"},
        {K::kArmNoise, "arm-noise", "MM", 0, 1000, false, "the arm's position is noisy, five frames of ten"},
        {K::kArmOutlier, "arm-outlier", "MM", 0, 1e5, false, "the arm's position is off in the first of the frames"},
        {K::kArmFrozen, "arm-frozen", "", 0, 0, false, "the arm's pose before comes again"},
        {K::kHandEye, "hand-eye", "MM", 0, 1000, false, "the calibration between hand and camera is off"},
        {K::kDropped, "dropped", "", 0, 0, false, "frames are lost"},
        {K::kLate, "late", "", 0, 0, false,
         "images are one and a half frame times late: they have the stamp and the arm's pose of then"},
        {K::kDuplicated, "duplicated", "", 0, 0, false,
         "every other frame is the one before once more, with its stamp and the arm's pose"},
        {K::kPushed, "pushed", "MM", 0, 1000, false,
         "no fault: the part is moved in the first of the frames, and the truth follows"},
        {K::kCarried, "carried", "", 0, 0, false,
         "no fault: the part is moved by 2 mm and turned by 0.5 degrees a frame, and the truth follows"},
    };
    return rules;
}

Fault parse_fault(const std::string& text) {
    const std::size_t at = text.find('@');
    const std::string head = text.substr(0, at);
    const std::size_t colon = head.find(':');
    const FaultRule& rule = rule_named(head.substr(0, colon));
    Fault fault;
    fault.kind = rule.kind;
    if (colon != std::string::npos) {
        fault.value = value_of(rule, head.substr(colon + 1));
    } else if (*rule.value != '\0') {
        throw std::invalid_argument("the fault " + std::string(rule.name) + " (" + rule.meaning +
                                    ") needs a value: " + with_value(rule));
    }
    if (at == std::string::npos) throw bad_frames(text);
    read_frames(text.substr(at + 1), text, fault);
    return fault;
}

std::string text_of(const Fault& fault) {
    const FaultRule& rule = fault.rule();
    std::string text = rule.name;
    if (*rule.value != '\0') text += ":" + data_set::format_number(fault.value);
    if (fault.first == 0 && fault.last == Fault::kToTheEnd) return text + "@all";
    text += "@" + std::to_string(fault.first);
    if (fault.last == fault.first) return text;
    return text + "-" + (fault.last == Fault::kToTheEnd ? "" : std::to_string(fault.last));
}

std::string described_faults() {
    constexpr std::size_t kWidth = 26;
    std::string text;
    for (const FaultRule& rule : fault_rules()) {
        std::string line = "  " + with_value(rule);
        line.resize(std::max(line.size() + 1, kWidth), ' ');
        text += line + rule.meaning + "\n";
    }
    return text;
}

void validate(const std::vector<Fault>& faults, const FaultSetting& setting) {
    for (const Fault& fault : faults) {
        const int last = setting.num_frames - 1;
        if (fault.first > last || (fault.last > last && fault.last != Fault::kToTheEnd))
            throw refused(fault, "is beyond the recording, whose frames are 0 to " + std::to_string(last));
        const bool quarter = fault.kind == FaultKind::kRotated && fault.value != 180.0;
        if (quarter && setting.camera.width != setting.camera.height)
            throw refused(fault, "needs an image as wide as it is high, not " + std::to_string(setting.camera.width) +
                                     " x " + std::to_string(setting.camera.height) +
                                     ": take rotated:180, or another camera");
        if (moves_part(fault.kind)) check_motion(fault, setting);
    }
}

bool remembers_images(const std::vector<Fault>& faults) {
    return std::any_of(faults.begin(), faults.end(),
                       [](const Fault& fault) { return fault.kind == FaultKind::kTemporalFilter; });
}

}  // namespace nearpose::simulate
