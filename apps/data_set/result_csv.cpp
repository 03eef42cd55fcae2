#include "apps/data_set/result_csv.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "apps/base/number_text.hpp"
#include "apps/base/text_split.hpp"

namespace nearpose::data_set {
namespace {

constexpr std::string_view kHeader = "scene_id,im_id,obj_id,score,R,t,time";
constexpr std::uintmax_t kMaxCsvBytes = std::uintmax_t{1} << 30;
constexpr double kRowRotationTolerance = 1e-2;  // files of other methods hold few digits

std::string row_text(const PoseRow& row) {
    // Drift from unit length is mended; what is no rotation at all is a fault of the caller, which Eigen would turn
    // into
    // the identity.
    const double length = row.camera_from_object.rotation.norm();
    const Eigen::Matrix3d R = row.camera_from_object.rotation.normalized().toRotationMatrix();
    const Eigen::Vector3d t_mm = row.camera_from_object.translation * 1e3;
    if (!(length > 0.5 && length < 2.0) || !R.allFinite() || !t_mm.allFinite() || !std::isfinite(row.score) ||
        !std::isfinite(row.time_s)) {
        throw std::invalid_argument("result of image " + std::to_string(row.image_id) +
                                    ": a number is not finite, or the rotation is none");
    }
    std::string text = std::to_string(row.scene_id) + "," + std::to_string(row.image_id) + "," +
                       std::to_string(row.object_id) + "," + format_number(row.score);
    for (int i = 0; i < 9; ++i) text += (i == 0 ? "," : " ") + format_number(R(i / 3, i % 3));
    for (int i = 0; i < 3; ++i) text += (i == 0 ? "," : " ") + format_number(t_mm[i]);
    return text + "," + format_number(row.time_s) + "\n";
}

// One line of the file, with what is needed to say what is wrong with it.
class Line {
  public:
    Line(const std::filesystem::path& path, std::size_t number, std::string_view text)
        : place_(path.string() + ": line " + std::to_string(number) + ": "), fields_(split(text, ',')) {
        if (text.empty()) throw error("is blank, which bop_toolkit refuses");
        if (fields_.size() != 7) throw error("has " + std::to_string(fields_.size()) + " fields instead of 7");
    }

    PoseRow row() const {
        PoseRow row;
        row.scene_id = id(0, "scene_id");
        row.image_id = id(1, "im_id");
        row.object_id = id(2, "obj_id");
        row.score = number(fields_[3], "score");
        const std::vector<double> r = numbers(4, "R", 9);
        const std::vector<double> t = numbers(5, "t", 3);
        row.time_s = number(fields_[6], "time");
        Eigen::Matrix3d R;
        R << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
        const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
        if (!(off < kRowRotationTolerance) || R.determinant() < 0.0) throw error("R is not a rotation");
        row.camera_from_object = Pose::from_matrix(R, Eigen::Vector3d(t[0], t[1], t[2]) * 1e-3);
        return row;
    }

    std::runtime_error error(const std::string& problem) const { return std::runtime_error(place_ + problem); }

  private:
    int id(std::size_t field, const std::string& name) const {
        const std::optional<std::int64_t> value = parse_integer(fields_[field]);
        if (value && *value >= 0 && *value <= std::numeric_limits<int>::max()) return static_cast<int>(*value);
        throw error(name + " is \"" + std::string(fields_[field]) + "\", but must be a whole number");
    }

    double number(std::string_view text, const std::string& name) const {
        const std::optional<double> value = parse_number(text);
        if (value && std::isfinite(*value)) return *value;
        throw error(name + " has \"" + std::string(text) + "\", which is not a finite number");
    }

    std::vector<double> numbers(std::size_t field, const std::string& name, std::size_t count) const {
        std::vector<double> values;
        for (const std::string_view word : words(fields_[field])) values.push_back(number(word, name));
        if (values.size() != count) {
            throw error(name + " has " + std::to_string(values.size()) + " numbers instead of " +
                        std::to_string(count));
        }
        return values;
    }

    std::string place_;
    std::vector<std::string_view> fields_;
};

bool is_bop_file_name(const std::filesystem::path& path) {
    const std::string stem = path.stem().string();
    if (path.extension() != ".csv" || stem.find('.') != stem.npos) return false;
    const std::vector<std::string_view> parts = split(stem, '_');
    if (parts.size() < 2 || parts[0].empty()) return false;
    const std::vector<std::string_view> data_set = split(parts[1], '-');
    const bool none_empty =
        std::none_of(data_set.begin(), data_set.end(), [](const auto part) { return part.empty(); });
    return (data_set.size() == 2 || data_set.size() == 3) && none_empty;
}

}  // namespace

PoseCsvWriter::PoseCsvWriter(const std::filesystem::path& path) : file_(path) {
    file_.append(std::string(kHeader) + "\n");
}

void PoseCsvWriter::append(const PoseRow& row) {
    file_.append(row_text(row));
}

std::vector<PoseRow> read_pose_csv(const std::filesystem::path& path) {
    const std::string text = read_whole_file(path, kMaxCsvBytes);
    std::vector<PoseRow> rows;
    std::map<std::pair<int, int>, double> time_of_image;
    std::size_t number = 0;
    for (const std::string_view line : lines(text)) {
        if (++number == 1 && line == kHeader) continue;
        const Line checked(path, number, line);
        rows.push_back(checked.row());
        const PoseRow& row = rows.back();
        const auto [known, is_new] = time_of_image.emplace(std::pair(row.scene_id, row.image_id), row.time_s);
        if (!is_new && std::abs(known->second - row.time_s) > 0.001) {
            throw checked.error("time differs from that of the image's other rows");
        }
    }
    if (rows.empty()) throw std::runtime_error(path.string() + ": has no results");
    return rows;
}

std::optional<std::string> bop_file_name_notice(const std::filesystem::path& path, const std::string& data_set) {
    const std::string given = path.filename().string();
    const bool meant_for_it =
        given.find("-test") != given.npos || given.find("-val") != given.npos || given.find("-train") != given.npos;
    if (!meant_for_it || is_bop_file_name(path)) return std::nullopt;
    std::string name;
    for (const char c : data_set) {
        if (c != '_' && c != '-' && c != '.') name += c;
    }
    if (name.empty()) name = "dataset";
    return given + ": bop_toolkit could not parse this name (METHOD_DATASET-SPLIT.csv); it would take nearpose_" +
           name + "-test.csv";
}

}  // namespace nearpose::data_set
