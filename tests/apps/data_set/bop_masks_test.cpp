#include "apps/data_set/bop_masks.hpp"

#include <gtest/gtest.h>

#include "apps/data_set/png_file.hpp"
#include "tests/apps/data_set/scene_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

class Masks : public SceneFiles {
  protected:
    Masks() { fs::create_directories(scene_ / "mask_visib"); }

    void write(const std::string& name, const Mask& mask) const { write_mask_png(scene_ / "mask_visib" / name, mask); }
    static Mask filled(std::uint8_t value) { return {4, 3, std::vector<std::uint8_t>(12, value)}; }
    // Of frame 0.
    FrameMask loaded(std::optional<int> index = std::nullopt) const {
        const BopScene scene = open_scene(scene_);
        return MaskSource(scene, 9, index).load(scene.frames[0]);
    }
};

TEST_F(Masks, AreFoundByTheObjectsPlaceInTheList) {
    write("000000_000000.png", filled(0));
    write("000000_000001.png", filled(1));
    EXPECT_EQ(loaded().mask->value[0], 0);     // no scene_gt.json: 000000
    EXPECT_EQ(loaded(1).mask->value[0], 255);  // given
    // Only the order of the truth is looked at: the poses here are no poses. Some write numbers as text.
    write_text(scene_ / "scene_gt.json",
               R"({"0": [{"obj_id": 4}, {"obj_id": "9"}, {"obj_id": 9}], "1": [{"obj_id": 4}]})");
    const BopScene scene = open_scene(scene_);
    const MaskSource masks(scene, 9);
    EXPECT_EQ(masks.mask_index_of(0), 1);
    EXPECT_EQ(masks.load(scene.frames[0]).mask->value[0], 255);
    expect_error([&] { masks.load(scene.frames[1]); }, {"scene_gt.json", "1", "object 9", "--mask-index"});
    expect_error([&] { loaded(5); }, {"000000_000005.png", "--mask-index", "holds 2 files"});
    write_text(scene_ / "scene_gt.json", "{");
    expect_error([&] { loaded(); }, {"scene_gt.json", "not JSON"});
}

TEST_F(Masks, AreFoundWhateverThePadding) {
    for (const char* name : {"0_0.png", "00000_00000.PNG", "0.png", "mask_000000.png"}) {
        write(name, filled(7));
        ASSERT_TRUE(loaded().mask) << name;
        EXPECT_EQ(loaded().mask->value[0], 255) << name;
        EXPECT_EQ(loaded().notice, "");
        fs::remove(scene_ / "mask_visib" / name);
    }
}

TEST_F(Masks, OfAFrameThatHasNoneAreSaidToBeMissing) {
    write("000001_000000.png", filled(7));
    const FrameMask mask = loaded();
    EXPECT_FALSE(mask.mask);
    for (const char* part : {"000000_000000.png", "without", "1 file: 000001_000000.png"}) {
        EXPECT_NE(mask.notice.find(part), std::string::npos) << mask.notice;
    }
    fs::remove_all(scene_ / "mask_visib");
    EXPECT_FALSE(MaskSource(open_scene(scene_), 9).available());
    EXPECT_EQ(loaded().notice, "");
}

TEST_F(Masks, OfAWholeRatioAreScaled) {
    Mask mask = filled(0);
    mask.value[1 * 4 + 2] = 255;  // at (2, 1)
    Mask twice{8, 6, std::vector<std::uint8_t>(48, 0)};
    for (const int v : {2, 3}) {
        for (const int u : {4, 5}) twice.value[static_cast<std::size_t>(v * 8 + u)] = 255;
    }
    write("000000_000000.png", twice);
    EXPECT_EQ(loaded().mask->value, mask.value);
    EXPECT_NE(loaded().notice.find("8 x 6 pixels, the depth image 4 x 3; the mask is scaled"), std::string::npos);
    // The frame is twice as large as its mask.
    for (const int id : {0, 1, 2}) write_count_png(depth_path(scene_, id), {8, 6, std::vector<std::uint16_t>(48, 1)});
    fs::remove(camera_json_path(scene_));
    write("000000_000000.png", mask);
    EXPECT_EQ(loaded().mask->value, twice.value);
}

TEST_F(Masks, OfAnotherShapeAreRefused) {
    write("000000_000000.png", {3, 4, std::vector<std::uint8_t>(12, 1)});
    expect_error([&] { loaded(); }, {"000000_000000.png", "3 x 4", "4 x 3", "ratio"});
    write("000000_000000.png", {8, 3, std::vector<std::uint8_t>(24, 1)});
    expect_error([&] { loaded(); }, {"000000_000000.png", "8 x 3", "4 x 3", "ratio"});
}

}  // namespace
}  // namespace nearpose::data_set
