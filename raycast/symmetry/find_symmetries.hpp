// The search for a part's symmetries in views of its model.
#pragma once

#include "core/symmetry.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// Looks for them in views of the model from all around. `resolution_m` is what the sensor can tell apart: surfaces that
// lie closer count as the same, and so do details narrower than that. The views must be exact (ray casting); those of
// rasterised samples have holes, which are no symmetry. Throws std::invalid_argument where `resolution_m` is not
// positive.
Symmetries find_symmetries(const ViewGenerator& views, double resolution_m);

}  // namespace nearpose
