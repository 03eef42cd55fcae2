#include "apps/data_set/trajectory_tum.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "apps/base/number_text.hpp"
#include "apps/base/text_split.hpp"

namespace nearpose::data_set {
namespace {

constexpr std::uintmax_t kMaxTumBytes = std::uintmax_t{1} << 30;
constexpr int kDecimals = 9;  // evo reads fewer digits of a stamp as equal stamps

StampedPose parse_row(std::string_view line, const std::string& place, double max_norm_error) {
    const std::vector<std::string_view> fields = split(line, ' ');
    if (fields.size() != 8) {
        throw std::runtime_error(place + "must have 8 numbers with one space between, but has " +
                                 std::to_string(fields.size()) + " fields");
    }
    std::array<double, 8> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
        const std::optional<double> value = parse_number(fields[i]);
        if (!value || !std::isfinite(*value)) {
            throw std::runtime_error(place + "\"" + std::string(fields[i]) + "\" is not a finite number");
        }
        v[i] = *value;
    }
    const Eigen::Quaterniond rotation(v[7], v[4], v[5], v[6]);  // w first here, last in the file
    if (std::abs(rotation.norm() - 1.0) > max_norm_error) {
        throw std::runtime_error(place + "the quaternion has length " + format_number(rotation.norm()) +
                                 " instead of 1");
    }
    return {v[0], {rotation.normalized(), {v[1], v[2], v[3]}}};
}

}  // namespace

TrajectoryFrame trajectory_frame_of(const std::string& name) {
    if (name == "camera") return TrajectoryFrame::kCamera;
    if (name == "object") return TrajectoryFrame::kObject;
    if (name == "world") return TrajectoryFrame::kWorld;
    throw std::invalid_argument("trajectory frame is \"" + name + "\", but must be camera, object or world");
}

std::optional<Pose> trajectory_pose(TrajectoryFrame frame, const Pose& camera_from_object,
                                    const std::optional<Pose>& camera_from_world) {
    if (frame == TrajectoryFrame::kCamera) return camera_from_object;
    if (frame == TrajectoryFrame::kObject) return camera_from_object.inverse();
    if (!camera_from_world) return std::nullopt;
    return camera_from_world->inverse() * camera_from_object;
}

TumWriter::TumWriter(const std::filesystem::path& path) : file_(path) {}

void TumWriter::append(double stamp_s, const Pose& pose) {
    const double length = pose.rotation.norm();
    Eigen::Quaterniond q = pose.rotation.normalized();
    if (q.w() < 0.0) q.coeffs() *= -1.0;  // of the two quaternions of one rotation
    if (!(length > 0.5 && length < 2.0) || !std::isfinite(stamp_s) || !q.coeffs().allFinite() ||
        !pose.translation.allFinite()) {
        throw std::invalid_argument("trajectory: a number is not finite, or the rotation is none");
    }
    const std::string stamp = format_fixed(stamp_s, kDecimals);
    const double written_s = parse_number(stamp).value_or(stamp_s);
    if (last_stamp_s_ && !(written_s > *last_stamp_s_)) {
        throw std::invalid_argument("trajectory: stamp " + stamp + " is not later than the one before");
    }
    const Eigen::Vector3d& t = pose.translation;
    std::string row = stamp;
    for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
        row += " " + format_fixed(value, kDecimals);
    }
    file_.append(row + "\n");
    last_stamp_s_ = written_s;
}

std::vector<StampedPose> read_tum(const std::filesystem::path& path, double max_norm_error) {
    const std::string text = read_whole_file(path, kMaxTumBytes);
    std::vector<StampedPose> rows;
    std::size_t number = 0;
    for (const std::string_view line : lines(text)) {
        const std::string place = path.string() + ": line " + std::to_string(++number) + ": ";
        if (!line.empty() && line.front() == '#') continue;
        rows.push_back(parse_row(line, place, max_norm_error));
        const std::size_t last = rows.size() - 1;
        if (last > 0 && !(rows[last].stamp_s > rows[last - 1].stamp_s)) {
            throw std::runtime_error(place + "the stamp is not later than the one before");
        }
    }
    if (rows.empty()) throw std::runtime_error(path.string() + ": has no poses");
    return rows;
}

}  // namespace nearpose::data_set
