// Axes about which a part may be symmetric.
#pragma once

#include <vector>

#include "core/symmetry.hpp"
#include "raycast/symmetry/self_similarity.hpp"

namespace nearpose {

struct CandidateAxes {
    std::vector<AxisOfRevolution> axes;
    // Axes whose perpendiculars may be axes of half turns, in any direction.
    std::vector<AxisOfRevolution> spindles;
};

// The axes of the model's box, the principal axes of the surface that can be seen, and where all principal moments are
// alike (a cube) those that the directions of its faces suggest; each through the surface's centroid or the box centre.
CandidateAxes candidate_axes(const ViewsAround& around);

}  // namespace nearpose
