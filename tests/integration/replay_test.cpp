// Keeps behaviour fixed: two short simulated recordings, tracked by the default method with a fixed seed, against the
// numbers in tests/integration/replay/*.txt, 9 significant digits each.
//
// A change that is meant to alter what the estimator does writes the texts anew, and its commit shows them:
//     NEARPOSE_WRITE_REPLAY=1 build/dev/tests/integration/integration_tests --gtest_filter='Replay.*'
//
// The last bits of a number depend on the processor, the compiler and Embree. The first line of a text names those it
// was made with. Elsewhere only poses are compared, to 0.05 mm and 0.05 degrees, and the test says so.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <numbers>
#include <sstream>

#include "apps/base/version.hpp"
#include "apps/part_model/model_symmetries.hpp"
#include "apps/runs/estimator_setup.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"
#include "core/estimator.hpp"

namespace nearpose {
namespace {

constexpr double kTolerance_m = 0.05e-3;
constexpr double kTolerance_rad = 0.05 * std::numbers::pi / 180.0;
const std::string kHowToWrite =
    "If this change of behaviour is meant, write the text anew:\n  NEARPOSE_WRITE_REPLAY=1 "
    "build/dev/tests/integration/integration_tests --gtest_filter='Replay.*'";

// Names of a row's words. Pose: camera_from_object [m]; covariance of its twist [rad^2, m^2], rotation first.
constexpr std::array kColumns = {"frame", "verdict", "agreement", "x",    "y",    "z",    "qx",   "qy",
                                 "qz",    "qw",      "rr_x",      "rr_y", "rr_z", "tt_x", "tt_y", "tt_z"};
using Row = std::vector<std::string>;

struct Replay {
    std::string platform;  // what the last bits depend on
    std::vector<Row> rows;
};

// The instruction sets decide which code Embree and the mathematics library take when the program runs.
std::string instruction_sets() {
    std::string sets;
#if defined(__x86_64__)
    sets += "x86_64";
    if (__builtin_cpu_supports("avx")) sets += " avx";
    if (__builtin_cpu_supports("avx2")) sets += " avx2";
    if (__builtin_cpu_supports("fma")) sets += " fma";
    if (__builtin_cpu_supports("avx512f")) sets += " avx512f";
#elif defined(__aarch64__)
    sets += "aarch64";
#else
    sets += "unknown";
#endif
    return sets;
}

std::string this_platform() {
    std::string text = "platform: " + instruction_sets();
    std::istringstream version(program::version_text());
    for (std::string line; std::getline(version, line);) {
        std::istringstream words(line);
        std::string name, word;
        words >> name;
        if (name != "compiler" && name != "Embree") continue;
        text += ", " + (name == "Embree" ? name : std::string());
        for (bool first = name != "Embree"; words >> word; first = false) text += (first ? "" : " ") + word;
    }
    return text;
}

std::string digits(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.9g", value);
    return text.data();
}

Row row_of(int frame, const UpdateResult& result) {
    Row row = {std::to_string(frame), to_string(result.verdict), digits(result.pixels.agreement())};
    const Pose& pose = result.camera_from_object;
    for (int axis = 0; axis < 3; ++axis) row.push_back(digits(pose.translation[axis]));
    const double sign = pose.rotation.w() < 0.0 ? -1.0 : 1.0;
    for (int axis = 0; axis < 4; ++axis) row.push_back(digits(sign * pose.rotation.coeffs()[axis]));
    for (int axis = 0; axis < 6; ++axis) row.push_back(digits(result.covariance(axis, axis)));
    return row;
}

// As the program does it, on a recording of the engine block in a small image.
Replay replay(simulate::Scenario scenario, int frames, bool with_mask) {
    const simulate::EmbeddedPart part = simulate::embedded_part("engine_block");
    simulate::RecordingOptions options;
    options.scenario = scenario;
    options.num_frames = frames;
    options.seed = 1;
    options.camera = {320, 240, 300.0, 300.0, 159.5, 119.5};
    const simulate::Recording recording(part.mesh, part.part, options);
    program::EstimatorSetup setup;
    setup.seed = 1;
    setup.symmetries = program::find_symmetries(part.mesh);
    PoseEstimator estimator = program::make_estimator(setup, program::make_view_generator(setup, part.mesh));
    Replay made{this_platform(), {}};
    std::optional<Pose> camera_from_world_before;
    for (int index = 0; index < recording.num_frames(); ++index) {
        const simulate::SimulatedFrame frame = recording.frame(index);
        std::optional<Pose> now_from_before;
        if (camera_from_world_before) now_from_before = frame.camera_from_world * camera_from_world_before->inverse();
        camera_from_world_before = frame.camera_from_world;
        const Observation observation = make_observation(
            frame.depth, options.camera, with_mask ? std::optional<Mask>(frame.given_mask) : std::nullopt);
        made.rows.push_back(row_of(frame.id, estimator.update(observation, now_from_before)));
    }
    return made;
}

void write(const std::string& file, const Replay& replay) {
    std::ofstream text(file);
    text << replay.platform << "\n";
    for (const char* name : kColumns) text << name << (name == kColumns.back() ? "\n" : " ");
    for (const Row& row : replay.rows) {
        for (std::size_t i = 0; i < row.size(); ++i) text << row[i] << (i + 1 == row.size() ? "\n" : " ");
    }
    ASSERT_TRUE(text.good()) << file << " cannot be written";
    std::cout << file << " is written anew\n";
}

Replay read(const std::string& file) {
    std::ifstream text(file);
    Replay replay;
    std::string line;
    std::getline(text, replay.platform);
    std::getline(text, line);  // names of the columns
    while (std::getline(text, line)) {
        std::istringstream words(line);
        Row& row = replay.rows.emplace_back();
        for (std::string word; words >> word;) row.push_back(word);
    }
    return replay;
}

Pose pose_of(const Row& row) {
    const auto number = [&](std::size_t column) { return std::strtod(row[column].c_str(), nullptr); };
    Pose pose;
    pose.translation = {number(3), number(4), number(5)};
    pose.rotation = Eigen::Quaterniond(number(9), number(6), number(7), number(8)).normalized();
    return pose;
}

void expect_near(const Row& now, const Row& before, const std::string& file) {
    const Pose a = pose_of(now), b = pose_of(before);
    EXPECT_LT((a.translation - b.translation).norm(), kTolerance_m) << file << ", frame " << now[0];
    EXPECT_LT(a.rotation.angularDistance(b.rotation), kTolerance_rad) << file << ", frame " << now[0];
}

// The first difference alone: what follows comes of it.
void expect_same(const Replay& now, const Replay& before, const std::string& file) {
    for (std::size_t k = 0; k < now.rows.size(); ++k) {
        for (std::size_t i = 0; i < kColumns.size(); ++i) {
            if (now.rows[k][i] == before.rows[k][i]) continue;
            FAIL() << file << ", frame " << now.rows[k][0] << ": " << kColumns[i] << " is now " << now.rows[k][i]
                   << ", the text has " << before.rows[k][i] << ".\n"
                   << kHowToWrite;
        }
    }
}

void check(const std::string& name, const Replay& now) {
    const std::string file = "tests/integration/replay/" + name + ".txt";
    if (const char* asked = std::getenv("NEARPOSE_WRITE_REPLAY"); asked != nullptr && std::string(asked) == "1") {
        write(file, now);
        return;
    }
    const Replay before = read(file);
    ASSERT_EQ(now.rows.size(), before.rows.size()) << file << ": another number of frames. " << kHowToWrite;
    for (const Row& row : before.rows) ASSERT_EQ(row.size(), kColumns.size()) << file << ": a row is damaged";
    if (now.platform == before.platform) return expect_same(now, before, file);
    std::cout << file
              << " was made on another platform; poses are compared to 0.05 mm and 0.05 degrees alone:\n  there "
              << before.platform << "\n  here  " << now.platform << "\n";
    for (std::size_t k = 0; k < now.rows.size(); ++k) expect_near(now.rows[k], before.rows[k], file);
}

TEST(Replay, PistonWithMaskAndKnownArm) {
    check("piston", replay(simulate::Scenario::kPiston, 10, true));
}

TEST(Replay, ClutterWithoutMask) {
    check("clutter", replay(simulate::Scenario::kClutter, 6, false));
}

}  // namespace
}  // namespace nearpose
