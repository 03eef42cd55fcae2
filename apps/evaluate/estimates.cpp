#include "apps/evaluate/estimates.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "apps/base/file_io.hpp"
#include "apps/base/text_split.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/json_file.hpp"
#include "apps/data_set/result_csv.hpp"
#include "apps/runs/verdict_tally.hpp"
#include "core/base/parallel.hpp"

namespace nearpose::evaluation {
namespace {

constexpr std::uintmax_t kMaxLogBytes = std::uintmax_t{1} << 30;

std::string listed(const std::set<int>& numbers) {
    std::string text;
    for (const int number : numbers) text += (text.empty() ? "" : ", ") + std::to_string(number);
    return text;
}

// The rows of the scene and the object; there is at least one.
std::vector<data_set::PoseRow> rows_of(const std::filesystem::path& csv, const SceneTruth& truth) {
    std::set<int> scenes, objects;
    std::vector<data_set::PoseRow> rows;
    for (const data_set::PoseRow& row : data_set::read_pose_csv(csv)) {
        scenes.insert(row.scene_id);
        if (row.scene_id != truth.scene.id) continue;
        objects.insert(row.object_id);
        if (row.object_id == truth.object_id) rows.push_back(row);
    }
    if (objects.empty()) {
        throw std::runtime_error(csv.string() + ": has no row of scene " + std::to_string(truth.scene.id) +
                                 ", but of scene " + listed(scenes) + "; --scene-id names another");
    }
    if (rows.empty()) {
        throw std::runtime_error(csv.string() + ": has no row of object " + std::to_string(truth.object_id) +
                                 ", but of object " + listed(objects));
    }
    return rows;
}

Pose logged_pose(const data_set::JsonValue& line) {
    const std::vector<double> t = line.at("translation_m").numbers(3), q = line.at("quaternion_xyzw").numbers(4);
    return {Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized(), {t[0], t[1], t[2]}};
}

// To what the result file's and the log's digits hold.
bool is_same(const Pose& a, const Pose& b) {
    return (a.translation - b.translation).norm() < 1e-6 && angle_between(a.rotation, b.rotation) < 1e-6;
}

void read_first_line(const data_set::JsonValue& line, Estimates& estimates) {
    if (!line.is_object() || !line.find("content") || line.at("content").text() != "nearpose estimate" ||
        line.at("format").integer() != 1) {
        throw line.error("is not the first line of a log of nearpose estimate");
    }
    if (!line.find("tolerance_m") && !line.find("tolerance_rad")) return;
    const auto positive = [&](const char* key) {
        const double value = line.at(key).number();
        if (!(value > 0.0)) throw line.at(key).error("must be above 0");
        return value;
    };
    estimates.tolerance = Tolerance{positive("tolerance_m"), positive("tolerance_rad")};
}

void add_line(const data_set::JsonValue& line, const std::string& results, Estimates& estimates) {
    const data_set::JsonValue frame = line.at("frame");
    const std::string status = line.at("status").text();
    if (const auto verdict = line.find("verdict"))
        estimates.verdicts[frame.integer()] = program::logged_verdict(*verdict);
    const auto estimate = estimates.of_frame.find(frame.integer());
    if (estimate == estimates.of_frame.end() || !line.find("covariance")) return;
    if (!is_same(logged_pose(line), estimate->second.camera_from_object)) {
        throw line.error("the pose of frame " + std::to_string(frame.integer()) + " is not that of " + results +
                         ": the two are of different runs");
    }
    const std::vector<double> numbers = line.at("covariance").numbers(36);
    estimate->second.covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(numbers.data());
    estimate->second.predicted = status == "predicted";
}

}  // namespace

Estimates read_estimates(const std::filesystem::path& results_csv, const SceneTruth& truth) {
    std::set<int> of_scene, with_truth, unknown;
    for (const data_set::Frame& frame : truth.scene.frames) of_scene.insert(frame.id);
    for (const TrueFrame& frame : truth.frames) with_truth.insert(frame.frame_id);
    Estimates estimates;
    estimates.results = results_csv;
    int without_truth = 0, second_rows = 0;
    for (const data_set::PoseRow& row : rows_of(results_csv, truth)) {
        if (!of_scene.contains(row.image_id)) unknown.insert(row.image_id);
        if (truth.frames_left_out.contains(row.image_id)) continue;
        if (!with_truth.contains(row.image_id)) {
            ++without_truth;
            continue;
        }
        const EstimatedFrame estimate{row.camera_from_object, row.score, row.time_s, false, {}, {}};
        const auto [place, added] = estimates.of_frame.emplace(row.image_id, estimate);
        if (!added) ++second_rows;
        if (!added && row.score > place->second.score) place->second = estimate;
    }
    if (!unknown.empty()) {
        throw std::runtime_error(results_csv.string() + ": has image " + listed(unknown) + ", which scene " +
                                 std::to_string(truth.scene.id) + " in " + truth.scene.folder.string() + " lacks");
    }
    if (without_truth > 0) {
        estimates.notices.push_back(results_csv.string() + ": " + std::to_string(without_truth) +
                                    " rows are of frames without a true pose of the object and do not count");
    }
    if (second_rows > 0) {
        estimates.notices.push_back(results_csv.string() + ": " + std::to_string(second_rows) +
                                    " rows are further ones of their frame; the highest score counts");
    }
    return estimates;
}

void add_log(const std::filesystem::path& log_jsonl, Estimates& estimates) {
    const std::string text = data_set::read_whole_file(log_jsonl, kMaxLogBytes);
    std::size_t number = 0;
    for (const std::string_view line : data_set::lines(text)) {
        ++number;
        const std::string name = log_jsonl.string() + ": line " + std::to_string(number);
        const data_set::JsonFile json = data_set::JsonFile::from_text(std::string(line), name);
        if (number > 1) {
            add_line(json.root(), estimates.results.string(), estimates);
        } else {
            read_first_line(json.root(), estimates);
        }
    }
    if (number == 0) throw std::runtime_error(log_jsonl.string() + ": is empty");
}

std::vector<FrameErrors> errors_of(const SceneTruth& truth, const Estimates& estimates, const ModelShape& shape) {
    std::vector<FrameErrors> frames(truth.frames.size());
    parallel_for(static_cast<int>(frames.size()), 0, [&](int i) {
        const auto index = static_cast<std::size_t>(i);
        const auto found = estimates.of_frame.find(truth.frames[index].frame_id);
        std::optional<EstimatedFrame> estimate;
        if (found != estimates.of_frame.end()) estimate = found->second;
        FrameErrors& frame = frames[index];
        frame = frame_errors(truth.frames[index], estimate, shape, truth.images[index].camera);
        const auto verdict = estimates.verdicts.find(frame.frame_id);
        if (verdict != estimates.verdicts.end()) frame.verdict = verdict->second;
    });
    return frames;
}

}  // namespace nearpose::evaluation
