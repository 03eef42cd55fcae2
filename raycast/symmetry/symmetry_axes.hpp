// Axes about which a part may be symmetric.
#pragma once

#include <vector>

#include "core/shape/symmetry.hpp"
#include "raycast/symmetry/self_similarity.hpp"

namespace nearpose {

struct CandidateAxes {
    std::vector<AxisOfRevolution> axes;
    // Dihedral axes: perpendiculars of theirs, in any direction, may be axes of half turns.
    std::vector<AxisOfRevolution> dihedral_axes;
};

// The axes of the model's box and the principal axes of the surface that is seen. Where all principal moments are equal
// (a cube), also those that the directions of its faces suggest. Each passes through the surface's centroid or the
// centre of the box.
CandidateAxes candidate_axes(const ViewsAround& around, const CandidateAxisOptions& options);

}  // namespace nearpose
