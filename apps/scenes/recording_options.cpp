// What a recording is asked for: its defaults and bounds.
#include <stdexcept>

#include "apps/scenes/delivery.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"
#include "core/base/check.hpp"

namespace nearpose::simulate {
namespace {

constexpr int kMaxFrames = 100'000;

}  // namespace

PinholeCamera default_camera() {
    return {640, 480, 600.0, 600.0, 319.5, 239.5};
}

int frames_on_path(const RecordingOptions& options) {
    return options.num_frames == 0 ? default_frames(options.scenario) : options.num_frames;
}

int num_delivered(const RecordingOptions& options) {
    return static_cast<int>(
        delivery_of(frames_on_path(options), options.dropped_fraction, options.faults, options.seed).ids.size());
}

void validate(const RecordingOptions& options) {
    check_option("frames", frames_on_path(options), 1, kMaxFrames);
    check_option("frames per second", options.frames_per_second, 0.001, 1e4);
    // A depth of the least range must not round to 0 counts, which means no depth.
    check_option("depth scale [mm]", options.depth_scale_mm, 1e-4, options.sensor.min_range_m * 1e3);
    check_option("fraction of dropped frames", options.dropped_fraction, 0.0, 0.95);
    if (!options.part_name.empty()) object_id_of(options.part_name);  // throws for a part that is not built in
    validate(options.camera);
    validate(options.path, options.scenario);
    validate(options.sensor);
    material_of(options.material);
    if (options.stereo) {
        validate(*options.stereo);
        require_stereo();
        if (options.disturbances.scene == SceneContent::kConstant)
            throw std::invalid_argument("the scene 'constant' has no infrared images: take a sensor without stereo");
    }
    validate(options.arm);
    validate(options.mask);
    validate(options.faults, {options.camera, options.scenario, frames_on_path(options), options.disturbances});
    const int delivered = num_delivered(options);
    if (delivered == 0) throw std::invalid_argument("the fault dropped leaves no frame: give it fewer frames");
    validate(options.disturbances, options.scenario, frames_on_path(options), delivered);
}

}  // namespace nearpose::simulate
