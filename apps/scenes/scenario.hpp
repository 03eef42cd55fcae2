// Simulated tasks: how a camera moves around a part, and the part under a camera, drawn from a seed.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "apps/data_set/trajectory_tum.hpp"
#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "core/view_generator.hpp"

namespace nearpose::simulate {

enum class Scenario {
    kBaseline,   // the camera stands still and has the whole part in view
    kPiston,     // the camera comes down to a bore in the part's upper face, as for an insertion
    kCrankcase,  // the same onto the underside: the part lies on its upper face
    kSweep,      // straight down to a point of the surface, without turning
    kConveyor,   // the camera stands still, the part moves and turns steadily
    kHandheld,   // the camera is carried by a hand
    kClutter,    // slowly around the part, among boxes and another part; a gripper occludes
    kBin,        // slowly around one of several copies that touch
};

// What scenarios may be told beside their seed; what is not set is drawn, or the scenario's own. Only of the scenarios
// that are named.
struct ScenarioOptions {
    std::optional<double> far_m, near_m;    // piston, crankcase, sweep: first and last distance, for a part of any size
    std::optional<double> conveyor_step_m;  // conveyor: way of the part's centre from frame to frame
    std::optional<double> conveyor_turn_rad;        // conveyor: about the vertical, from frame to frame
    std::optional<double> occlusion;                // clutter: fraction of the silhouette, in the frame with the most
    std::vector<data_set::StampedPose> trajectory;  // handheld: world_from_camera; empty: a made-up hand
};

// Throws std::invalid_argument naming field, value and bound, or that the scenario has no such option.
void validate(const ScenarioOptions& options, Scenario scenario);

// By the names of scenario_names(); throws std::invalid_argument that lists them otherwise.
Scenario scenario_of(const std::string& name);
const std::vector<std::string>& scenario_names();
const std::string& name_of(Scenario scenario);
int default_frames(Scenario scenario);

// What a path must know of the part. Object frame, [m]; z is up, and the part stands on its lowest point.
struct Part {
    ModelExtent extent;
    double deck_z_m = 0.0;                             // height of the upper face
    std::vector<Eigen::Vector3d> targets_in_object_m;  // points of the upper face that an approach may aim at
    // Points of the underside for crankcase; empty: spread over the bottom of the box.
    std::vector<Eigen::Vector3d> underside_targets_in_object_m = {};
    // Points of the surface, seen from above, for sweep; empty: the targets above.
    std::vector<Eigen::Vector3d> surface_points_in_object_m = {};
};

// The deck, bores and bearing saddles of the embedded engine block.
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
inline constexpr double kSweepFar_m = 0.60, kSweepNear_m = 0.10;  // for a part of the engine block's size
inline constexpr double kMaxSweepTilt_rad = 0.26;                 // 15 degrees
inline constexpr double kMaxConveyorStep_m = 0.010, kMaxConveyorTurn_rad = 0.0174532925199432958;  // that are drawn
inline constexpr double kMinOcclusion = 0.2, kMaxOcclusion = 0.5;                                  //

// Where the camera and the part are in every frame. The scene frame is fixed to the table: it is the object's own where
// the part stands still, and where the part is half-way on a conveyor.
struct TaskPath {
    std::vector<Pose> camera_from_object;
    std::vector<Pose> camera_from_scene;
    Pose scene_from_ground;  // ground: z up, origin on the table below the centre of the part
};

// Throws std::invalid_argument for less than one frame, an invalid camera or option, a camera that cannot have the
// whole part in view (baseline, conveyor, clutter, bin), and a trajectory that is shorter than the frames (handheld).
TaskPath task_path(Scenario scenario, const Part& part, const PinholeCamera& camera, int num_frames, std::uint64_t seed,
                   const ScenarioOptions& options = {}, double frames_per_second = 30.0);

}  // namespace nearpose::simulate
