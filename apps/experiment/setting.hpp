// The settings of an experiment: what they are called, what they may be, what they are used for.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "apps/data_set/json_file.hpp"

namespace nearpose::experiment {

// Tolerance of the verdict, where nothing else is set: tolerance_mm and tolerance_deg.
inline constexpr double kTolerance_mm = 2.0, kTolerance_deg = 1.0;

// Of the setting fault, where there is none.
inline const std::string kNoFault = "none";

// What the cells of a table are: a recording that an estimator tracks, or the views of a generator by themselves.
enum class TableKind { kRun, kViews };

using Value = std::variant<bool, double, std::string>;
using Settings = std::map<std::string, Value>;

enum class SettingType { kFlag, kWhole, kNumber, kWord };

// In kRun tables: the recording (runs that agree in it share their frames), the estimator, or the figures alone.
enum class SettingUse { kRecording, kEstimator, kFigures, kViews };

struct SettingRule {
    TableKind kind;
    SettingUse use;
    std::string name;  // with its unit; as on the command line of simulate and estimate
    SettingType type;
    double low = 0.0, high = 0.0;         // of numbers
    std::vector<std::string> words = {};  // that a word may be; empty: any
    std::optional<Value> usual = {};      // where it is not set; nothing: as the scenario, sensor or method has it
    // What it is where it is not set, of settings that came later: a value like that is left out of a run's settings,
    // so that runs that were made before still count.
    std::optional<Value> unsaid = {};
};

const std::vector<SettingRule>& setting_rules();

// Throws std::runtime_error naming file, place and the nearest known name.
const SettingRule& rule_of(TableKind kind, const std::string& name, const data_set::JsonValue& value);
// Throws std::runtime_error naming file, place and what it may be.
Value read_value(const SettingRule& rule, const data_set::JsonValue& value);

// With what is usual where nothing is set, and without what goes unsaid.
Settings completed(TableKind kind, Settings settings);
// Those of one use.
Settings used_for(TableKind kind, SettingUse use, const Settings& settings);

// For labels and names of folders: "0.5", "off", "paper".
std::string text_of(const Value& value);
// One line of JSON, the same for equal settings.
std::string json_of(const Settings& settings);
Settings settings_from_json(const data_set::JsonValue& value);

// The setting's value; nothing where it is not set. The type must be that of its rule.
template <typename T>
std::optional<T> setting(const Settings& settings, const std::string& name) {
    const auto found = settings.find(name);
    if (found == settings.end()) return std::nullopt;
    return std::get<T>(found->second);
}

}  // namespace nearpose::experiment
