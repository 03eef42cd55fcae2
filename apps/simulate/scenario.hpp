// Camera paths around a part, drawn from a seed.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/camera.hpp"
#include "core/pose.hpp"
#include "core/view_generator.hpp"

namespace nearpose::simulate {

enum class Scenario {
    kBaseline,  // the camera stands still and has the whole part in view
    kPiston,    // the camera comes down to a bore in the part's upper face, as for an insertion
};

// What scenarios may be told beside their seed.
struct ScenarioOptions {};

// "baseline", "piston"; throws std::invalid_argument that lists them otherwise.
Scenario scenario_of(const std::string& name);
const std::vector<std::string>& scenario_names();
int default_frames(Scenario scenario);

// What a path must know of the part. Object frame, [m]; z is up, and the part stands on its lowest point.
struct Part {
    ModelExtent extent;
    double deck_z_m = 0.0;                             // height of the upper face
    std::vector<Eigen::Vector3d> targets_in_object_m;  // points of the upper face that an approach may aim at
};

// The deck and bores of the embedded engine block.
Part engine_block_part(const ModelExtent& extent);
// Any other part: the upper face is the top of its box, with five targets spread over it.
Part box_part(const ModelExtent& extent);

// Numbers of the piston path, for a part of the engine block's size; lengths scale with the part's diameter.
struct ApproachLimits {
    double far_m = 0.60;                // height of the camera over the deck in the first frame
    double near_m = 0.18;               // and in the last
    double min_far_tilt_rad = 0.26;     // angle between the line of sight and the deck's normal, first frame
    double max_far_tilt_rad = 0.70;     //
    double max_near_tilt_rad = 0.10;    // last frame
    double max_far_offset_m = 0.06;     // of the point looked at from the bore, along the deck's x and y
    double max_near_offset_m = 0.015;   //
    double max_swing_rad = 0.7;         // change of the direction from which the camera looks, over the path
    double max_roll_change_rad = 0.35;  // change of the roll about the line of sight, over the path
};

inline constexpr double kReferenceDiameter_m = 0.476508;  // of the box around the engine block
inline constexpr double kBaselineDistance = 1.15;         // from the part's centre, in diameters; more if it must be

// camera_from_object of every frame. Throws std::invalid_argument for less than one frame, an invalid camera, or a
// camera that cannot have the whole part in view (baseline).
std::vector<Pose> camera_path(Scenario scenario, const Part& part, const PinholeCamera& camera, int num_frames,
                              std::uint64_t seed, const ApproachLimits& limits = {});

}  // namespace nearpose::simulate
