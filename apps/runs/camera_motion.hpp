// What the measured poses of a recording's camera give: the control, and where the part is in the world.
#pragma once

#include <optional>

#include "apps/runs/frame_source.hpp"
#include "core/result.hpp"
#include "core/world/arm_check.hpp"
#include "core/world/place_in_world.hpp"

namespace nearpose::program {

// The motion from the frame before, as PoseEstimator::update takes it; nothing where either frame lacks its pose.
std::optional<Pose> control_of(const std::vector<FrameInfo>& frames, std::size_t index);

// Where the frame's pose puts the part, in a set-up whose errors are as `setup` takes them for usual. Nothing where the
// frame has no pose of the part or none of the camera. A frame without a control counts as one at rest.
std::optional<PlaceInWorld> place_of(const std::vector<FrameInfo>& frames, std::size_t index,
                                     const UpdateResult& result, const ArmCheckOptions& setup = {});

}  // namespace nearpose::program
