// BOP result files: scene_id,im_id,obj_id,score,R,t,time. Rules are those of bop_toolkit's own parser.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/base/file_io.hpp"
#include "core/base/pose.hpp"

namespace nearpose::data_set {

struct PoseRow {
    int scene_id = 0;
    int image_id = 0;
    int object_id = 0;
    double score = 0.0;  // larger is better
    Pose camera_from_object;
    double time_s = -1.0;  // wall time of the whole image, -1 where it is not known
};

// Writes the header at once and each row as a whole when it is known. "-" is the standard output.
class PoseCsvWriter {
  public:
    explicit PoseCsvWriter(const std::filesystem::path& path);
    // Throws std::invalid_argument for a number that is not finite (bop_toolkit would read it and spoil its matching),
    // and std::runtime_error where the row could not be written.
    void append(const PoseRow& row);
    void close() { file_.close(); }

  private:
    RowFile file_;
};

// Strict, as bop_toolkit is, and stricter for NaN. Throws std::runtime_error naming file, line and cause.
std::vector<PoseRow> read_pose_csv(const std::filesystem::path& path);

// bop_toolkit takes method, data set and split from the file's name: METHOD_DATASET-SPLIT[-TYPE][_ID].csv. For a name
// that it could not parse this is a sentence with one that it could, made with `data_set`; nullopt for a good name and
// for "-".
std::optional<std::string> bop_file_name_notice(const std::filesystem::path& path,
                                                const std::string& data_set = "dataset");

}  // namespace nearpose::data_set
