#include "apps/report/run_log.hpp"

#include <algorithm>
#include <functional>

#include "apps/base/file_io.hpp"
#include "apps/base/text_split.hpp"
#include "apps/data_set/json_file.hpp"
#include "apps/runs/verdict_tally.hpp"
#include "core/world/arm_motion.hpp"

namespace nearpose::report {
namespace {

using data_set::JsonValue;

constexpr std::uintmax_t kMaxLogBytes = std::uintmax_t{2} << 30;

// Calls `take` with each line but the first, which says the format.
void for_each_line(const std::filesystem::path& path, const std::string& content,
                   const std::function<void(const JsonValue&)>& take) {
    const std::string text = data_set::read_whole_file(path, kMaxLogBytes);
    const std::vector<std::string_view> lines = data_set::lines(text);
    if (lines.empty()) throw std::runtime_error(path.string() + ": is empty");
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::string name = path.string() + " line " + std::to_string(i + 1);
        if (i + 1 == lines.size() && text.back() != '\n') {
            throw std::runtime_error(name + ": is cut short; estimate again");
        }
        const auto line = data_set::JsonFile::from_text(std::string(lines[i]), name);
        if (i > 0) {
            take(line.root());
        } else if (line.root().at("format").integer() != 1 || line.root().at("content").text() != content) {
            throw std::runtime_error(name + ": is not format 1 of \"" + content + "\"");
        }
    }
}

Pose pose_of(const JsonValue& line) {
    const std::vector<double> t = line.at("translation_m").numbers(3), q = line.at("quaternion_xyzw").numbers(4);
    Pose pose;
    pose.translation = {t[0], t[1], t[2]};
    const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
    if (std::abs(rotation.norm() - 1.0) > 1e-3) throw line.at("quaternion_xyzw").error("is not of unit length");
    pose.rotation = rotation.normalized();
    return pose;
}

Matrix6d matrix_of(const JsonValue& value) {
    const std::vector<double> numbers = value.numbers(36);
    return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(numbers.data());
}

std::vector<LoggedLack> lacks_of(const JsonValue& line) {
    std::vector<LoggedLack> lacks;
    const std::optional<JsonValue> missing = line.find("missing");
    if (!missing) return lacks;
    for (const JsonValue& lack : missing->elements())
        lacks.push_back({lack.at("requirement").text(), lack.at("text").text()});
    return lacks;
}

LoggedArm arm_of(const JsonValue& value) {
    LoggedArm arm{value.at("moves").text(), value.at("cause").text(), value.at("off_share").number(),
                  value.at("error_bound_m").number()};
    if (arm.moves == to_string(MotionMistake::kNone)) arm.moves.clear();
    if (arm.cause == to_string(Cause::kNone)) arm.cause.clear();
    return arm;
}

LoggedFrame frame_of(const JsonValue& line) {
    LoggedFrame frame;
    frame.frame_id = line.at("frame").integer();
    frame.stamp_s = line.at("stamp_s").number();
    frame.status = line.at("status").text();
    if (const auto error = line.find("error")) frame.error = error->text();
    if (const auto verdict = line.find("verdict")) frame.verdict = program::logged_verdict(*verdict);
    frame.missing = lacks_of(line);
    if (line.find("translation_m")) {
        frame.camera_from_object = pose_of(line);
        frame.covariance = matrix_of(line.at("covariance"));
        frame.score = line.at("score").number();
        if (const auto agreement = line.find("agreement")) frame.agreement = agreement->number();
        frame.cost = line.at("cost").number();
        if (const auto world = line.find("world_from_object"))
            frame.in_world = {pose_of(*world), matrix_of(world->at("covariance"))};
        if (const auto arm = line.find("arm")) frame.arm = arm_of(*arm);
    }
    frame.effective_sample_size = line.at("effective_sample_size").number();
    frame.points_observed = line.at("points_observed").integer();
    frame.resampled = line.at("resampled").flag();
    frame.mode_replaced = line.at("mode_replaced").flag();
    frame.time_s = line.at("time_s").number();
    return frame;
}

}  // namespace

std::vector<LoggedFrame> read_run_log(const std::filesystem::path& log_jsonl) {
    std::vector<LoggedFrame> frames;
    for_each_line(log_jsonl, "nearpose estimate", [&](const JsonValue& line) { frames.push_back(frame_of(line)); });
    if (frames.empty()) throw std::runtime_error(log_jsonl.string() + ": has no frame");
    return frames;
}

std::map<int, std::vector<ParticleRow>> read_particles(const std::filesystem::path& particles_jsonl,
                                                       std::size_t max_particles) {
    std::map<int, std::vector<ParticleRow>> frames;
    for_each_line(particles_jsonl, "nearpose particles", [&](const JsonValue& line) {
        std::vector<ParticleRow>& rows = frames[line.at("frame").integer()];
        for (const JsonValue& particle : line.at("particles").elements()) {
            const std::vector<double> numbers = particle.numbers(std::tuple_size_v<ParticleRow>);
            ParticleRow& row = rows.emplace_back();
            std::transform(numbers.begin(), numbers.end(), row.begin(), [](double x) { return static_cast<float>(x); });
        }
        if (rows.size() <= max_particles) return;
        std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a[7] > b[7]; });
        rows.resize(max_particles);
    });
    return frames;
}

}  // namespace nearpose::report
