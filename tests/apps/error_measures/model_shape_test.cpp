#include "apps/error_measures/model_shape.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/apps/support/test_files.hpp"

namespace nearpose::evaluation {
namespace {

using data_set::testing_files::expect_error;
using data_set::testing_files::new_folder;
using data_set::testing_files::write_text;

// A triangle whose first corner stands twice, and a vertex of no triangle.
std::string ply(const std::string& first_corner) {
    return "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
           first_corner + "\n" + first_corner + "\n100.1 0 0\n0 50 0\n33 44 55\n3 0 2 3\n";
}

data_set::ModelInfo some_info() {
    data_set::ModelInfo info;
    info.diameter_m = 0.12;
    info.box_max_in_object_m = {0.1, 0.05, 0.0};
    return info;
}

TEST(ModelShape, CountsEveryVertexOfTheFileWithItsDigits) {
    const auto models = new_folder() / "models";
    write_text(models / "obj_000001.ply", ply("1 2 3"));
    data_set::write_models_info(models / "models_info.json", {{1, some_info()}});
    const ModelShape shape = load_shape(models, 1);
    ASSERT_EQ(shape.vertices_in_object_m.size(), 5U);
    EXPECT_EQ(shape.vertices_in_object_m[0], shape.vertices_in_object_m[1]);
    EXPECT_NEAR(shape.vertices_in_object_m[2].x(), double{100.1F} * 1e-3, 1e-15);  // not rounded again
    EXPECT_LT((shape.centre_in_object_m() - Eigen::Vector3d(0.05, 0.025, 0.0)).norm(), 1e-12);
}

TEST(ModelShape, IsThatOfModelsEvalWhereThereIsOne) {
    const auto set = new_folder();
    write_text(set / "models/obj_000001.ply", ply("1 2 3"));
    write_text(set / "models_eval/obj_000001.ply", ply("7 8 9"));
    data_set::write_models_info(set / "models/models_info.json", {{1, some_info()}});
    EXPECT_NEAR(load_shape(set / "models/", 1).vertices_in_object_m[0].x(), 0.007, 1e-15);
    data_set::write_models_info(set / "models_eval/models_info.json", {{1, some_info()}});
    EXPECT_NEAR(load_shape(set / "models_eval", 1).vertices_in_object_m[0].x(), 0.007, 1e-15);
}

TEST(ModelShape, SaysWhatIsMissing) {
    const auto models = new_folder() / "models";
    write_text(models / "obj_000001.ply", ply("1 nan 3"));
    expect_error([&] { load_shape(models, 1); }, {"models_info.json"});
    data_set::write_models_info(models / "models_info.json", {{1, some_info()}});
    expect_error([&] { load_shape(models, 1); }, {"obj_000001.ply"});
    expect_error([&] { load_shape(models, 2); }, {"models_info.json", "2"});
    EXPECT_THROW(shape_of(some_info(), std::vector<Eigen::Vector3d>{}), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::evaluation
