#include "apps/data_set/bop_models.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/json_file.hpp"
#include "apps/data_set/model_diameter.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;

Eigen::Vector3d vector_of(const std::vector<double>& v) {
    return {v[0], v[1], v[2]};
}

// BOP's symmetries are row-major 4x4 matrices, translations in mm.
Pose read_symmetry(const JsonValue& value) {
    const std::vector<double> m = value.numbers(16);
    Eigen::Matrix3d rotation;
    rotation << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
    const double off = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    const bool last_row = Eigen::Vector4d(m[12], m[13], m[14], m[15] - 1.0).cwiseAbs().maxCoeff() < 1e-6;
    if (!(off < 1e-3) || rotation.determinant() < 0.0 || !last_row) {
        throw value.error("is not a rigid transform (row-major 4x4)");
    }
    return Pose::from_matrix(rotation, Eigen::Vector3d(m[3], m[7], m[11]) * 1e-3);
}

AxisOfRevolution read_axis(const JsonValue& value) {
    AxisOfRevolution symmetry;
    const JsonValue axis = value.at("axis");
    symmetry.axis_in_object = vector_of(axis.numbers(3));
    if (!(symmetry.axis_in_object.norm() > 1e-9)) throw axis.error("has no direction");
    symmetry.axis_in_object.normalize();
    if (const auto offset = value.find("offset")) symmetry.offset_in_object_m = vector_of(offset->numbers(3)) * 1e-3;
    return symmetry;
}

// Leaves the box at 0 where none of its keys is there.
void read_box(const JsonValue& entry, ModelInfo& info) {
    if (!entry.find("min_x") && !entry.find("size_x")) return;
    const auto three = [&](const std::string& prefix) {
        Eigen::Vector3d v;
        v.x() = entry.at(prefix + "_x").number();
        v.y() = entry.at(prefix + "_y").number();
        v.z() = entry.at(prefix + "_z").number();
        return v;
    };
    info.box_min_in_object_m = three("min") * 1e-3;
    const Eigen::Vector3d size_m = three("size") * 1e-3;
    if (!(size_m.minCoeff() >= 0.0)) throw entry.error("has a negative size");
    info.box_max_in_object_m = info.box_min_in_object_m + size_m;
}

ModelInfo read_entry(const JsonValue& entry) {
    ModelInfo info;
    if (const auto diameter = entry.find("diameter")) {
        info.diameter_m = diameter->number() * 1e-3;
        if (!(info.diameter_m > 0.0)) throw diameter->error("must be positive");
    }
    read_box(entry, info);
    if (const auto list = entry.find("symmetries_discrete")) {
        for (const JsonValue& symmetry : list->elements()) info.discrete_symmetries.push_back(read_symmetry(symmetry));
    }
    if (const auto list = entry.find("symmetries_continuous")) {
        for (const JsonValue& symmetry : list->elements()) info.continuous_symmetries.push_back(read_axis(symmetry));
    }
    return info;
}

std::string array_text(const std::vector<double>& values) {
    std::string text;
    for (const double value : values) {
        if (!std::isfinite(value)) throw std::invalid_argument("models_info.json: a number is not finite");
        text += (text.empty() ? "[" : ", ") + format_number(value);
    }
    return text + "]";
}

std::string symmetries_text(const ModelInfo& info) {
    std::string text;
    const char* separator = "";
    if (!info.discrete_symmetries.empty()) text += ",\n    \"symmetries_discrete\": [";
    for (const Pose& pose : info.discrete_symmetries) {
        const Eigen::Matrix3d R = pose.rotation_matrix();
        const Eigen::Vector3d t = pose.translation * 1e3;
        text += separator + array_text({R(0, 0), R(0, 1), R(0, 2), t.x(), R(1, 0), R(1, 1), R(1, 2), t.y(), R(2, 0),
                                        R(2, 1), R(2, 2), t.z(), 0.0, 0.0, 0.0, 1.0});
        separator = ", ";
    }
    if (!info.discrete_symmetries.empty()) text += "]";
    separator = "";
    if (!info.continuous_symmetries.empty()) text += ",\n    \"symmetries_continuous\": [";
    for (const AxisOfRevolution& symmetry : info.continuous_symmetries) {
        const Eigen::Vector3d& axis = symmetry.axis_in_object;
        const Eigen::Vector3d offset = symmetry.offset_in_object_m * 1e3;
        text += std::string(separator) + "{\"axis\": " + array_text({axis.x(), axis.y(), axis.z()}) +
                ", \"offset\": " + array_text({offset.x(), offset.y(), offset.z()}) + "}";
        separator = ", ";
    }
    if (!info.continuous_symmetries.empty()) text += "]";
    return text;
}

bool has_box(const ModelInfo& info) {
    return info.box_min_in_object_m != info.box_max_in_object_m;
}

std::string entry_text(const ModelInfo& info) {
    const auto number = [](double value_m) {
        if (!std::isfinite(value_m)) throw std::invalid_argument("models_info.json: a number is not finite");
        return format_number(value_m * 1e3);
    };
    const Eigen::Vector3d& low = info.box_min_in_object_m;
    const Eigen::Vector3d size = info.box_max_in_object_m - low;
    std::string text;
    if (info.diameter_m > 0.0) text += ",\n    \"diameter\": " + number(info.diameter_m);
    const char* const axes[] = {"x", "y", "z"};
    for (int i = 0; i < 3 && has_box(info); ++i)
        text += std::string(",\n    \"min_") + axes[i] + "\": " + number(low[i]);
    for (int i = 0; i < 3 && has_box(info); ++i)
        text += std::string(",\n    \"size_") + axes[i] + "\": " + number(size[i]);
    text += symmetries_text(info);
    return "{" + text.substr(std::min<std::size_t>(1, text.size())) + "\n  }";
}

std::string listed(std::vector<int> ids) {
    std::sort(ids.begin(), ids.end());
    std::string text;
    for (const int id : ids) text += (text.empty() ? "" : ", ") + std::to_string(id);
    return text.empty() ? "none" : text;
}

std::vector<int> objects_in(const fs::path& models_folder) {
    std::vector<int> ids;
    for (const fs::directory_entry& file : fs::directory_iterator(models_folder)) {
        const std::string name = file.path().filename().string();
        if (!name.starts_with("obj_") || !name.ends_with(".ply")) continue;
        const auto id = parse_integer(name.substr(4, name.size() - 8));
        if (id) ids.push_back(static_cast<int>(*id));
    }
    return ids;
}

}  // namespace

fs::path model_path(const fs::path& models_folder, int object_id) {
    if (!fs::is_directory(models_folder)) throw std::runtime_error(models_folder.string() + ": is not a folder");
    const fs::path path = models_folder / ("obj_" + zero_padded(object_id) + ".ply");
    if (fs::exists(path)) return path;
    throw std::runtime_error(path.string() + ": no such object; the folder has: " + listed(objects_in(models_folder)));
}

std::map<int, ModelInfo> read_models_info(const fs::path& models_info_json) {
    const JsonFile file(models_info_json);
    std::map<int, ModelInfo> models;
    for (const auto& [id, entry] : file.root().numbered_members()) models.emplace(id, read_entry(entry));
    return models;
}

void write_models_info(const fs::path& models_info_json, const std::map<int, ModelInfo>& models) {
    std::string text = "{";
    for (const auto& [id, info] : models) {
        text += (text.size() == 1 ? "\n  \"" : ",\n  \"") + std::to_string(id) + "\": " + entry_text(info);
    }
    write_file_atomically(models_info_json, text + "\n}\n");
}

ModelInfo read_model_info(const fs::path& models_folder, int object_id) {
    const fs::path path = models_folder / "models_info.json";
    const std::map<int, ModelInfo> models = read_models_info(path);
    const auto found = models.find(object_id);
    if (found == models.end()) {
        std::vector<int> ids;
        for (const auto& model : models) ids.push_back(model.first);
        throw std::runtime_error(path.string() + ": no such object: " + std::to_string(object_id) +
                                 "; the file has: " + listed(ids));
    }
    ModelInfo info = found->second;
    if (info.diameter_m > 0.0 && has_box(info)) return info;
    std::vector<Eigen::Vector3f> points;
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& vertex : load_vertices(model_path(models_folder, object_id), LengthUnit::kMillimetre)) {
        points.push_back(vertex.cast<float>());
        box.extend(vertex);
    }
    if (!(info.diameter_m > 0.0)) info.diameter_m = diameter_of(points);
    if (has_box(info)) return info;
    info.box_min_in_object_m = box.min();
    info.box_max_in_object_m = box.max();
    return info;
}

}  // namespace nearpose::data_set
