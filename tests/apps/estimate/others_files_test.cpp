// estimate on recordings as other people's tools write them: what is taken, and what is said, once.
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/image_files.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/data_set/result_csv.hpp"
#include "tests/apps/estimate/estimate_line.hpp"
#include "tests/apps/support/contains.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

namespace fs = std::filesystem;

struct OddFile {
    const char* name;
    std::function<void(const TinyScene&)> alter;
    const char* said;  // empty: nothing is to be said
    double tolerance_m = 1e-3;
};

void PrintTo(const OddFile& odd, std::ostream* stream) {
    *stream << odd.name;
}

void edit_frames(const TinyScene& scene, const std::function<void(int, nlohmann::json&)>& edit) {
    const fs::path file = scene.scene() / "scene_camera.json";
    nlohmann::json json = nlohmann::json::parse(read_text(file));
    for (auto& [id, frame] : json.items()) edit(std::stoi(id), frame);
    write_text(file, json.dump());
}

void rename_all(const fs::path& folder, const std::function<std::string(int)>& name) {
    for (int id = 0; id < 3; ++id) {
        for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
            if (!entry.path().filename().string().starts_with("00000" + std::to_string(id))) continue;
            fs::rename(entry.path(), folder / name(id));
            break;
        }
    }
}

void edit_masks(const TinyScene& scene, const std::function<Mask(const Mask&)>& edit) {
    for (int id = 0; id < 3; ++id) {
        const fs::path file = data_set::mask_path(scene.scene(), id, 0);
        data_set::write_mask_png(file, edit(data_set::read_mask_png(file)));
    }
}

Mask twice_as_large(const Mask& mask) {
    Mask result{2 * mask.width, 2 * mask.height, {}};
    for (int v = 0; v < result.height; ++v) {
        for (int u = 0; u < result.width; ++u) {
            result.value.push_back(mask.value[static_cast<std::size_t>(v / 2 * mask.width + u / 2)]);
        }
    }
    return result;
}

// A uint16 array of NumPy's, of the same counts.
void as_npy(const TinyScene& scene) {
    for (int id = 0; id < 3; ++id) {
        const fs::path file = data_set::depth_path(scene.scene(), id);
        const data_set::CountImage image = data_set::read_count_png(file);
        std::string header = "{'descr': '<u2', 'fortran_order': False, 'shape': (" + std::to_string(image.height) +
                             ", " + std::to_string(image.width) + "), }";
        header.resize(117, ' ');
        std::string bytes = std::string("\x93NUMPY\x01\0\x76\0", 10) + header + "\n";
        for (const std::uint16_t count : image.counts) {
            bytes += static_cast<char>(count & 0xff);
            bytes += static_cast<char>(count >> 8);
        }
        write_text(scene.scene() / ("depth/" + std::to_string(id) + ".npy"), bytes);
        fs::remove(file);
    }
}

class OddFileTest : public testing::TestWithParam<OddFile> {};

// The poses are right, every frame is read, and what is odd stands in one line.
TEST_P(OddFileTest, IsTakenAndSaidOnce) {
    const TinyScene scene;
    GetParam().alter(scene);
    const Outcome outcome = run_nearpose(estimate(scene, ""));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    int said = 0;
    for (const std::string& line : lines_of(outcome.err)) {
        const bool usual = contains(line, "verdicts of") || contains(line, " lack") || contains(line, "as in frame 0");
        if (!usual) ++said;
        EXPECT_TRUE(usual || contains(line, GetParam().said)) << line;
        EXPECT_FALSE(contains(line, "error")) << line;
    }
    EXPECT_EQ(said, *GetParam().said == '\0' ? 0 : 1) << outcome.err;
    const auto rows = data_set::read_pose_csv(scene.file("poses.csv"));
    ASSERT_EQ(rows.size(), 3U);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Eigen::Vector3d off = rows[i].camera_from_object.translation - scene.truth()[i].translation;
        EXPECT_LT(off.norm(), GetParam().tolerance_m) << i;
    }
}

void null_motion(const TinyScene& scene) {
    edit_frames(scene, [](int id, nlohmann::json& frame) {
        if (id == 1) frame["cam_R_w2c"] = nullptr;
    });
}
void few_digits(const TinyScene& scene) {
    edit_frames(scene, [](int, nlohmann::json& frame) {
        for (auto& element : frame["cam_R_w2c"]) element = element.get<double>() * 1.002;
    });
}
void rows_of_text(const TinyScene& scene) {
    edit_frames(scene, [](int, nlohmann::json& frame) {
        for (const char* key : {"cam_K", "cam_R_w2c"}) {
            nlohmann::json rows;
            for (std::size_t i = 0; i < 9; ++i) rows[i / 3][i % 3] = frame[key][i].dump();
            frame[key] = rows;
        }
    });
}
void stamps_back(const TinyScene& scene) {
    edit_frames(scene, [](int id, nlohmann::json& frame) { frame["timestamp"] = id == 1 ? 0.0 : 0.1 * id; });
}
void no_scale(const TinyScene& scene) {
    edit_frames(scene, [](int, nlohmann::json& frame) { frame.erase("depth_scale"); });
    for (int id = 0; id < 3; ++id) {  // millimetres
        const fs::path file = data_set::depth_path(scene.scene(), id);
        data_set::CountImage image = data_set::read_count_png(file);
        for (std::uint16_t& count : image.counts) count = static_cast<std::uint16_t>((count + 5) / 10);
        data_set::write_count_png(file, image);
    }
}
void unpadded(const TinyScene& scene) {
    rename_all(scene.scene() / "depth", [](int id) { return std::to_string(id) + ".PNG"; });
    rename_all(scene.scene() / "mask_visib", [](int id) { return std::to_string(id) + "_0.png"; });
}
void first_mask_only(const TinyScene& scene) {
    for (const int id : {1, 2}) fs::remove(data_set::mask_path(scene.scene(), id, 0));
}
void large_masks(const TinyScene& scene) {
    edit_masks(scene, twice_as_large);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, OddFileTest,
    testing::Values(OddFile{"motion_null_in_one_frame", null_motion, "1/cam_R_w2c"},
                    OddFile{"rotations_of_few_digits", few_digits, "nearest rotation"},
                    OddFile{"matrices_as_rows_of_text", rows_of_text, ""},
                    OddFile{"a_stamp_goes_backwards", stamps_back, "1: the timestamp 0 repeats or goes backwards"},
                    OddFile{"no_depth_scale", no_scale, "no depth_scale", 3e-3},
                    OddFile{"names_unpadded", unpadded, ""}, OddFile{"depth_as_npy", as_npy, ""},
                    OddFile{"masks_of_double_size", large_masks, "320 x 240 pixels, the depth image 160 x 120"}),
    [](const testing::TestParamInfo<OddFile>& odd) { return std::string(odd.param.name); });

TEST(OthersFiles, FramesWithoutAMaskAreEstimatedWithoutOne) {
    const TinyScene scene;
    first_mask_only(scene);
    const Outcome outcome = run_nearpose(estimate(scene, ""));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "000001_000000.png: there is no such mask")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "as in frame 1, so in 1 more frame (the last: 2)")) << outcome.err;
    EXPECT_EQ(data_set::read_pose_csv(scene.file("poses.csv")).size(), 3U);
}

TEST(OthersFiles, TheFirstFramesMaskAloneGivesWhatItGivesWithoutTheOthers) {
    const TinyScene scene;
    const Outcome first = run_nearpose(estimate(scene, "--mask-first-frame"));
    EXPECT_EQ(first.exit_code, 0) << first.err;
    EXPECT_FALSE(contains(first.err, "mask_visib")) << first.err;
    const auto with_option = data_set::read_pose_csv(scene.file("poses.csv"));
    first_mask_only(scene);
    ASSERT_EQ(run_nearpose(estimate(scene, "")).exit_code, 0);
    const auto without_files = data_set::read_pose_csv(scene.file("poses.csv"));
    ASSERT_EQ(with_option.size(), without_files.size());
    for (std::size_t i = 0; i < with_option.size(); ++i) EXPECT_EQ(with_option[i].score, without_files[i].score);
    EXPECT_EQ(run_nearpose(estimate(scene, "--mask-first-frame --no-mask")).exit_code, 2);
}

// An image in which nothing was measured could be read.
TEST(OthersFiles, AnEmptyFrameIsNoUnreadableOne) {
    const TinyScene scene;
    data_set::write_count_png(data_set::depth_path(scene.scene(), 1), {160, 120, std::vector<std::uint16_t>(19200, 0)});
    for (const char* more : {"", "--no-mask"}) {
        const Outcome outcome = run_nearpose(estimate(scene, more));
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, "notice: frame 1: the object is not seen")) << outcome.err;
        EXPECT_FALSE(contains(outcome.err, "error")) << outcome.err;
    }
    EXPECT_TRUE(contains(run_nearpose(estimate(scene, "--no-mask")).err, "no pixel has a depth"));
}

TEST(OthersFiles, TheSameErrorIsSaidOnceWithWhatTheFolderHolds) {
    const TinyScene scene;
    for (int id = 0; id < 3; ++id) {
        fs::rename(data_set::depth_path(scene.scene(), id), scene.scene() / ("depth/" + std::to_string(id) + ".jp2"));
    }
    const Outcome outcome = run_nearpose(estimate(scene, "--quiet"));
    EXPECT_EQ(outcome.exit_code, 1);
    const std::vector<std::string> lines = lines_of(outcome.err);
    ASSERT_EQ(lines.size(), 3U) << outcome.err;
    EXPECT_TRUE(contains(lines[0], "000000.png: No such file")) << lines[0];
    EXPECT_TRUE(contains(lines[0], "3 files: 0.jp2 ... 2.jp2")) << lines[0];
    EXPECT_TRUE(contains(lines[1], "as in frame 0, so in 2 more frames (the last: 2)")) << lines[1];
    EXPECT_TRUE(contains(lines[2], "none of the 3 frames could be read")) << lines[2];
}

TEST(OthersFiles, IntrinsicsOfAnotherSizeAreAskedAboutBeforeTheRun) {
    const TinyScene scene;
    edit_frames(scene, [](int, nlohmann::json& frame) { frame["cam_K"] = {300, 0, 159.5, 0, 300, 119.5, 0, 0, 1}; });
    const Outcome outcome = run_nearpose(estimate(scene, "--last 0"));
    EXPECT_TRUE(contains(lines_of(outcome.err).at(0), "about 320 x 240: of another resolution?")) << outcome.err;
}

TEST(OthersFiles, ADepthScaleThatMakesThePartTooSmallIsAskedAbout) {
    const TinyScene scene;
    edit_frames(scene, [](int, nlohmann::json& frame) { frame["depth_scale"] = 0.025; });
    for (const char* more : {"--last 0", "--last 0 --no-mask"}) {
        const Outcome outcome = run_nearpose(estimate(scene, more));
        EXPECT_TRUE(contains(outcome.err, "check depth_scale")) << outcome.err;
    }
}

TEST(OthersFiles, RecordingsOfOtherProgramsAreNamedWithWhatToDo) {
    const TinyScene scene;
    const auto said = [&](const std::string& name) {
        return run_nearpose("estimate --scene " + scene.file(name).string() + " --models " + scene.models().string() +
                            " --object 1 --out -")
            .err;
    };
    for (const char* name : {"a.bag", "a.mcap", "a.db3", "a.ZDF", "a.svo"}) write_text(scene.file(name), "");
    EXPECT_TRUE(contains(said("a.bag"), "rs-convert -d -r"));
    EXPECT_TRUE(contains(said("a.mcap"), "rosbags"));
    EXPECT_TRUE(contains(said("a.db3"), "rosbags"));
    EXPECT_TRUE(contains(said("a.ZDF"), "--clouds"));
    EXPECT_TRUE(contains(said("a.svo"), "16-bit PNG"));
    fs::create_directories(scene.file("bag"));
    write_text(scene.file("bag/metadata.yaml"), "");
    EXPECT_TRUE(contains(said("bag"), "bag of ROS 2"));
    EXPECT_TRUE(contains(said("none.bag"), "is not a folder"));
}

}  // namespace
}  // namespace nearpose::program_tests
