// The model as error measures see it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <vector>

#include "apps/data_set/bop_models.hpp"
#include "core/base/point_index.hpp"
#include "core/base/pose.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::evaluation {

struct ModelShape {
    data_set::ModelInfo info;
    std::vector<Eigen::Vector3d> vertices_in_object_m;  // of models_eval
    // What shape_of and load_shape make of the two above: the symmetries as bop_toolkit samples them
    // (object_from_object, with the identity), and the vertices' nearest neighbours.
    std::vector<Pose> symmetries = {Pose::identity()};
    std::shared_ptr<const PointIndex> vertex_index;

    Eigen::Vector3d centre_in_object_m() const { return 0.5 * (info.box_min_in_object_m + info.box_max_in_object_m); }
};

// Throws std::invalid_argument where there are no vertices or one is not finite.
ModelShape shape_of(const data_set::ModelInfo& info, std::vector<Eigen::Vector3d> vertices_in_object_m);
ModelShape shape_of(const data_set::ModelInfo& info, const Mesh& mesh);

// From the folder models_eval beside `models_folder`, as bop_toolkit does, or from `models_folder` itself where there
// is none. All vertices of the file count, as often as it lists them. Throws std::runtime_error naming the file.
ModelShape load_shape(const std::filesystem::path& models_folder, int object_id);

// Symmetries as bop_toolkit samples them (misc.get_symmetry_transformations with max_sym_disc_step = 0.01): every
// discrete one with the identity, after each of 315 turns about each axis.
std::vector<Pose> sampled_symmetries(const data_set::ModelInfo& info);

}  // namespace nearpose::evaluation
