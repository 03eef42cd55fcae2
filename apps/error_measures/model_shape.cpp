#include "apps/error_measures/model_shape.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "raycast/mesh_loader.hpp"

namespace nearpose::evaluation {

std::vector<Pose> sampled_symmetries(const data_set::ModelInfo& info) {
    // The vertex that is farthest from the axis travels at most this share of the diameter between two samples.
    constexpr double kMaxStep = 0.01;
    static const int kSteps = static_cast<int>(std::ceil(std::numbers::pi / kMaxStep));
    std::vector<Pose> discrete = {Pose::identity()};
    discrete.insert(discrete.end(), info.discrete_symmetries.begin(), info.discrete_symmetries.end());
    if (info.continuous_symmetries.empty()) return discrete;
    std::vector<Pose> symmetries;
    for (const Pose& pose : discrete) {
        for (const AxisOfRevolution& axis : info.continuous_symmetries) {
            for (int i = 0; i < kSteps; ++i) {
                symmetries.push_back(turn_about(axis, 2.0 * std::numbers::pi / kSteps * i) * pose);
            }
        }
    }
    return symmetries;
}

ModelShape shape_of(const data_set::ModelInfo& info, std::vector<Eigen::Vector3d> vertices_in_object_m) {
    if (vertices_in_object_m.empty()) throw std::invalid_argument("a model without vertices cannot be evaluated");
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3d& vertex : vertices_in_object_m) points.push_back(vertex.cast<float>());
    return {info, std::move(vertices_in_object_m), sampled_symmetries(info), std::make_shared<PointIndex>(points)};
}

ModelShape shape_of(const data_set::ModelInfo& info, const Mesh& mesh) {
    std::vector<Eigen::Vector3d> vertices;
    for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) vertices.push_back(vertex.cast<double>());
    return shape_of(info, std::move(vertices));
}

ModelShape load_shape(const std::filesystem::path& models_folder, int object_id) {
    const std::filesystem::path beside =
        std::filesystem::absolute(models_folder / "..").lexically_normal() / "models_eval";
    const std::filesystem::path folder = std::filesystem::is_directory(beside) ? beside : models_folder;
    const bool own_info = std::filesystem::exists(folder / "models_info.json");
    const data_set::ModelInfo info = data_set::read_model_info(own_info ? folder : models_folder, object_id);
    return shape_of(info, load_vertices(data_set::model_path(folder, object_id), LengthUnit::kMillimetre));
}

}  // namespace nearpose::evaluation
