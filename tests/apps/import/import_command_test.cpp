// import, run as a user would.
#include <gtest/gtest.h>

#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/png_file.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(Import, AModelBecomesABopModel) {
    const TinyScene scene(1);
    const Outcome outcome = run_nearpose("import --model " + (scene.models() / "obj_000001.ply").string() +
                                         " --unit cm --id 3 --out " + scene.file("imported").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(std::filesystem::is_regular_file(scene.file("imported/obj_000003.ply")));
    const auto info = data_set::read_model_info(scene.file("imported"), 3);
    EXPECT_NEAR(info.box_max_in_object_m.x(), 1.6, 1e-4);  // 160 in the file
}

TEST(Import, ARecordingGoesToANumberAndLeavesTheUsersCameraAlone) {
    const TinyScene scene(1);
    std::filesystem::create_directories(scene.file("raw"));
    write_text(scene.file("raw/part_Depth_12.5.raw"), std::string(2 * 160 * 120, '\3'));
    const std::string camera = read_text(scene.file("camera.json")) + "\n\n";  // a text of the user's own
    write_text(scene.file("camera.json"), camera);
    const std::string call = "import --realsense-raw " + scene.file("raw").string() + " --camera " +
                             scene.file("camera.json").string() + " --depth-unit-m 0.0002 --out ";
    const Outcome no_number = run_nearpose(call + scene.file("test/mine").string());
    EXPECT_EQ(no_number.exit_code, 2);
    EXPECT_TRUE(contains(no_number.err, "SET/test/NUMBER")) << no_number.err;
    EXPECT_FALSE(std::filesystem::exists(scene.file("test/mine")));
    EXPECT_EQ(run_nearpose(call + scene.file("test/000008").string()).exit_code, 0);
    EXPECT_EQ(data_set::read_count_png(scene.file("test/000008/depth/000000.png")).counts[0], 0x303);
    EXPECT_EQ(read_text(scene.file("camera.json")), camera);
}

TEST(Import, SourcesExcludeEachOther) {
    EXPECT_EQ(run_nearpose("import --tum a --open3d b --out c").exit_code, 2);
    EXPECT_EQ(run_nearpose("import --tum a --out c").exit_code, 2);
    EXPECT_EQ(run_nearpose("import --tum nowhere --camera nowhere.json --out c/test/1").exit_code, 1);
}

}  // namespace
}  // namespace nearpose::program_tests
