// The search for a part's symmetries in views of its model.
#pragma once

#include "core/shape/symmetry.hpp"
#include "core/view_generator.hpp"
#include "raycast/symmetry/symmetry_search_options.hpp"

namespace nearpose {

// The turns after which the part looks the same, and the near-symmetries, after which all but a detail does.
// `resolution_m` is what the sensor can tell apart: surfaces that lie closer count as the same, and so do details
// narrower than that. The views must be exact (ray casting); those of rasterised samples have holes, which would be
// taken for differences. The same arguments give the same bits. Throws std::invalid_argument where `resolution_m` is
// not positive or an option is out of its range.
//
// Axes of the box, of the surface's principal moments and of its faces are tried (symmetry_axes.hpp). Each turn about
// them is judged by the share of rays on which the model agrees with itself (self_similarity.hpp). A turn that agrees
// roughly has its axis refined, and is then exact (no detail differs), a near-symmetry, or nothing.
Symmetries find_symmetries(const ViewGenerator& views, double resolution_m, const SymmetrySearchOptions& options = {});

}  // namespace nearpose
