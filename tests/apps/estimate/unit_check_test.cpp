// Models in a wrong unit.
#include "apps/estimate/unit_check.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

using program::fitting_unit;
using program::SeenSize;

constexpr SeenSize kMasked{0.1, true, false};
constexpr SeenSize kCut{0.1, true, true};
constexpr SeenSize kScene{0.5, false, false};

TEST(UnitCheck, ARightSizeIsLeftAlone) {
    for (const LengthUnit unit :
         {LengthUnit::kMillimetre, LengthUnit::kMetre, LengthUnit::kInch, LengthUnit::kCentimetre}) {
        // One side of a part is seen, the mask is a little too large, or something stands before the part.
        for (const double diameter_m : {0.07, 0.1, 0.118, 0.2, 0.5}) {
            EXPECT_FALSE(fitting_unit(diameter_m, unit, kMasked)) << diameter_m;
            EXPECT_FALSE(fitting_unit(5.0 * diameter_m, unit, kCut)) << diameter_m;
        }
        for (const double diameter_m : {0.02, 0.1, 0.5, 2.0}) EXPECT_FALSE(fitting_unit(diameter_m, unit, kScene));
    }
}

// Of each pair of units one is the file's and the other what it was read in.
TEST(UnitCheck, OfAPartWithAMaskTheRightUnitIsFound) {
    const std::vector<LengthUnit> units{LengthUnit::kMillimetre, LengthUnit::kMetre, LengthUnit::kInch,
                                        LengthUnit::kCentimetre};
    for (const LengthUnit right : units) {
        for (const LengthUnit given : units) {
            const double ratio = metres_per(given) / metres_per(right);
            if (given == right || (ratio > 0.3 && ratio < 3.0)) continue;  // an inch is 2.5 cm
            const std::optional<LengthUnit> found = fitting_unit(0.118 * ratio, given, kMasked);
            ASSERT_TRUE(found) << to_string(right) << " read in " << to_string(given);
            EXPECT_EQ(*found, right) << " read in " << to_string(given);
        }
    }
}

TEST(UnitCheck, WithoutAMaskAUnitThatFitsTheSceneIsNamed) {
    EXPECT_EQ(fitting_unit(0.118 / 25.4, LengthUnit::kMillimetre, kScene), LengthUnit::kInch);
    EXPECT_EQ(fitting_unit(0.118 / 1000.0, LengthUnit::kMillimetre, kScene), LengthUnit::kMetre);
    EXPECT_EQ(fitting_unit(0.118 * 1000.0, LengthUnit::kMetre, kScene), LengthUnit::kMillimetre);
}

TEST(UnitCheck, WhereNoUnitFitsNothingIsSaid) {
    EXPECT_FALSE(fitting_unit(0.04, LengthUnit::kMillimetre, kMasked));
    program::ModelOptions model;
    model.model = "a.stl";
    EXPECT_FALSE(program::unit_notice(model, 0.1, kMasked));
    EXPECT_EQ(program::unit_notice(model, 0.0047, kMasked),
              "a.stl: the model measures 4.7 mm, the masked region 100 mm: is the file in inches? Say --unit in");
    const TinyScene scene(1);
    program::ModelOptions bop;
    bop.models = scene.models().string();
    const std::string file = (scene.models() / "obj_000001.ply").string();
    EXPECT_EQ(program::unit_notice(bop, 0.0047, kMasked),
              file +
                  ": the model measures 4.7 mm, the masked region 100 mm: is the file in inches? "
                  "Import it again with --unit in");
}

TEST(UnitCheck, EstimateNamesIt) {
    const TinyScene scene(2);
    std::ostringstream inches;
    const Mesh part = unsymmetric_part();
    for (const Eigen::Vector3f& vertex : part.vertices_in_object)
        inches << "v " << (vertex / 0.0254F).transpose() << "\n";
    for (const auto& [a, b, c] : part.triangles) inches << "f " << a + 1 << " " << b + 1 << " " << c + 1 << "\n";
    write_text(scene.file("part.obj"), inches.str());
    const std::string call = "estimate --scene " + scene.scene().string() + " --model " +
                             scene.file("part.obj").string() + " --particles 20 --out " +
                             scene.file("poses.csv").string();
    const Outcome wrong = run_nearpose(call);
    EXPECT_NE(wrong.err.find("is the file in inches? Say --unit in"), std::string::npos) << wrong.err;
    EXPECT_EQ(wrong.err.find("--unit in"), wrong.err.rfind("--unit in")) << wrong.err;
    const Outcome right = run_nearpose(call + " --unit in");
    EXPECT_EQ(right.err.find("is the file in"), std::string::npos) << right.err;
}

}  // namespace
}  // namespace nearpose::program_tests
