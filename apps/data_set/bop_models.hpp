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
    double diameter_m = 0.0;  // the largest distance of two vertices
    Eigen::Vector3d box_min_in_object_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d box_max_in_object_m = Eigen::Vector3d::Zero();
    std::vector<Pose> discrete_symmetries;  // object_from_object; the identity is not listed
    std::vector<AxisOfRevolution> continuous_symmetries;
};

// <models>/obj_NNNNNN.ply; throws std::runtime_error that lists which objects there are where this one is missing.
std::filesystem::path model_path(const std::filesystem::path& models_folder, int object_id);

// By object number. Throws std::runtime_error naming file, object and key.
std::map<int, ModelInfo> read_models_info(const std::filesystem::path& models_info_json);
void write_models_info(const std::filesystem::path& models_info_json, const std::map<int, ModelInfo>& models);

// The entry of one object; throws std::runtime_error that lists which there are.
ModelInfo read_model_info(const std::filesystem::path& models_folder, int object_id);

}  // namespace nearpose::data_set
