// What goes wrong in a recording beside noise: nonsense instead of a depth image, a part that is out of view for a
// while, is put down elsewhere, or never was there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/depth_sensor/sensor_noise.hpp"
#include "apps/scenes/scenario.hpp"
#include "apps/scenes/scene.hpp"
#include "core/base/depth_image.hpp"

namespace nearpose::simulate {

enum class SceneContent {
    kPart,
    kEmpty,     // the table without the part
    kOther,     // another part in its place
    kWall,      // a plane at the height of the part
    kCorner,    // that plane and another across it
    kConstant,  // the same depth in every pixel
};

// By the names of scene_content_names(), which are in the enum's order. Throws std::invalid_argument that lists them.
SceneContent scene_content_of(const std::string& name);
const std::vector<std::string>& scene_content_names();

// All but nonsense need a part that stands still by itself and alone: baseline, piston, crankcase, sweep, handheld.
struct Disturbances {
    int nonsense_frames = 0;  // never the first three that are delivered, nor any in which the camera looks away
    int look_away = 0;        // frames in the middle of the run that show the table without the part
    // The part lies elsewhere from the first frame after looking away, or from the middle of the run on.
    bool object_moves = false;
    SceneContent scene = SceneContent::kPart;
};

// Throws std::invalid_argument, which says that `what` needs a still part, unless the scenario has one that is alone.
void refuse_moving_parts(const char* what, Scenario scenario);

// `num_delivered` of the `num_frames` are not dropped. Throws std::invalid_argument naming what is wrong and why.
void validate(const Disturbances& disturbances, Scenario scenario, int num_frames, int num_delivered);

// The frame in the middle of the middle third of a run.
bool looks_away(const Disturbances& disturbances, int frame, int num_frames);
// The first frame in which the part lies elsewhere; nothing where it stays.
std::optional<int> move_frame(const Disturbances& disturbances, int num_frames);

// Frame numbers, ascending, from those that are delivered.
std::vector<int> nonsense_frames(const Disturbances& disturbances, const std::vector<int>& delivered, int num_frames,
                                 std::uint64_t seed);
// What such a frame measures within the sensor's range: with `flat` a wall across the line of sight, else a depth of
// its own in every pixel.
DepthImage nonsense_depth(const PinholeCamera& camera, const SensorNoise& sensor, bool flat, std::uint64_t seed,
                          int frame);

// Where the part is put down, scene_from_moved of a scene in which it was at the identity: turned about the vertical
// through its box's centre by 20 to 160 degrees and shifted along the table by 0.1 to 0.2 of its diameter. Of several
// draws the first of which the frames from `first_frame` on see at least half as many pixels as of the part that stays,
// or else the one of which they see most.
Pose put_down_elsewhere(const Scene& scene, const Part& part, const TaskPath& path, const PinholeCamera& camera,
                        int first_frame, std::uint64_t seed);

// Another part in the tracked one's place.
struct StandIn {
    Mesh mesh;
    Pose scene_from_object;
};
// The flange, or the engine block for the flange; no larger than the tracked part, since the camera comes close. It
// stands on the ground where the camera looks in the last frame, but within the tracked part's box.
StandIn stand_in(const std::string& part_name, const Part& part, const TaskPath& path, std::uint64_t seed);

// A blob where a segmentation takes something else for the part: the ellipse within the box around the mask.
Mask blob_over(const Mask& mask);

}  // namespace nearpose::simulate
