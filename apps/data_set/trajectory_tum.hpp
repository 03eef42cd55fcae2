// Trajectories as TUM rows: "t x y z qx qy qz qw", seconds and metres, 9 decimals, one space between. Rules are evo's.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/base/file_io.hpp"
#include "core/base/pose.hpp"

namespace nearpose::data_set {

struct StampedPose {
    double stamp_s = 0.0;
    Pose pose;
};

// What the rows of a trajectory are.
enum class TrajectoryFrame {
    kCamera,  // camera_from_object
    kObject,  // object_from_camera
    kWorld,   // world_from_object: needs the measured camera motion
};

// "camera", "object" or "world"; throws std::invalid_argument otherwise.
TrajectoryFrame trajectory_frame_of(const std::string& name);

// The pose that a row holds; nullopt for kWorld where the frame lacks its motion.
std::optional<Pose> trajectory_pose(TrajectoryFrame frame, const Pose& camera_from_object,
                                    const std::optional<Pose>& camera_from_world);

class TumWriter {
  public:
    explicit TumWriter(const std::filesystem::path& path);  // "-" is the standard output
    // Throws std::invalid_argument where a number is not finite or the stamp does not grow by its last decimal, and
    // std::runtime_error where the row could not be written.
    void append(double stamp_s, const Pose& pose);
    void close() { file_.close(); }

  private:
    RowFile file_;
    std::optional<double> last_stamp_s_;
};

// Strict, as evo is: throws std::runtime_error naming file, line and cause. Lines that begin with # are comments. evo
// allows a quaternion's length to be off by 1e-5; recordings of four digits need more.
std::vector<StampedPose> read_tum(const std::filesystem::path& path, double max_norm_error = 1e-5);

}  // namespace nearpose::data_set
