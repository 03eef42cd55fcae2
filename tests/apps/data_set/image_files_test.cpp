#include "apps/data_set/image_files.hpp"

#include <gtest/gtest.h>

#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

TEST(ImageFiles, GoByTheNumberInTheirName) {
    const fs::path folder = new_folder();
    for (const char* name : {"7.png", "00008.PNG", "frame_9.tif", "000010.tiff", "11.npy", "12.exr", "notes.txt",
                             "picture.png", "13.jpg", "99999999999.png"}) {
        write_text(folder / name, "");
    }
    fs::create_directories(folder / "14.png");
    const std::map<int, fs::path> images = depth_images_in(folder);
    ASSERT_EQ(images.size(), 6U);
    EXPECT_EQ(images.at(7).filename(), "7.png");
    EXPECT_EQ(images.at(8).filename(), "00008.PNG");
    EXPECT_EQ(images.at(12).filename(), "12.exr");
    EXPECT_TRUE(depth_images_in(folder / "none").empty());
}

TEST(ImageFiles, OfTheSameNumberThePngOfSixDigitsCounts) {
    const fs::path folder = new_folder();
    for (const char* name : {"1.npy", "1.png", "000001.png", "0001.png", "2.npy", "000002.tif", "3.png", "03.png"}) {
        write_text(folder / name, "");
    }
    const std::map<int, fs::path> images = depth_images_in(folder);
    EXPECT_EQ(images.at(1).filename(), "000001.png");
    EXPECT_EQ(images.at(2).filename(), "000002.tif");
    EXPECT_EQ(images.at(3).filename(), "3.png");
}

TEST(ImageFiles, MasksGoByFrameAndIndexOrByFrameAlone) {
    const fs::path folder = new_folder();
    for (const char* name : {"000001_000002.png", "1_0.png", "mask_5.PNG", "6.tif"}) write_text(folder / name, "");
    const MaskFiles masks = masks_in(folder);
    ASSERT_EQ(masks.by_index.size(), 2U);
    EXPECT_EQ(masks.by_index.at({1, 2}).filename(), "000001_000002.png");
    EXPECT_EQ(masks.by_index.at({1, 0}).filename(), "1_0.png");
    ASSERT_EQ(masks.by_frame.size(), 1U);
    EXPECT_EQ(masks.by_frame.at(5).filename(), "mask_5.PNG");
}

TEST(ImageFiles, AFolderIsToldByItsFirstAndLastFile) {
    const fs::path folder = new_folder();
    EXPECT_EQ(contents_of(folder), "the folder holds no file");
    EXPECT_NE(contents_of(folder / "none").find("there is no folder"), std::string::npos);
    write_text(folder / "9.tif", "");
    EXPECT_EQ(contents_of(folder), "the folder holds 1 file: 9.tif");
    write_text(folder / "10.tif", "");
    EXPECT_EQ(contents_of(folder), "the folder holds 2 files: 9.tif, 10.tif");
    write_text(folder / "11.tif", "");
    EXPECT_EQ(contents_of(folder), "the folder holds 3 files: 9.tif ... 11.tif");
}

}  // namespace
}  // namespace nearpose::data_set
