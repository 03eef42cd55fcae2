#include "apps/data_set/pose_file.hpp"

#include "apps/data_set/bop_pose.hpp"
#include "apps/data_set/json_file.hpp"

namespace nearpose::program {

Pose read_pose_file(const std::filesystem::path& path) {
    const data_set::JsonFile file(path);
    const data_set::JsonValue root = file.root();
    const bool short_keys = root.is_object() && root.find("R") && !root.find("cam_R_m2c");
    const Pose pose =
        short_keys ? data_set::read_bop_pose(root, "R", "t") : data_set::read_bop_pose(root, "cam_R_m2c", "cam_t_m2c");
    if (!is_valid(pose)) throw root.error("is no pose that a camera could see");
    return pose;
}

}  // namespace nearpose::program
