// BOP models: <set>/models/{obj_NNNNNN.ply, models_info.json}. Millimetres in the files, metres here.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <vector>

#include "core/base/pose.hpp"
#include "core/shape/symmetry.hpp"

namespace nearpose::data_set {

struct ModelInfo {
    double diameter_m = 0.0;  // the largest distance of two vertices; 0: the file does not say
    Eigen::Vector3d box_min_in_object_m = Eigen::Vector3d::Zero();  // both corners 0: the file does not say
    Eigen::Vector3d box_max_in_object_m = Eigen::Vector3d::Zero();
    std::vector<Pose> discrete_symmetries;  // object_from_object; the identity is not listed
    std::vector<AxisOfRevolution> continuous_symmetries;
};

// <models>/obj_NNNNNN.ply; throws std::runtime_error that lists which objects there are where this one is missing.
std::filesystem::path model_path(const std::filesystem::path& models_folder, int object_id);

// By object number. Matrices may be nested by rows; an axis without "offset" goes through the origin. Throws
// std::runtime_error naming file, object and key.
std::map<int, ModelInfo> read_models_info(const std::filesystem::path& models_info_json);
void write_models_info(const std::filesystem::path& models_info_json, const std::map<int, ModelInfo>& models);

// The entry of one object; diameter and box are the mesh's where the file does not say them. Throws std::runtime_error
// that lists which objects there are.
ModelInfo read_model_info(const std::filesystem::path& models_folder, int object_id);

}  // namespace nearpose::data_set
