// The symmetries of a model: declared beside it or found from its mesh, and in words.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/data_set/bop_models.hpp"
#include "core/shape/symmetry.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::program {

// From views by ray casting, whatever generator the estimator has. Without a resolution that which a depth camera has
// where the whole part is in view: 0.5 mm, and of large parts a share of the diameter.
Symmetries find_symmetries(const Mesh& mesh, std::optional<double> resolution_m = std::nullopt);

Symmetries declared_symmetries(const data_set::ModelInfo& info);
void declare(const Symmetries& symmetries, data_set::ModelInfo& info);  // the exact ones

// "auto": the declared ones where there are any, else those found; "declared"; "none".
const std::vector<std::string>& symmetry_choices();

// For people: "6-fold about z, half turns about x, y; nearly the same after 30, 60 degrees about z". "none" where there
// are none.
std::string describe(const Symmetries& symmetries);

}  // namespace nearpose::program
