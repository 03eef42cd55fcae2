// The method on recorded depth, from no prior pose. The data stand beside the repository and are not part of it;
// without them the tests are skipped. Their references are good to 1-2 mm, so the bounds say "right", not "how right".
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/integration/run_scene.hpp"

namespace nearpose {
namespace {

constexpr double kDegree = M_PI / 180.0;

// Worst errors from frame `first` on; skips where the set is absent.
#define WORST_OF(set, first, run, worst)                                                                     \
    evaluation::PoseErrors worst;                                                                            \
    {                                                                                                        \
        const std::filesystem::path folder = std::filesystem::path("../shared/data") / (set);                \
        if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";                     \
        (worst) = test::worst_after(test::run_scene(folder / "test/000001", folder / "models", run), first); \
        RecordProperty("worst_translation_mm", std::to_string(1e3 * (worst).translation_m));                 \
        RecordProperty("worst_rotation_deg", std::to_string((worst).rotation_rad / kDegree));                \
    }

TEST(RealData, CastelWithinFiveMillimetresAndThreeDegrees) {
    WORST_OF("visp_castel", 10, {}, worst);
    EXPECT_LT(worst.translation_m, 0.005);
    EXPECT_LT(worst.rotation_rad, 3.0 * kDegree);
}

TEST(RealData, CastelSimuWithinTwoMillimetresAndOneDegree) {
    WORST_OF("visp_castle_simu", 10, {}, worst);
    EXPECT_LT(worst.translation_m, 0.002);
    EXPECT_LT(worst.rotation_rad, 1.0 * kDegree);
}

TEST(RealData, CastelSimuWithoutMasks) {
    WORST_OF("visp_castle_simu", 10, (test::SceneRun{"default", "raycast", false, 200, 1}), worst);
    EXPECT_LT(worst.translation_m, 0.002);
    EXPECT_LT(worst.rotation_rad, 1.0 * kDegree);
}

TEST(RealData, CubeAtRestUpToItsSymmetry) {
    WORST_OF("visp_cube42", 3, {}, worst);
    EXPECT_LT(worst.translation_m, 0.002);
    EXPECT_LT(worst.rotation_rad, 2.0 * kDegree);
}

TEST(RealData, HandHeldCubeUpToItsSymmetry) {
    WORST_OF("visp_rbt", 10, {}, worst);
    EXPECT_LT(worst.translation_m, 0.010);
    EXPECT_LT(worst.rotation_rad, 5.0 * kDegree);
}

}  // namespace
}  // namespace nearpose
