#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "apps/base/degrees.hpp"
#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/base/text_split.hpp"
#include "apps/error_measures/frame_errors.hpp"
#include "apps/error_measures/verdict_counts.hpp"

namespace nearpose::evaluation {
namespace {

constexpr int kDecimals = 8;
constexpr std::uintmax_t kMaxTableBytes = std::uintmax_t{1} << 30;

// One column: where its value lies, and how many of its units are one of ours. A null place: this frame has none.
struct Column {
    const char* name;
    double units;
    bool of_pose;  // known where there is a pose
    double* (*place)(FrameErrors& frame, bool make);
};

// Where the value of an optional is; with `make` it is given one first.
template <typename Value>
Value* inside(std::optional<Value>& value, bool make) {
    if (make && !value) value.emplace();
    return value ? &*value : nullptr;
}

#define OF_POSE(expression) [](FrameErrors& f, bool) -> double* { return f.errors ? &(f.errors->expression) : nullptr; }
#define OF_COVARIANCE(member) \
    [](FrameErrors& f, bool make) -> double* { return f.errors ? inside(f.errors->member, make) : nullptr; }

constexpr std::array kColumns = {
    Column{"translation_error_mm", 1e3, true, OF_POSE(translation_m)},
    Column{"rotation_error_deg", kDegrees, true, OF_POSE(rotation_rad)},
    Column{"translation_x_mm", 1e3, true, OF_POSE(translation_in_camera_m.x())},
    Column{"translation_y_mm", 1e3, true, OF_POSE(translation_in_camera_m.y())},
    Column{"translation_z_mm", 1e3, true, OF_POSE(translation_in_camera_m.z())},
    Column{"rotation_x_deg", kDegrees, true, OF_POSE(rotation_in_camera_rad.x())},
    Column{"rotation_y_deg", kDegrees, true, OF_POSE(rotation_in_camera_rad.y())},
    Column{"rotation_z_deg", kDegrees, true, OF_POSE(rotation_in_camera_rad.z())},
    Column{"add_mm", 1e3, true, OF_POSE(add_m)},
    Column{"add_s_mm", 1e3, true, OF_POSE(add_s_m)},
    Column{"mssd_mm", 1e3, true, OF_POSE(mssd_m)},
    Column{"mspd_px", 1.0, true, OF_POSE(mspd_px)},
    Column{"mahalanobis_squared", 1.0, false, OF_COVARIANCE(mahalanobis_squared)},
    Column{"mahalanobis_rotation_squared", 1.0, false, OF_COVARIANCE(mahalanobis_rotation_squared)},
    Column{"mahalanobis_translation_squared", 1.0, false, OF_COVARIANCE(mahalanobis_translation_squared)},
    Column{"score", 1.0, true, [](FrameErrors& f, bool) { return f.errors ? &f.score : nullptr; }},
    Column{"time_ms", 1e3, false,
           [](FrameErrors& f, bool make) { return make || f.time_s >= 0.0 ? &f.time_s : nullptr; }},
    Column{"distance_mm", 1e3, false,
           [](FrameErrors& f, bool make) {
               Visibility* visibility = inside(f.visibility, make);
               return visibility ? &visibility->distance_m : nullptr;
           }},
    Column{"visible_volume_mm3", 1e9, false,
           [](FrameErrors& f, bool) { return f.visibility ? &f.visibility->visible_volume_m3 : nullptr; }},
    Column{"visible_fraction", 1.0, false,
           [](FrameErrors& f, bool make) {
               return f.visibility ? inside(f.visibility->visible_fraction, make) : nullptr;
           }},
};

#undef OF_POSE
#undef OF_COVARIANCE

// The words of columns that hold one, in the order of their enumerations.
constexpr std::array kVerdicts = {"accept", "continue", "lost"};
constexpr std::array kShown = {"part", "nothing", "nonsense"};

constexpr std::size_t kFirst = 2;  // columns before those of numbers
constexpr std::size_t kOldFields = kFirst + kColumns.size(), kFields = kOldFields + 3, kJudgedFields = kFields + 1;

// Of tables from before there were verdicts.
std::string old_header() {
    std::string text = "im_id,predicted";
    for (const Column& column : kColumns) text += std::string(",") + column.name;
    return text;
}

std::string header() {
    return old_header() + ",verdict,shown,part_moved";
}

// Of tables that say which verdicts are wrong.
std::string judged_header() {
    return header() + ",verdict_error";
}

std::string verdict_error(const FrameErrors& frame, const Tolerance& tolerance) {
    if (is_false_accept(frame, tolerance)) return "false_accept";
    return is_missed(frame, tolerance) ? "missed" : "";
}

// A cell of the file, with what is needed to say where it is.
struct Cell {
    const std::filesystem::path& path;
    std::size_t line;
    std::string column;
    std::string_view text;

    std::runtime_error error(const std::string& problem) const {
        return std::runtime_error(path.string() + ": line " + std::to_string(line) + ": " + column + " " + problem);
    }
    int integer() const {
        const std::optional<std::int64_t> value = data_set::parse_integer(text);
        if (!value || *value < 0 || *value > std::numeric_limits<int>::max()) {
            throw error("is \"" + std::string(text) + "\", but must be a whole number");
        }
        return static_cast<int>(*value);
    }
    double number() const {
        const std::optional<double> value = data_set::parse_number(text);
        if (!value || std::isnan(*value)) throw error("is \"" + std::string(text) + "\", but must be a number");
        return *value;
    }
    bool flag() const {
        if (text != "0" && text != "1") throw error("must be 0 or 1");
        return text == "1";
    }
    // Its place among `words`.
    template <std::size_t N>
    int word(const std::array<const char*, N>& words) const {
        std::string known;
        for (std::size_t i = 0; i < N; ++i) {
            if (text == words[i]) return static_cast<int>(i);
            known += (i == 0 ? "" : ", ") + std::string(words[i]);
        }
        throw error("is \"" + std::string(text) + "\", but must be one of " + known);
    }
};

void read_words(const std::filesystem::path& path, std::size_t line, const std::vector<std::string_view>& fields,
                FrameErrors& frame) {
    const Cell verdict{path, line, "verdict", fields[kOldFields]};
    if (!verdict.text.empty()) frame.verdict = static_cast<Verdict>(verdict.word(kVerdicts));
    frame.shown = static_cast<Shown>(Cell{path, line, "shown", fields[kOldFields + 1]}.word(kShown));
    frame.part_moved = Cell{path, line, "part_moved", fields[kOldFields + 2]}.flag();
}

FrameErrors frame_of(const std::filesystem::path& path, std::size_t line, std::string_view text,
                     std::size_t num_fields) {
    const std::vector<std::string_view> fields = data_set::split(text, ',');
    if (fields.size() != num_fields) {
        throw std::runtime_error(path.string() + ": line " + std::to_string(line) + ": has " +
                                 std::to_string(fields.size()) + " columns instead of " + std::to_string(num_fields));
    }
    FrameErrors frame;
    frame.frame_id = Cell{path, line, "im_id", fields[0]}.integer();
    frame.predicted = Cell{path, line, "predicted", fields[1]}.flag();
    if (!fields[kFirst].empty()) frame.errors.emplace();
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
        const Column& column = kColumns[i];
        const Cell cell{path, line, column.name, fields[i + kFirst]};
        if (cell.text.empty()) {
            if (column.of_pose && frame.errors) throw cell.error("is empty, but the frame has a pose");
            continue;
        }
        double* value = column.place(frame, true);
        if (value == nullptr) throw cell.error("is given, but not what it belongs to");
        *value = cell.number() / column.units;
    }
    if (num_fields != kOldFields) read_words(path, line, fields, frame);
    return frame;
}

}  // namespace

std::string table_of(const std::vector<FrameErrors>& frames, const std::optional<Tolerance>& tolerance) {
    std::string table = (tolerance ? judged_header() : header()) + "\n";
    for (FrameErrors frame : frames) {
        table += std::to_string(frame.frame_id) + (frame.predicted ? ",1" : ",0");
        for (const Column& column : kColumns) {
            const double* value = column.place(frame, false);
            table += ",";
            if (value != nullptr) table += data_set::format_fixed(column.units * *value, kDecimals);
        }
        table += std::string(",") + (frame.verdict ? kVerdicts.at(static_cast<std::size_t>(*frame.verdict)) : "");
        table += std::string(",") + kShown.at(static_cast<std::size_t>(frame.shown));
        table += frame.part_moved ? ",1" : ",0";
        if (tolerance) table += "," + verdict_error(frame, *tolerance);
        table += "\n";
    }
    return table;
}

std::vector<FrameErrors> read_table(const std::filesystem::path& csv) {
    const std::string text = data_set::read_whole_file(csv, kMaxTableBytes);
    std::vector<FrameErrors> frames;
    std::size_t number = 0, num_fields = kFields;
    for (const std::string_view line : data_set::lines(text)) {
        if (++number > 1) {
            frames.push_back(frame_of(csv, number, line, num_fields));
        } else if (line == old_header()) {
            num_fields = kOldFields;
        } else if (line == judged_header()) {
            num_fields = kJudgedFields;
        } else if (line != header()) {
            throw std::runtime_error(csv.string() + ": line 1: is not the header of a table of frames");
        }
    }
    if (number == 0) throw std::runtime_error(csv.string() + ": is empty");
    return frames;
}

}  // namespace nearpose::evaluation
