#include "apps/experiment/setting.hpp"

#include <cmath>

#include "apps/base/nearest_word.hpp"
#include "apps/base/number_text.hpp"
#include "apps/depth_sensor/stereo_rig.hpp"
#include "apps/experiment/cad_error.hpp"
#include "apps/runs/estimator_setup.hpp"
#include "apps/scenes/disturbance.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/scenario.hpp"
#include "apps/view_quality/view_cell.hpp"

namespace nearpose::experiment {
namespace {

using Words = std::vector<std::string>;

const Words kUnits = {"m", "mm", "cm", "in"};

void add_recording_rules(std::vector<SettingRule>& rules) {
    constexpr TableKind kKind = TableKind::kRun;
    constexpr SettingUse kUse = SettingUse::kRecording;
    const auto add_word = [&](const char* name, Words words, std::optional<Value> usual = {}) {
        rules.push_back({kKind, kUse, name, SettingType::kWord, 0.0, 0.0, std::move(words), std::move(usual)});
    };
    const auto add_number = [&](const char* name, double low, double high, std::optional<Value> usual = {}) {
        rules.push_back({kKind, kUse, name, SettingType::kNumber, low, high, {}, std::move(usual)});
    };
    const auto add_whole = [&](const char* name, double low, double high, std::optional<Value> usual = {}) {
        rules.push_back({kKind, kUse, name, SettingType::kWhole, low, high, {}, std::move(usual)});
    };
    add_word("scenario", simulate::scenario_names(), "piston");
    add_word("part", simulate::part_names(), "engine_block");
    add_word("model", {});  // a file, instead of a built-in part
    add_word("unit", kUnits);
    add_word("trajectory", {});
    add_word("sensor", {});
    add_whole("frames", 1, 100'000);
    add_number("fps", 0.001, 1e4, 30.0);
    add_whole("image_scale", 1, 64, 1.0);  // divides the image's sides and the focal lengths
    add_number("noise_scale", 0.0, 100.0, 1.0);
    rules.push_back({kKind, kUse, "table", SettingType::kFlag, 0.0, 0.0, {}, true});
    add_whole("mask_grow", -1000, 1000, 0.0);
    add_whole("mask_bleed", 0, 1000, 0.0);
    add_number("dropped", 0.0, 0.95, 0.0);
    add_number("arm_mm", 0.0, 1000.0, 0.1);
    add_number("arm_deg", 0.0, 45.0, 0.02);
    add_number("hand_eye_mm", 0.0, 1000.0, 0.0);
    add_number("hand_eye_deg", 0.0, 45.0, 0.0);
    add_number("time_offset_ms", -10000.0, 10000.0, 0.0);
    add_number("occlusion", 0.0, simulate::kMaxOcclusion);
    add_number("conveyor_mm", 0.0, 1000.0);
    add_number("conveyor_deg", 0.0, 28.0);
    add_number("near_mm", 1.0, 1e5);
    add_number("far_mm", 1.0, 1e5);
    const auto add_later = [&](const char* name, SettingType type, double high, Words words, Value unsaid) {
        rules.push_back({kKind, kUse, name, type, 0.0, high, std::move(words), {}, std::move(unsaid)});
    };
    add_later("scene", SettingType::kWord, 0.0, simulate::scene_content_names(), "part");
    add_later("material", SettingType::kWord, 0.0, simulate::material_names(), "cast_iron");
    add_later("nonsense_frames", SettingType::kWhole, 1e5, {}, 0.0);
    add_later("look_away", SettingType::kWhole, 1e5, {}, 0.0);  // frames
    add_later("object_moves", SettingType::kFlag, 0.0, {}, false);
    add_later("fault", SettingType::kWord, 0.0, {}, kNoFault);  // as `simulate --fault` takes it
}

void add_estimator_rules(std::vector<SettingRule>& rules) {
    const auto add = [&](const char* name, SettingType type, double low, double high, Words words,
                         std::optional<Value> usual) {
        rules.push_back({TableKind::kRun, SettingUse::kEstimator, name, type, low, high, std::move(words), usual});
    };
    const program::EstimatorSetup usual;
    add("method", SettingType::kWord, 0, 0, program::method_names(), usual.method);
    add("views", SettingType::kWord, 0, 0, program::view_names(), usual.views);
    add("particles", SettingType::kWhole, 1, 1e6, {}, static_cast<double>(usual.particles));
    add("rounds", SettingType::kWhole, 0, 100, {}, {});
    add("consensus_draws", SettingType::kWhole, 0, 100'000, {}, {});
    add("overlap", SettingType::kFlag, 0, 0, {}, {});
    add("residual", SettingType::kWord, 0, 0, program::residual_names(), {});
    add("gradient", SettingType::kFlag, 0, 0, {}, usual.gradient);
    add("view_samples", SettingType::kWhole, 1, 1e8, {}, {});
    add("mask", SettingType::kFlag, 0, 0, {}, usual.use_mask);
    add("control", SettingType::kFlag, 0, 0, {}, usual.use_control);
    const auto add_later = [&](const char* name, SettingType type, double low, double high, Words words, Value unsaid) {
        rules.push_back({TableKind::kRun, SettingUse::kEstimator, name, type, low, high, std::move(words), {}, unsaid});
    };
    add_later("without", SettingType::kWord, 0, 0, program::parts_of_method(), "nothing");
    // What the tracker believes of the part, while the truth's mesh stays what it is.
    add_later("cad", SettingType::kWord, 0, 0, cad_words(), "true");
    // truth: it is started at the true pose before every frame, which is what a fit can reach with this sensor.
    add_later("start", SettingType::kWord, 0, 0, {"none", "truth"}, "none");
    add_later("tolerance_mm", SettingType::kNumber, 1e-3, 1e3, {}, kTolerance_mm);
    add_later("tolerance_deg", SettingType::kNumber, 1e-3, 180.0, {}, kTolerance_deg);
    // Frames at the beginning that the errors leave out. Only the figures depend on it.
    rules.push_back({TableKind::kRun, SettingUse::kFigures, "burn_in", SettingType::kWhole, 0, 1e5, {}, 15.0});
}

void add_view_rules(std::vector<SettingRule>& rules) {
    const auto add = [&](const char* name, SettingType type, double low, double high, Words words,
                         std::optional<Value> usual) {
        rules.push_back({TableKind::kViews, SettingUse::kViews, name, type, low, high, std::move(words), usual});
    };
    const compare::ViewCell usual;
    add("part", SettingType::kWord, 0, 0, simulate::part_names(), "engine_block");
    add("model", SettingType::kWord, 0, 0, {}, {});
    add("unit", SettingType::kWord, 0, 0, kUnits, {});
    add("views", SettingType::kWord, 0, 0, program::view_names(), usual.views);
    add("view_samples", SettingType::kWhole, 1, 1e8, {}, static_cast<double>(usual.view_samples));
    add("distance_mm", SettingType::kNumber, 1.0, 1e5, {}, usual.distance_mm);
    add("max_rays", SettingType::kWhole, 1, 1e7, {}, static_cast<double>(usual.max_rays));
    add("timed_views", SettingType::kWhole, 0, 1e6, {}, static_cast<double>(usual.timed_views));
}

std::string joined(const Words& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

double read_number(const SettingRule& rule, const data_set::JsonValue& value) {
    const double number = rule.type == SettingType::kWhole ? value.integer() : value.number();
    if (number >= rule.low && number <= rule.high) return number;
    throw value.error("is " + text_of(number) + ", but must be in " + text_of(rule.low) + ".." + text_of(rule.high));
}

}  // namespace

const std::vector<SettingRule>& setting_rules() {
    static const std::vector<SettingRule> rules = [] {
        std::vector<SettingRule> made;
        add_recording_rules(made);
        add_estimator_rules(made);
        add_view_rules(made);
        return made;
    }();
    return rules;
}

const SettingRule& rule_of(TableKind kind, const std::string& name, const data_set::JsonValue& value) {
    Words known;
    for (const SettingRule& rule : setting_rules()) {
        if (rule.kind != kind) continue;
        if (rule.name == name) return rule;
        known.push_back(rule.name);
    }
    throw value.error("is no setting of such a table; did you mean " + program::nearest_word(name, known) + "?");
}

Value read_value(const SettingRule& rule, const data_set::JsonValue& value) {
    if (rule.type == SettingType::kFlag) return value.flag();
    if (rule.type != SettingType::kWord) return read_number(rule, value);
    const std::string word = value.text();
    if (word.empty()) throw value.error("is empty");
    if (rule.words.empty()) return word;
    for (const std::string& known : rule.words) {
        if (word == known) return word;
    }
    throw value.error("is " + word + ", but must be one of " + joined(rule.words) + "; did you mean " +
                      program::nearest_word(word, rule.words) + "?");
}

Settings completed(TableKind kind, Settings settings) {
    for (const SettingRule& rule : setting_rules()) {
        if (rule.kind != kind) continue;
        const auto found = settings.find(rule.name);
        if (rule.unsaid && found != settings.end() && found->second == *rule.unsaid) settings.erase(found);
        if (!rule.usual) continue;
        if (rule.name == "part" && settings.count("model") != 0) continue;
        settings.emplace(rule.name, *rule.usual);
    }
    return settings;
}

Settings used_for(TableKind kind, SettingUse use, const Settings& settings) {
    Settings used;
    for (const SettingRule& rule : setting_rules()) {
        const auto found = settings.find(rule.name);
        if (rule.kind == kind && rule.use == use && found != settings.end()) used.insert(*found);
    }
    return used;
}

std::string text_of(const Value& value) {
    if (const bool* flag = std::get_if<bool>(&value)) return *flag ? "on" : "off";
    if (const double* number = std::get_if<double>(&value)) {
        const bool whole = std::abs(*number) < 1e15 && *number == std::floor(*number);
        return whole ? std::to_string(static_cast<long long>(*number)) : data_set::format_number(*number);
    }
    return std::get<std::string>(value);
}

std::string json_of(const Settings& settings) {
    std::string text;
    for (const auto& [name, value] : settings) {
        text += (text.empty() ? "" : ", ") + data_set::json_string(name) + ": ";
        if (const bool* flag = std::get_if<bool>(&value))
            text += *flag ? "true" : "false";
        else if (std::holds_alternative<double>(value))
            text += text_of(value);
        else
            text += data_set::json_string(std::get<std::string>(value));
    }
    return "{" + text + "}";
}

Settings settings_from_json(const data_set::JsonValue& value) {
    Settings settings;
    for (const auto& [name, member] : value.members()) {
        if (member.is_number())
            settings.emplace(name, member.number());
        else if (member.is_string())
            settings.emplace(name, member.text());
        else
            settings.emplace(name, member.flag());
    }
    return settings;
}

}  // namespace nearpose::experiment
