// The parts of an estimator by the names that users give them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/method.hpp"
#include "core/pose_solver.hpp"
#include "core/view_generator.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::program {

// "raycast": rays of the real camera against the mesh; "raster": the paper's rasteriser of surface samples; "sphere": a
// store of views from a sphere around the object.
const std::vector<std::string>& view_names();
// "default" and "paper".
const std::vector<std::string>& method_names();

// All throw std::invalid_argument for a name that is not among these.
std::shared_ptr<const ViewGenerator> make_view_generator(const std::string& views, const Mesh& mesh);
Method make_method(const std::string& method);
// Point to plane with a robust loss; for the paper's method point to point without one.
std::shared_ptr<const PoseSolver> make_solver(const std::string& method);

}  // namespace nearpose::program
