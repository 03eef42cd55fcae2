// The paper's figure, and whether the covariances can be believed, as curves over the frames of one run or many.
#pragma once

#include <vector>

#include "apps/error_measures/frame_errors.hpp"
#include "apps/pictures/curve_plot.hpp"

namespace nearpose::evaluation {

// Translation and rotation error against the distance of the visible points, their volume, and the visible fraction
// where it is known. Frames without a pose or visibility give nothing. Empty where none is left.
std::vector<pictures::CurvePlot> error_curves(const std::vector<FrameErrors>& frames);

// Share of the frames in which the truth lies inside the region that should hold a share p of it: against p, for all
// frames (its band is the 95 % interval) and by distance; then of the 50, 90 and 99 % regions against the distance
// [mm], where that is known of a frame. Empty where no frame has a covariance.
std::vector<pictures::CurvePlot> calibration_curves(const std::vector<FrameErrors>& frames);

}  // namespace nearpose::evaluation
