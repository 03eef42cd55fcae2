// A recording as it would be with a right set-up.
#pragma once

#include <memory>

#include "apps/runs/frame_source.hpp"
#include "apps/set_up/setup_errors.hpp"

namespace nearpose::program {

// Frames of `given` with intrinsics, depths and the arm's poses corrected. A pose of the time of its image is taken
// between those of two frames, by their stamps; beyond the first and last, with the motion of the nearest two. Where
// stamps do not increase, poses keep their time.
std::unique_ptr<FrameSource> corrected_source(std::shared_ptr<const FrameSource> given, const SetupErrors& errors);

// The usual time between two frames [s]; 0 where no two stamps increase.
double usual_step_s(const FrameSource& source);

}  // namespace nearpose::program
