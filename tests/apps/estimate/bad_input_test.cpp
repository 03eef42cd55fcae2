// estimate where a frame, a file or an option is bad: what it says, and how it ends.
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/data_set/png_file.hpp"
#include "apps/data_set/result_csv.hpp"
#include "tests/apps/estimate/estimate_line.hpp"
#include "tests/apps/support/contains.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

namespace fs = std::filesystem;

struct BadFrame {
    const char* name;
    std::function<void(const fs::path& scene)> spoil;  // frame 1
    const char* said;                                  // with the file
};

void PrintTo(const BadFrame& bad, std::ostream* stream) {
    *stream << bad.name;
}

class BadFrameTest : public testing::TestWithParam<BadFrame> {};

// One broken frame does not end the run: it is named, a prediction stands in, and the exit code says so.
TEST_P(BadFrameTest, IsReportedAndPredicted) {
    const TinyScene scene;
    GetParam().spoil(scene.scene());
    const Outcome outcome = run_nearpose(estimate(scene, ""));
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "nearpose: error: frame 1: ")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "000001")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, GetParam().said)) << outcome.err;
    const auto rows = data_set::read_pose_csv(scene.file("poses.csv"));
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_LT(rows[1].score, 0.5 * rows[0].score);
    EXPECT_GT(rows[2].score, rows[1].score);
}

const fs::path kDepth1 = "depth/000001.png";
const fs::path kMask1 = "mask_visib/000001_000000.png";

void make_grey_8_bit(const fs::path& scene) {
    data_set::write_mask_png(scene / kDepth1, {160, 120, std::vector<std::uint8_t>(160 * 120, 9)});
}
void make_counts(const fs::path& scene, int width, int height, std::uint16_t value) {
    data_set::write_count_png(
        scene / kDepth1, {width, height, std::vector<std::uint16_t>(static_cast<std::size_t>(width * height), value)});
}

INSTANTIATE_TEST_SUITE_P(
    Files, BadFrameTest,
    testing::Values(BadFrame{"missing", [](const fs::path& s) { fs::remove(s / kDepth1); }, "depth/000001.png"},
                    BadFrame{"truncated", [](const fs::path& s) { fs::resize_file(s / kDepth1, 200); },
                             "depth/000001.png"},
                    BadFrame{"nothing", [](const fs::path& s) { fs::resize_file(s / kDepth1, 0); }, "depth/000001.png"},
                    BadFrame{"eight_bits", make_grey_8_bit, "8"},
                    BadFrame{"wrong_size", [](const fs::path& s) { make_counts(s, 80, 60, 900); }, "80"},
                    BadFrame{"mask_size",
                             [](const fs::path& s) {
                                 data_set::write_mask_png(s / kMask1, {80, 61, std::vector<std::uint8_t>(4880, 255)});
                             },
                             "mask_visib"}),
    [](const testing::TestParamInfo<BadFrame>& frame) { return std::string(frame.param.name); });

TEST(Estimate, NoReadableFrameIsAFailure) {
    const TinyScene scene(2);
    fs::remove_all(scene.scene() / "depth");
    const Outcome outcome = run_nearpose(estimate(scene, ""));
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "none of the 2 frames")) << outcome.err;
}

struct BadSetUp {
    const char* name;
    std::function<void(const TinyScene&)> spoil;
    const char* more;  // options
    const char* said;
};

void replace_in(const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = read_text(file);
    const std::size_t place = text.find(from);
    ASSERT_NE(place, std::string::npos) << from << " in " << text.substr(0, 400);
    write_text(file, text.replace(place, from.size(), to));
}

void PrintTo(const BadSetUp& bad, std::ostream* stream) {
    *stream << bad.name;
}

class BadSetUpTest : public testing::TestWithParam<BadSetUp> {};

// What the run cannot do without ends it before it begins, with one line that names the file.
TEST_P(BadSetUpTest, EndsWithOneLine) {
    const TinyScene scene(2);
    GetParam().spoil(scene);
    const Outcome outcome = run_nearpose(estimate(scene, GetParam().more));
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, GetParam().said)) << outcome.err;
    EXPECT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
    EXPECT_FALSE(fs::exists(scene.file("poses.csv")));
}

void edit_camera(const TinyScene& scene, const std::function<void(nlohmann::json&)>& edit) {
    const fs::path file = scene.scene() / "scene_camera.json";
    nlohmann::json json = nlohmann::json::parse(read_text(file));
    edit(json["1"]);
    write_text(file, json.dump());
}
void no_intrinsics(const TinyScene& s) {
    edit_camera(s, [](nlohmann::json& frame) { frame.erase("cam_K"); });
}
void skewed(const TinyScene& s) {
    edit_camera(s, [](nlohmann::json& frame) { frame["cam_K"][1] = 0.3; });
}
void not_a_number(const TinyScene& s) {
    edit_camera(s, [](nlohmann::json& frame) { frame["cam_K"][0] = "here"; });
    replace_in(s.scene() / "scene_camera.json", "\"here\"", "NaN");
}
void broken_json(const TinyScene& s) {
    const fs::path file = s.scene() / "scene_camera.json";
    fs::resize_file(file, fs::file_size(file) / 2);
}
void empty_mesh(const TinyScene& s) {
    write_text(s.models() / "obj_000001.ply",
               "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
               "element face 0\nproperty list uchar int vertex_indices\nend_header\n");
}
void wrong_unit(const TinyScene& s) {
    const fs::path file = s.models() / "obj_000001.ply";
    write_text(
        file,
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n0.1 0 0\n0 0.1 0\n3 0 1 2\n");
}
void no_scene(const TinyScene& s) {
    fs::remove_all(s.scene());
}
void no_pose_file(const TinyScene& s) {
    fs::remove(s.file("start.json"));
}
void nothing(const TinyScene&) {}

INSTANTIATE_TEST_SUITE_P(Files, BadSetUpTest,
                         testing::Values(BadSetUp{"no_scene", no_scene, "", "is not a folder"},
                                         BadSetUp{"no_intrinsics", no_intrinsics, "", "cam_K"},
                                         BadSetUp{"skewed_camera", skewed, "", "1/cam_K"},
                                         BadSetUp{"not_a_number", not_a_number, "", "scene_camera.json"},
                                         BadSetUp{"broken_json", broken_json, "", "scene_camera.json"},
                                         BadSetUp{"empty_mesh", empty_mesh, "", "obj_000001.ply"},
                                         BadSetUp{"wrong_unit", wrong_unit, "", "obj_000001.ply"},
                                         BadSetUp{"no_pose_file", no_pose_file, "", "start.json"},
                                         BadSetUp{"no_frames", nothing, "--first 90", "has no frame"}),
                         [](const testing::TestParamInfo<BadSetUp>& set_up) { return std::string(set_up.param.name); });

TEST(Estimate, NoSuchObjectListsWhichThereAre) {
    const TinyScene scene(2);
    const Outcome outcome = run_nearpose("estimate --scene " + scene.scene().string() + " --models " +
                                         scene.models().string() + " --object 5 --mask-index 0 --out -");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_TRUE(contains(outcome.err, "obj_000005.ply")) << outcome.err;
}

TEST(Estimate, OutputsThatCannotBeWrittenAreFailures) {
    const TinyScene scene(2);
    write_text(scene.file("file"), "");
    for (const std::string& bad : {std::string("/dev/full"), scene.file("file/poses.csv").string(),
                                   scene.models().string(), std::string("/proc/no/such/poses.csv")}) {
        const Outcome outcome = run_nearpose("estimate " + scene.input() + "--quiet --out " + bad);
        EXPECT_EQ(outcome.exit_code, 1) << bad;
        EXPECT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
    }
    for (const char* option : {"--log", "--trajectory"}) {
        EXPECT_EQ(run_nearpose(estimate(scene, std::string(option) + " /dev/full")).exit_code, 1) << option;
    }
    const Outcome stdout_full = run_shell("\"$NEARPOSE\" estimate " + scene.input() + "--out - >/dev/full");
    EXPECT_EQ(stdout_full.exit_code, 1) << stdout_full.err;
}

}  // namespace
}  // namespace nearpose::program_tests
