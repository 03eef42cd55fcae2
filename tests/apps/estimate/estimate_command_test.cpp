// estimate run on small scenes: what it writes.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/data_set/bop_writer.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/data_set/result_csv.hpp"
#include "apps/data_set/trajectory_tum.hpp"
#include "tests/apps/estimate/estimate_line.hpp"
#include "tests/apps/support/contains.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

namespace fs = std::filesystem;

// The text of a result file without its column of times.
std::string without_times(const std::string& csv) {
    std::string text;
    for (const std::string& line : lines_of(csv)) text += line.substr(0, line.rfind(',')) + "\n";
    return text;
}

TEST(Estimate, WritesEveryFrameAsTheReadersOfItsFormatsExpect) {
    const TinyScene scene(4);
    const Outcome outcome =
        run_nearpose("estimate " + scene.input_from_nothing() + "--out " + scene.file("poses.csv").string() +
                     " --log " + scene.file("log.jsonl").string() + " --trajectory " +
                     scene.file("poses.tum").string() + " --pictures " + scene.file("pictures").string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(outcome.out.empty());
    EXPECT_FALSE(contains(outcome.err, "\r")) << "a progress bar in a pipe";

    const std::string csv = read_text(scene.file("poses.csv"));
    EXPECT_EQ(lines_of(csv).front(), "scene_id,im_id,obj_id,score,R,t,time");
    EXPECT_FALSE(contains(csv, "\n\n"));
    const std::vector<data_set::PoseRow> rows = data_set::read_pose_csv(scene.file("poses.csv"));
    ASSERT_EQ(rows.size(), 4U);
    for (int k = 0; k < 4; ++k) {
        EXPECT_EQ(rows[k].scene_id, 7);
        EXPECT_EQ(rows[k].image_id, k);
        EXPECT_EQ(rows[k].object_id, 1);
        EXPECT_GE(rows[k].time_s, 0.0);
        EXPECT_TRUE(fs::is_regular_file(scene.file("pictures") / ("00000" + std::to_string(k) + ".png")));
    }
    EXPECT_EQ(data_set::read_tum(scene.file("poses.tum")).size(), 4U);

    const std::vector<std::string> log = lines_of(read_text(scene.file("log.jsonl")));
    ASSERT_EQ(log.size(), 5U);
    EXPECT_EQ(nlohmann::json::parse(log[0])["format"], 1);
    const nlohmann::json frame = nlohmann::json::parse(log[4]);
    EXPECT_EQ(frame["status"], "estimated");
    EXPECT_EQ(frame["covariance"].size(), 36U);
    EXPECT_EQ(frame["covariance_ros"].size(), 36U);
    EXPECT_GE(frame["quaternion_xyzw"][3].get<double>(), 0.0);
    EXPECT_NEAR(1e3 * frame["translation_m"][2].get<double>(), 1e3 * rows[3].camera_from_object.translation.z(), 1e-6);
    for (const char* key : {"effective_sample_size", "resampled", "mode_replaced", "points_observed", "counts",
                            "seconds", "modes", "score", "cost"}) {
        EXPECT_TRUE(frame.contains(key)) << key;
    }
}

// The log and the trajectory say the same, and a frame without the camera's pose has neither.
TEST(Estimate, LogsThePartInTheWorldWhereTheCamerasPoseIsKnown) {
    const TinyScene scene(4);
    const fs::path camera_file = scene.scene() / "scene_camera.json";
    nlohmann::json cameras = nlohmann::json::parse(read_text(camera_file));
    cameras["1"].erase("cam_R_w2c");
    cameras["1"].erase("cam_t_w2c");
    write_text(camera_file, cameras.dump());
    const Outcome outcome =
        run_nearpose("estimate " + scene.input() + "--run " + scene.file("run").string() + " --trajectory-frame world");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::vector<data_set::StampedPose> rows = data_set::read_tum(scene.file("run/poses.tum"));
    ASSERT_EQ(rows.size(), 3U);
    const std::vector<std::string> log = lines_of(read_text(scene.file("run/log.jsonl")));
    ASSERT_EQ(log.size(), 5U);
    for (std::size_t frame = 0, row = 0; frame < 4; ++frame) {
        const nlohmann::json line = nlohmann::json::parse(log[frame + 1]);
        EXPECT_EQ(line.contains("world_from_object"), frame != 1) << frame;
        if (frame == 1) continue;
        const nlohmann::json& world = line["world_from_object"];
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(world["translation_m"][axis].get<double>(), rows[row].pose.translation[axis], 1e-9);
        EXPECT_GT(world["covariance"][21].get<double>(), line["covariance"][21].get<double>());
        ++row;
    }
}

TEST(Estimate, StartedAtAPoseItIsAtTheTruth) {
    const TinyScene scene;
    const Outcome outcome = run_nearpose(estimate(scene, ""));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const data_set::PoseRow& row : data_set::read_pose_csv(scene.file("poses.csv"))) {
        EXPECT_LT((row.camera_from_object.translation - scene.truth()[row.image_id].translation).norm(), 0.002);
        EXPECT_LT(angle_between(row.camera_from_object.rotation, scene.truth()[row.image_id].rotation), 0.02);
    }
}

TEST(Estimate, SameBitsForAnyNumberOfThreads) {
    const TinyScene scene(2);
    std::string first;
    for (const char* threads : {"1", "2", "3"}) {
        std::string input = scene.input_from_nothing();
        input.replace(input.find("--threads 1"), 11, std::string("--threads ") + threads);
        const Outcome outcome = run_nearpose("estimate " + input + "--out -");
        ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
        if (first.empty()) first = without_times(outcome.out);
        EXPECT_EQ(without_times(outcome.out), first) << threads;
    }
}

TEST(Estimate, OtherViewsAndThePapersMethodRun) {
    const TinyScene scene(1);
    for (const char* options : {"--views raster", "--views sphere", "--method paper"}) {
        EXPECT_EQ(run_nearpose(estimate(scene, options)).exit_code, 0) << options;
        EXPECT_EQ(data_set::read_pose_csv(scene.file("poses.csv")).size(), 1U) << options;
    }
}

TEST(Estimate, StandardOutputHoldsTheResultsAlone) {
    const TinyScene scene(2);
    const Outcome outcome = run_nearpose("estimate " + scene.input() + "--no-mask --out -");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    ASSERT_EQ(lines_of(outcome.out).size(), 3U) << outcome.out;
    EXPECT_EQ(lines_of(outcome.out)[1].rfind("7,0,1,", 0), 0U);
    const Outcome piped =
        run_shell("\"$NEARPOSE\" estimate " + scene.input() + "--out - | head -n 1; exit ${PIPESTATUS[0]}");
    EXPECT_EQ(piped.exit_code, 0);
    EXPECT_EQ(lines_of(piped.out).size(), 1U);
    EXPECT_EQ(piped.err, "");
}

TEST(Estimate, FirstAndLastNameFrames) {
    const TinyScene scene(4);
    EXPECT_EQ(run_nearpose(estimate(scene, "--first 1 --last 2 --scene-id 3")).exit_code, 0);
    const auto rows = data_set::read_pose_csv(scene.file("poses.csv"));
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0].image_id, 1);
    EXPECT_EQ(rows[1].scene_id, 3);
}

TEST(Estimate, WithoutMasksItSaysSo) {
    const TinyScene scene(2);
    fs::remove_all(scene.scene() / "mask_visib");
    const Outcome outcome = run_nearpose(estimate(scene, ""));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "mask_visib")) << outcome.err;
    EXPECT_EQ(run_nearpose(estimate(scene, "--quiet")).err, "");
}

TEST(Estimate, AnUnseenObjectIsPredicted) {
    const TinyScene scene;
    data_set::write_mask_png(scene.scene() / "mask_visib/000001_000000.png",
                             {160, 120, std::vector<std::uint8_t>(160 * 120, 0)});
    const Outcome outcome = run_nearpose(estimate(scene, ""));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "frame 1: the object is not seen")) << outcome.err;
    const auto rows = data_set::read_pose_csv(scene.file("poses.csv"));
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_LT(rows[1].score, 0.5 * rows[0].score);
    // The control still moves it: from the estimate before as the true pose moved.
    const Pose motion = scene.truth()[1] * scene.truth()[0].inverse();
    const Pose expected = motion * rows[0].camera_from_object;
    EXPECT_LT((rows[1].camera_from_object.translation - expected.translation).norm(), 1e-6);
}

TEST(Estimate, FramesBeforeTheFirstPoseHaveNoRow) {
    const TinyScene scene(2);
    fs::remove(scene.scene() / "depth/000000.png");
    const Outcome outcome = run_nearpose("estimate " + scene.input_from_nothing() + "--out -");
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_TRUE(contains(outcome.err, "there is no pose yet")) << outcome.err;
    ASSERT_EQ(lines_of(outcome.out).size(), 2U) << outcome.out;
    EXPECT_EQ(lines_of(outcome.out)[1].rfind("7,1,1,", 0), 0U) << outcome.out;
}

// Starts a long run, sends `signal` once two rows are there, and returns the wait status.
int signal_after_two_rows(const TinyScene& scene, int signal) {
    const pid_t child = fork();
    if (child == 0) {
        const std::string command = "exec '" NEARPOSE_PROGRAM "' " + estimate(scene, "--quiet 2>/dev/null");
        execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
        _exit(127);
    }
    int status = 0;
    while (lines_of(read_text(scene.file("poses.csv"))).size() < 3 && waitpid(child, &status, WNOHANG) == 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    kill(child, signal);
    waitpid(child, &status, 0);
    return status;
}

TEST(Estimate, AStoppedRunLeavesWholeRows) {
    for (const int signal : {SIGKILL, SIGINT}) {
        const TinyScene scene(60);
        const int status = signal_after_two_rows(scene, signal);
        if (signal == SIGINT) {
            ASSERT_TRUE(WIFEXITED(status));
            EXPECT_EQ(WEXITSTATUS(status), 130);
        }
        EXPECT_EQ(read_text(scene.file("poses.csv")).back(), '\n');
        const auto rows = data_set::read_pose_csv(scene.file("poses.csv"));
        EXPECT_GE(rows.size(), 2U);
        EXPECT_LT(rows.size(), 60U);
    }
}

}  // namespace
}  // namespace nearpose::program_tests
