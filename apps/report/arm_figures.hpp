// Arm and eye: where the frames of a run put the part in the world, and what was concluded of the arm. From the log
// alone.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/report/run_log.hpp"

namespace nearpose::report {

// Where a frame puts the part, against the place of all frames; each with its standard deviation. In the world's axes.
struct PlaceDeviation {
    Eigen::Vector3d shift_mm, sigma_mm;   // of the part's centre
    Eigen::Vector3d turn_deg, sigma_deg;  // rotation vector
};

// The place of all frames: the median of the centre's coordinates, and the rotation that is nearest to the others. Of
// the accepted frames, where there are any.
struct CommonPlace {
    Eigen::Vector3d centre_in_world;
    Eigen::Quaterniond world_from_object;
};

// Nothing where no frame of the log has a place in the world.
std::optional<CommonPlace> common_place(const std::vector<LoggedFrame>& log, const Eigen::Vector3d& centre_in_object);
PlaceDeviation deviation_from(const CommonPlace& common, const PlaceInWorld& place,
                              const Eigen::Vector3d& centre_in_object);

// What a frame's log says against the arm. Of several the first counts.
enum class ArmEvent {
    kNone,
    kRepeated,      // the image is the one before
    kMotion,        // the image moves otherwise than the arm
    kCause,         // a cause was found for which the part seems to move
    kContradicted,  // image and arm contradicted each other in this frame or shortly before
};
ArmEvent event_of(const LoggedFrame& frame);

// What was concluded, a sentence each; each with the last frame where it held.
std::vector<std::string> conclusions(const std::vector<LoggedFrame>& log);

// For the page: `null` where no frame has a place in the world. Else, a frame each (or null): "frames" with shift_mm,
// sigma_mm, turn_deg and sigma_deg, and "events".
nlohmann::ordered_json arm_json(const std::vector<LoggedFrame>& log, const Eigen::Vector3d& centre_in_object);

}  // namespace nearpose::report
