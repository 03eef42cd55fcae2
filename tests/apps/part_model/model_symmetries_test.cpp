#include "apps/part_model/model_symmetries.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "apps/scenes/parts.hpp"
#include "raycast/mesh_loader.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

using program::describe;
using program::find_symmetries;

const AxisOfRevolution kX{Eigen::Vector3d::UnitX(), {}}, kZ{Eigen::Vector3d::UnitZ(), {}};

bool said(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::string box_obj(double x, double y, double z) {
    std::string obj;
    for (int i = 0; i < 8; ++i) {
        obj += "v " + std::to_string(i % 2 * x) + " " + std::to_string(i / 2 % 2 * y) + " " +
               std::to_string(i / 4 * z) + "\n";
    }
    for (const char* face : {"1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"})
        obj += "f " + std::string(face) + "\n";
    return obj;
}

TEST(ModelSymmetries, InWords) {
    const double pi = std::numbers::pi;
    EXPECT_EQ(describe({}), "none");
    const std::vector<Pose> sixfold = closed_under_products({turn_about(kZ, pi / 3.0)}, 64);
    EXPECT_EQ(describe({sixfold, {}, {}}), "6-fold about z");
    EXPECT_EQ(describe({{}, {}, sixfold}), "none; nearly the same after 60, 120, 180, 240, 300 degrees about z");
    EXPECT_EQ(describe({{turn_about(kX, pi)}, {kZ}, {}}), "any turn about z, half turns about x");
    const std::vector<Pose> prism = closed_under_products({turn_about(kZ, pi / 3.0), turn_about(kX, pi)}, 64);
    const std::string text = describe({prism, {}, {}});
    EXPECT_EQ(text.rfind("6-fold about z, half turns about ", 0), 0U) << text;
    EXPECT_TRUE(said(text, " and 3 more")) << text;
    EXPECT_EQ(describe({{turn_about({Eigen::Vector3d(0.6, 0.8, 0.0), {}}, pi)}, {}, {}}),
              "half turns about (0.60 0.80 0.00)");
}

TEST(ModelSymmetries, TheBuiltInPartsHaveNoneButTheFlangeNearly) {
    for (const std::string& name : simulate::part_names()) {
        const Symmetries found = find_symmetries(simulate::embedded_part(name).mesh);
        EXPECT_TRUE(found.empty()) << name;
        EXPECT_EQ(found.near_symmetries.size(), name == "flange" ? 5U : 0U) << name;
    }
}

TEST(ModelSymmetries, ImportWritesWhatItFindsUnlessToldNotTo) {
    const TinyScene scene(1);
    write_text(scene.file("box.obj"), box_obj(40, 60, 100));
    const std::string call =
        "import --model " + scene.file("box.obj").string() + " --unit mm --id 2 --out " + scene.file("mine").string();
    const Outcome found = run_nearpose(call);
    ASSERT_EQ(found.exit_code, 0) << found.err;
    EXPECT_TRUE(said(found.out, "half turns about x, y, z")) << found.out;
    const data_set::ModelInfo info = data_set::read_model_info(scene.file("mine"), 2);
    ASSERT_EQ(info.discrete_symmetries.size(), 3U);
    for (const Pose& turn : info.discrete_symmetries) {
        const Eigen::Vector3d centre(0.02, 0.03, 0.05);
        EXPECT_LT((turn * centre - centre).norm(), 1e-6);
    }
    ASSERT_EQ(run_nearpose(call + " --no-symmetries").exit_code, 0);
    EXPECT_TRUE(data_set::read_model_info(scene.file("mine"), 2).discrete_symmetries.empty());
    EXPECT_EQ(run_nearpose(call + " --no-symmetries --symmetry-resolution-mm 1").exit_code, 2);
    // Sides of 60 and 61 mm are the same to who cannot tell a millimetre.
    write_text(scene.file("box.obj"), box_obj(60, 61, 100));
    ASSERT_EQ(run_nearpose(call + " --symmetry-resolution-mm 2").exit_code, 0);
    EXPECT_EQ(data_set::read_model_info(scene.file("mine"), 2).discrete_symmetries.size(), 7U);
}

TEST(ModelSymmetries, EstimateTakesTheDeclaredOnesBeforeThoseItFinds) {
    const TinyScene scene(1);
    const std::string call = "estimate " + scene.input() + "--out " + scene.file("poses.csv").string();
    EXPECT_FALSE(said(run_nearpose(call).err, "symmetries")) << "the part has none";
    std::map<int, data_set::ModelInfo> models = data_set::read_models_info(scene.models() / "models_info.json");
    models.at(1).discrete_symmetries = {turn_about(kZ, std::numbers::pi)};
    data_set::write_models_info(scene.models() / "models_info.json", models);
    for (const char* option : {"", " --symmetries auto", " --symmetries declared"}) {
        const Outcome declared = run_nearpose(call + option);
        EXPECT_EQ(declared.exit_code, 0) << declared.err;
        EXPECT_TRUE(said(declared.err, "of models_info.json: half turns about z")) << declared.err;
    }
    EXPECT_FALSE(said(run_nearpose(call + " --symmetries none").err, "symmetries"));
    EXPECT_EQ(run_nearpose("estimate --scene " + scene.scene().string() + " --model " +
                           (scene.models() / "obj_000001.ply").string() + " --symmetries declared --out -")
                  .exit_code,
              2);
}

}  // namespace
}  // namespace nearpose::program_tests
