#include "apps/data_set/bop_models.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

TEST(BopModels, AnObjectThatIsNotThereIsToldWithThoseThatAre) {
    const fs::path folder = new_folder();
    expect_error([&] { model_path(folder, 1); }, {"obj_000001.ply", "no such object", "none"});
    write_text(folder / "obj_000012.ply", "");
    write_text(folder / "obj_000003.ply", "");
    write_text(folder / "obj_x.ply", "");
    EXPECT_EQ(model_path(folder, 12), folder / "obj_000012.ply");
    expect_error([&] { model_path(folder, 1); }, {"obj_000001.ply", "no such object", "3, 12"});
    expect_error([&] { model_path(folder / "none", 1); }, {"none", "not a folder"});
}

TEST(BopModels, InfoComesBack) {
    const fs::path file = new_folder() / "models_info.json";
    ModelInfo info;
    info.diameter_m = 0.2463283;
    info.box_min_in_object_m = {-0.144874, 0.000763126, -0.101};
    info.box_max_in_object_m = {0.0405595, 0.178763, 0.102444};
    const Pose half_turn{Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ())),
                         {0.01, 0.02, 0.0}};
    info.discrete_symmetries = {half_turn, half_turn.inverse()};
    info.continuous_symmetries = {{Eigen::Vector3d(0.0, 0.6, 0.8), {0.001, 0.0, -0.002}}};
    ModelInfo plain;
    plain.diameter_m = 1.0;
    write_models_info(file, {{2, plain}, {10, info}});
    const std::map<int, ModelInfo> back = read_models_info(file);
    ASSERT_EQ(back.size(), 2U);
    const ModelInfo& read = back.at(10);
    EXPECT_NEAR(read.diameter_m, info.diameter_m, 1e-15);
    EXPECT_LT((read.box_min_in_object_m - info.box_min_in_object_m).norm(), 1e-15);
    EXPECT_LT((read.box_max_in_object_m - info.box_max_in_object_m).norm(), 1e-15);
    ASSERT_EQ(read.discrete_symmetries.size(), 2U);
    EXPECT_LT(log(read.discrete_symmetries[1] * half_turn).norm(), 1e-12);
    ASSERT_EQ(read.continuous_symmetries.size(), 1U);
    EXPECT_LT((read.continuous_symmetries[0].axis_in_object - Eigen::Vector3d(0.0, 0.6, 0.8)).norm(), 1e-15);
    EXPECT_LT((read.continuous_symmetries[0].offset_in_object_m - Eigen::Vector3d(0.001, 0.0, -0.002)).norm(), 1e-15);
    EXPECT_TRUE(back.at(2).discrete_symmetries.empty());
    expect_error([&] { read_model_info(file.parent_path(), 7); }, {"models_info.json", "no such object: 7", "2, 10"});
}

TEST(BopModels, BadInfoIsRefusedByName) {
    const fs::path file = new_folder() / "models_info.json";
    const std::string box = R"("min_x": 0, "min_y": 0, "min_z": 0, "size_x": 1, "size_y": 1, "size_z": 1)";
    const auto refused = [&](const std::string& entry, const std::vector<std::string>& parts) {
        write_text(file, "{\"4\": {" + entry + "}}");
        expect_error([&] { read_models_info(file); }, parts);
    };
    refused(R"("diameter": -1, )" + box, {"4/diameter", "positive"});
    refused(R"("diameter": 1, "min_x": 0)", {"4", "min_y"});
    refused(R"("diameter": 1, "symmetries_discrete": [[1, 0]], )" + box, {"4/symmetries_discrete/0", "16"});
    refused(R"("diameter": 1, "symmetries_discrete": [[2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]], )" + box,
            {"4/symmetries_discrete/0", "rigid"});
    // Column-major: the translation in the last row.
    refused(R"("diameter": 1, "symmetries_discrete": [[1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]], )" + box, {"rigid"});
    refused(R"("diameter": 1, "symmetries_continuous": [{"axis": [0,0,0], "offset": [0,0,0]}], )" + box,
            {"axis", "direction"});
}

TEST(BopModels, WhatIsMissingIsTakenFromTheMesh) {
    const fs::path folder = new_folder();
    write_text(folder / "models_info.json", R"({"4": {"symmetries_continuous": [{"axis": [0, 0, 2]}],
      "symmetries_discrete": [[[-1,0,0,0], [0,-1,0,0], [0,0,1,5], [0,0,0,1]]]}})");
    write_text(folder / "obj_000004.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n-1 0 0\n2 0 0\n0 4 0\n3 0 1 2\n");
    const ModelInfo info = read_model_info(folder, 4);
    EXPECT_NEAR(info.diameter_m, std::sqrt(20.0) * 1e-3, 1e-9);
    EXPECT_LT((info.box_min_in_object_m - Eigen::Vector3d(-1e-3, 0, 0)).norm(), 1e-12);
    EXPECT_LT((info.box_max_in_object_m - Eigen::Vector3d(2e-3, 4e-3, 0)).norm(), 1e-12);
    EXPECT_LT(info.continuous_symmetries.at(0).offset_in_object_m.norm(), 1e-15);
    EXPECT_NEAR(info.discrete_symmetries.at(0).translation.z(), 5e-3, 1e-15);
    // What a file does not say is not made up when it is written anew.
    write_models_info(folder / "models_info.json", read_models_info(folder / "models_info.json"));
    EXPECT_EQ(read_models_info(folder / "models_info.json").at(4).diameter_m, 0.0);
    EXPECT_EQ(read_models_info(folder / "models_info.json").at(4).continuous_symmetries.size(), 1U);
}

TEST(BopModels, ASymmetryIsRowMajorInMillimetres) {
    const fs::path file = write_text(new_folder() / "models_info.json", R"({"1": {"diameter": 72.7461,
      "min_x": -42, "min_y": 0, "min_z": 0, "size_x": 42, "size_y": 42, "size_z": 42,
      "symmetries_discrete": [[1,0,0,0, 0,-1,0,42, 0,0,-1,42, 0,0,0,1]]}})");
    const Pose symmetry = read_models_info(file).at(1).discrete_symmetries.at(0);
    // A half turn of the cube of 42 mm about the axis along x through its middle keeps the middle.
    const Eigen::Vector3d middle(-0.021, 0.021, 0.021);
    EXPECT_LT((symmetry * middle - middle).norm(), 1e-15);
}

}  // namespace
}  // namespace nearpose::data_set
