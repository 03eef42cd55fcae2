// A simulated recording in memory: what a depth camera on an arm would deliver, frame by frame, with its truth. Written
// to disk by simulate.hpp, tracked on the spot by experiments.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/data_set/bop_writer.hpp"
#include "apps/depth_sensor/sensor_noise.hpp"
#include "apps/depth_sensor/stereo_rig.hpp"
#include "apps/depth_sensor/stereo_sensor.hpp"
#include "apps/scenes/arm.hpp"
#include "apps/scenes/disturbance.hpp"
#include "apps/scenes/fault.hpp"
#include "apps/scenes/mask_errors.hpp"
#include "apps/scenes/scenario.hpp"
#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/base/pose.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::simulate {

// 640 x 480 at a field of view of 56 x 44 degrees.
PinholeCamera default_camera();

struct RecordingOptions {
    Scenario scenario = Scenario::kPiston;
    ScenarioOptions path;
    int num_frames = 0;  // 0: as many as the scenario has by itself
    double frames_per_second = 30.0;
    std::uint64_t seed = 1;
    PinholeCamera camera = default_camera();
    double depth_scale_mm = 0.1;  // millimetres per count: depth is rounded to it
    SensorNoise sensor;           // already scaled
    // Depth by matching infrared images instead; of the sensor above the range alone counts. The camera above is the
    // (left) infrared camera, whatever its size and focal length.
    std::optional<StereoRig> stereo;
    std::string material = "cast_iron";  // of the part and its copies, as the infrared cameras see it
    bool keep_infrared = false;          // in SimulatedFrame::infrared
    ArmErrors arm;
    MaskErrors mask;                // of given_mask
    double dropped_fraction = 0.0;  // of the frames, never the first
    Disturbances disturbances;
    std::vector<Fault> faults;  // in the order in which they act
    bool with_table = true;
    // One of part_names(): its object number goes into the truth, and other built-in parts of the scene are told too.
    // Empty: a part of the user's own, object 1.
    std::string part_name;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const RecordingOptions& options);

// How many frames the path has, and how many of them are delivered: not dropped.
int frames_on_path(const RecordingOptions& options);
int num_delivered(const RecordingOptions& options);

// Another part in the image that the truth speaks of: a copy, or another built-in part.
struct OtherInstance {
    Mask visible;     // exact
    Mask silhouette;  // exact
    data_set::ObjectTruth truth;
};

// With faults depth, given mask, stamp, intrinsics and the arm's pose are as such a set-up delivers them; all else is
// of what the frame should have shown.
struct SimulatedFrame {
    int id = 0;  // place on the path; dropped frames leave gaps
    double stamp_s = 0.0;
    PinholeCamera camera;  // as it is written: RecordingOptions::camera but for faults
    DepthImage depth;      // measured, in whole counts of the depth scale
    // What depth was matched from, where it was and RecordingOptions::keep_infrared asks for it.
    std::optional<InfraredPair> infrared;
    Mask visible;     // exact: pixels that show the part; of a frame of nonsense: that would
    Mask silhouette;  // exact: pixels whose ray meets the part, also behind others
    // What an estimator is given: `visible` with the mask's errors; without the part, that of what is taken for it.
    Mask given_mask;
    bool nonsense = false;     // the depth is not of the scene
    bool part_moved = false;   // the part lies elsewhere than in the first frame
    bool after_fault = false;  // the recording had a fault, and has none from here on
    Pose camera_from_object;
    Pose camera_from_world;  // as the arm reports it, with its errors
    data_set::ObjectTruth truth;
    std::vector<OtherInstance> others;

    bool shows_part() const { return !nonsense && truth.visible_pixels > 0; }
};

// Draws the path, the sensor and the arm when it is constructed. Immutable; frame may be called from several threads at
// once, and the same options give the same bits whatever was asked before. Where remembers_images() holds, a frame that
// is not asked for after the one before it takes the time of all before it.
class Recording {
  public:
    Recording(const Mesh& mesh, const Part& part, const RecordingOptions& options);
    ~Recording();
    Recording(Recording&&) noexcept;

    int num_frames() const;  // without the dropped ones
    SimulatedFrame frame(int index) const;

    const RecordingOptions& options() const;
    const ModelExtent& extent() const;  // of the part

  private:
    struct Impl;
    std::unique_ptr<const Impl> impl_;
};

}  // namespace nearpose::simulate
