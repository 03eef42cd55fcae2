#include "apps/import/import_frames.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/model_diameter.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/part_model/import_model.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

fs::path camera_file(const fs::path& folder) {
    write_camera_json(folder / "camera.json", {3, 2, 500.0, 501.0, 1.0, 0.5}, 1.0);
    return folder / "camera.json";
}

// 6 counts, little endian, the first being `first`.
std::string raw_frame(int first) {
    std::string bytes;
    for (int i = 0; i < 6; ++i) bytes += {static_cast<char>((first + i) & 0xff), static_cast<char>((first + i) >> 8)};
    return bytes;
}

TEST(ImportRealSense, FramesAreOrderedByStampAndKeepTheirCounts) {
    const fs::path folder = new_folder();
    // As text 999.5 would come after 1033.25.
    write_text(folder / "raw" / "part_Depth_1033.2500000000.raw", raw_frame(1000));
    write_text(folder / "raw" / "part_Depth_999.5.raw", raw_frame(300));
    write_text(folder / "raw" / "part_Depth_metadata_999.5.txt", "Stream,Depth\n");
    write_text(folder / "raw" / "part_Color_999.5.raw", "x");
    const fs::path scene_folder = folder / "mine" / "test" / "000001";
    const ImportSummary summary = import_realsense_raw({folder / "raw", camera_file(folder), 0.0001, scene_folder});
    EXPECT_EQ(summary.frames, 2);
    EXPECT_TRUE(summary.warnings.empty());
    const BopScene scene = open_scene(scene_folder);
    ASSERT_EQ(scene.frames.size(), 2U);
    EXPECT_EQ(scene.id, 1);
    EXPECT_DOUBLE_EQ(scene.frames[0].stamp_s, 0.9995);
    EXPECT_DOUBLE_EQ(scene.frames[1].stamp_s, 1.03325);
    EXPECT_DOUBLE_EQ(scene.frames[0].depth_scale_mm, 0.1);  // metres per unit times 1000
    EXPECT_EQ(scene.frames[0].camera.fy, 501.0);
    EXPECT_EQ(read_count_png(scene.frames[0].depth).counts, (std::vector<std::uint16_t>{300, 301, 302, 303, 304, 305}));
    EXPECT_FLOAT_EQ(load_depth(scene.frames[1]).depth_m[0], 0.1F);
    EXPECT_TRUE(fs::exists(folder / "mine" / "camera.json"));
}

TEST(ImportRealSense, BadRecordingsAreRefused) {
    const fs::path folder = new_folder();
    const fs::path camera = camera_file(folder);
    const fs::path out = folder / "mine" / "test" / "000001";
    const auto refused = [&](const std::vector<std::string>& parts, double unit_m = 0.001) {
        expect_error([&] { import_realsense_raw({folder / "raw", camera, unit_m, out}); }, parts);
        EXPECT_FALSE(fs::exists(out / "scene_camera.json"));
        fs::remove_all(folder / "mine");
    };
    refused({"raw", "not a folder"});
    write_text(folder / "raw" / "part.txt", "");
    refused({"raw", "rs-convert -d -r"});
    write_text(folder / "raw" / "part_Depth_1.raw", raw_frame(1) + "x");
    refused({"part_Depth_1.raw", "13 bytes", "3 x 2", "12"});
    write_text(folder / "raw" / "part_Depth_1.raw", raw_frame(1));
    refused({"depth unit"}, 0.0);
}

TEST(ImportRealSense, AnEmptyRecordingIsSaid) {
    const fs::path folder = new_folder();
    write_text(folder / "raw" / "part_Depth_1.raw", std::string(12, '\0'));
    const ImportSummary summary =
        import_realsense_raw({folder / "raw", camera_file(folder), 0.001, folder / "mine" / "test" / "000001"});
    ASSERT_EQ(summary.warnings.size(), 1U);
    EXPECT_NE(summary.warnings[0].find("measured"), std::string::npos);
}

TEST(ImportOpen3d, TheMatrixIsColumnMajorAndTheScaleIsUnitsPerMetre) {
    const fs::path folder = new_folder();
    write_text(
        folder / "rec" / "intrinsic.json",
        R"({"width": 3, "height": 2, "depth_scale": 4000.0, "intrinsic_matrix": [500, 0, 0, 0, 501, 0, 1.5, 0.25, 1]})");
    fs::create_directories(folder / "rec" / "depth");
    for (const int number : {2, 10}) {
        const std::string name = (number < 10 ? "0000" : "000") + std::to_string(number) + ".png";
        write_count_png(folder / "rec" / "depth" / name, {3, 2, std::vector<std::uint16_t>(6, 2000)});
    }
    const fs::path scene_folder = folder / "mine" / "test" / "000003";
    const ImportSummary summary = import_open3d({folder / "rec", scene_folder, 20.0});
    EXPECT_EQ(summary.frames, 2);
    ASSERT_EQ(summary.warnings.size(), 1U);
    EXPECT_NE(summary.warnings[0].find("aligns depth"), std::string::npos);
    const BopScene scene = open_scene(scene_folder);
    EXPECT_EQ(scene.frames[1].id, 10);
    EXPECT_EQ(scene.frames[0].camera.fx, 500.0);
    EXPECT_EQ(scene.frames[0].camera.fy, 501.0);
    EXPECT_EQ(scene.frames[0].camera.cx, 1.5);
    EXPECT_EQ(scene.frames[0].camera.cy, 0.25);
    EXPECT_DOUBLE_EQ(scene.frames[0].depth_scale_mm, 0.25);
    EXPECT_DOUBLE_EQ(scene.frames[1].stamp_s, 0.5);
    EXPECT_FLOAT_EQ(load_depth(scene.frames[0]).depth_m[0], 0.5F);
}

TEST(ImportOpen3d, BadRecordingsAreRefused) {
    const fs::path folder = new_folder();
    const fs::path out = folder / "mine" / "test" / "000001";
    const auto refused = [&](const std::string& intrinsics, const std::vector<std::string>& parts) {
        write_text(folder / "rec" / "intrinsic.json", intrinsics);
        expect_error([&] { import_open3d({folder / "rec", out, 30.0}); }, parts);
        fs::remove_all(folder / "mine");
    };
    const std::string good = R"({"width": 3, "height": 2, "intrinsic_matrix": [500, 0, 0, 0, 501, 0, 1.5, 0.25, 1]})";
    refused(good, {"depth", "not a folder"});
    fs::create_directories(folder / "rec" / "depth");
    refused(good, {"depth", "00000.png"});
    refused(R"({"width": 3, "height": 2, "intrinsic_matrix": [500, 0, 1.5, 0, 501, 0.25, 0, 0, 1]})", {"column-major"});
    refused(R"({"width": 3, "height": 2, "depth_scale": 0, "intrinsic_matrix": [500, 0, 0, 0, 501, 0, 1.5, 0.25, 1]})",
            {"depth_scale"});
    write_rgb_png(folder / "rec" / "depth" / "00000.png", 3, 2, std::vector<std::uint8_t>(18));
    refused(good, {"00000.png", "8 bits", "never with -p"});
}

TEST(ImportTum, StampsAndFactorComeOver) {
    const fs::path folder = new_folder();
    fs::create_directories(folder / "rec" / "depth");
    write_count_png(folder / "rec" / "depth" / "b.png", {3, 2, std::vector<std::uint16_t>(6, 5000)});
    write_count_png(folder / "rec" / "depth" / "a.png", {3, 2, std::vector<std::uint16_t>(6, 1)});
    write_text(folder / "rec" / "depth.txt",
               "# depth maps\n# timestamp filename\n1305031102.1947 depth/b.png\n1305031102.1603 depth/a.png\n");
    const fs::path scene_folder = folder / "mine" / "test" / "000001";
    EXPECT_EQ(import_tum({folder / "rec", camera_file(folder), 5000.0, scene_folder}).frames, 2);
    const BopScene scene = open_scene(scene_folder);
    EXPECT_EQ(scene.frames[1].stamp_s, 1305031102.1947);
    EXPECT_DOUBLE_EQ(scene.frames[1].depth_scale_mm, 0.2);
    EXPECT_FLOAT_EQ(load_depth(scene.frames[1]).depth_m[0], 1.0F);
    EXPECT_EQ(read_count_png(scene.frames[0].depth).counts[0], 1);
}

TEST(ImportTum, BadRecordingsAreRefused) {
    const fs::path folder = new_folder();
    const fs::path camera = camera_file(folder);
    const auto refused = [&](const std::string& list, const std::vector<std::string>& parts) {
        write_text(folder / "rec" / "depth.txt", list);
        expect_error([&] { import_tum({folder / "rec", camera, 5000.0, folder / "mine" / "test" / "000001"}); }, parts);
        fs::remove_all(folder / "mine");
    };
    refused("# nothing\n", {"depth.txt", "no image"});
    refused("1.0\n", {"depth.txt", "line 1"});
    refused("one a.png\n", {"depth.txt", "line 1"});
    refused("1.0 ../../secret.png\n", {"line 1", "outside"});
    refused("1.0 /etc/passwd\n", {"line 1", "outside"});
    refused("1.0 none.png\n", {"none.png", "No such file"});
}

TEST(ImportTum, ImagesWithTheSameStampAreKeptAndSaid) {
    const fs::path folder = new_folder();
    const fs::path camera = camera_file(folder);
    for (const char* name : {"a.png", "b.png", "c.png"}) {
        write_count_png(folder / name, {3, 2, std::vector<std::uint16_t>(6, 1)});
    }
    write_text(folder / "depth.txt", "2.0 c.png\n1.0 b.png\n1.0 a.png\n");
    const fs::path out = folder / "set" / "test" / "000001";
    const ImportSummary summary = import_tum({folder, camera, 5000.0, out});
    EXPECT_EQ(summary.frames, 3);
    ASSERT_EQ(summary.warnings.size(), 1U);
    EXPECT_NE(summary.warnings[0].find("1 image has the stamp of the one before"), std::string::npos);
    EXPECT_EQ(open_scene(out).frames[1].stamp_s, 1.5);  // between its neighbours'
}

TEST(ImportModel, AModelInCentimetresComesOutInMillimetres) {
    const fs::path folder = new_folder();
    // A box of 4 x 3 x 12 cm: its diagonal is 13 cm.
    std::string obj;
    for (int i = 0; i < 8; ++i) {
        obj += "v " + std::to_string(i % 2 * 4) + " " + std::to_string(i / 2 % 2 * 3) + " " +
               std::to_string(i / 4 * 12) + "\n";
    }
    for (const char* face : {"1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"})
        obj += "f " + std::string(face) + "\n";
    write_text(folder / "box.obj", obj);
    const fs::path models = folder / "mine" / "models";
    const ModelImportSummary summary = import_model({folder / "box.obj", LengthUnit::kCentimetre, 4, models});
    EXPECT_NEAR(summary.info.diameter_m, 0.13, 1e-6);
    import_model({folder / "box.obj", LengthUnit::kMillimetre, 2, models});
    const std::map<int, ModelInfo> infos = read_models_info(models / "models_info.json");
    ASSERT_EQ(infos.size(), 2U);  // the second import kept the first
    EXPECT_NEAR(infos.at(4).box_max_in_object_m.z(), 0.12, 1e-6);
    EXPECT_NEAR(infos.at(2).diameter_m, 0.013, 1e-7);
    const LoadedMesh back = load_mesh(model_path(models, 4), LengthUnit::kMillimetre);
    EXPECT_EQ(back.mesh.triangles.size(), 12U);
    EXPECT_NEAR(extent_of(back.mesh).diameter_m(), 0.13, 1e-6);
}

TEST(ImportModel, AWrongUnitIsRefused) {
    const fs::path folder = new_folder();
    write_text(folder / "a.obj", "v 0 0 0\nv 300 0 0\nv 0 300 0\nf 1 2 3\n");
    expect_error([&] { import_model({folder / "a.obj", LengthUnit::kMetre, 1, folder / "models"}); }, {"a.obj"});
    EXPECT_FALSE(fs::exists(folder / "models"));
}

TEST(Diameter, IsTheLargestDistanceForFewAndForManyPoints) {
    EXPECT_EQ(diameter_of({}), 0.0);
    EXPECT_EQ(diameter_of({{1, 2, 3}}), 0.0);
    EXPECT_DOUBLE_EQ(diameter_of({{0, 0, 0}, {3, 4, 0}, {1, 1, 1}}), 5.0);
    // Many points of an ellipsoid: the longest axis is 2 x 0.3, and two points stand at its very ends.
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 40000; ++i) {
        const double z = 2.0 * (i + 0.5) / 40000 - 1.0;
        const double r = std::sqrt(1.0 - z * z);
        points.emplace_back(static_cast<float>(0.2 * r * std::cos(2.4 * i)),
                            static_cast<float>(0.29 * r * std::sin(2.4 * i)), static_cast<float>(0.1 * z));
    }
    const Eigen::Vector3f direction = Eigen::Vector3f(1, 2, 3).normalized();
    points.emplace_back(0.3F * direction);
    points.emplace_back(-0.3F * direction);
    EXPECT_NEAR(diameter_of(points), 0.6, 1e-6);
}

}  // namespace
}  // namespace nearpose::data_set
