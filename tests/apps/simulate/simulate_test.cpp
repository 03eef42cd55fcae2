#include "apps/simulate/simulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "apps/data_set/bop_ground_truth.hpp"
#include "apps/data_set/bop_masks.hpp"
#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/json_file.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/data_set/trajectory_tum.hpp"
#include "apps/scenes/parts.hpp"
#include "raycast/depth_renderer.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose::simulate {
namespace {

namespace fs = std::filesystem;

const auto kGoOn = [] { return true; };

// A folder of this test's own, empty at its start.
fs::path fresh_folder(const std::string& name) {
    const fs::path folder = fs::path(testing::TempDir()) / "simulate_test" / name;
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

SimulationOptions small_options(const fs::path& out) {
    SimulationOptions options;
    options.data_set = out;
    options.recording.num_frames = 5;
    options.recording.camera = {160, 120, 150.0, 150.0, 79.5, 59.5};
    options.num_threads = 1;
    return options;
}

SimulationSummary simulate_block(const SimulationOptions& options) {
    const Mesh mesh = embedded_part("engine_block").mesh;
    return write_data_set(mesh, engine_block_part(extent_of(mesh)), options, kGoOn);
}

std::map<std::string, std::string> files_below(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        std::ifstream file(entry.path(), std::ios::binary);
        files[fs::relative(entry.path(), folder).string()] = {std::istreambuf_iterator<char>(file), {}};
    }
    return files;
}

TEST(Simulate, SameSeedSameBytesForAnyNumberOfThreads) {
    const fs::path folder = fresh_folder("bytes");
    SimulationOptions options = small_options(folder / "one");
    ASSERT_TRUE(simulate_block(options).complete);
    options.data_set = folder / "two";
    options.num_threads = 2;
    ASSERT_TRUE(simulate_block(options).complete);
    options.data_set = folder / "other";
    options.recording.seed = 2;
    ASSERT_TRUE(simulate_block(options).complete);
    const auto one = files_below(folder / "one"), other = files_below(folder / "other");
    EXPECT_EQ(one.size(), 5u * 3u + 3u + 1u + 4u + 2u);
    EXPECT_TRUE(one == files_below(folder / "two"));
    for (const char* name : {"test/000001/depth/000000.png", "test/000001/scene_camera.json", "truth.tum"}) {
        EXPECT_NE(one.at(name), other.at(name)) << name;
    }
}

TEST(Simulate, WrittenFilesReadBackAndAgree) {
    const fs::path folder = fresh_folder("read");
    const SimulationOptions options = small_options(folder / "set");
    EXPECT_EQ(simulate_block(options).frames_without_part, 0);
    const data_set::BopScene scene = data_set::open_scene(folder / "set/test/000001");
    const std::map<int, Pose> truth = data_set::read_ground_truth(scene.folder, 1);
    const auto trajectory = data_set::read_tum(folder / "set/truth.tum");
    ASSERT_EQ(scene.frames.size(), 5u);
    ASSERT_EQ(trajectory.size(), 5u);
    EXPECT_TRUE(scene.has_timestamps);
    const Pose object_in_world = scene.frames[0].camera_from_world->inverse() * truth.at(0);
    for (std::size_t i = 0; i < 5; ++i) {
        const data_set::Frame& frame = scene.frames[i];
        EXPECT_EQ(frame.camera.fx, 150.0);
        EXPECT_EQ(frame.camera.width, 160);
        EXPECT_EQ(frame.depth_scale_mm, 0.1);
        EXPECT_NEAR(frame.stamp_s, static_cast<double>(i) / 30.0, 1e-12);
        EXPECT_NEAR(trajectory[i].stamp_s, frame.stamp_s, 1e-9);
        EXPECT_LT(log(trajectory[i].pose.inverse() * truth.at(frame.id)).norm(), 1e-7);
        // The object stands still in the measured world but for the arm's noise: 0.02 degrees at up to 0.8 m.
        const Pose here = frame.camera_from_world->inverse() * truth.at(frame.id);
        EXPECT_LT((here.translation - object_in_world.translation).norm(), 0.004);
        EXPECT_LT(angle_between(here.rotation, object_in_world.rotation), 0.003);
        EXPECT_EQ((here.translation - object_in_world.translation).norm() > 1e-6, i > 0);  // and has noise
    }
    for (const char* name : {"models", "models_eval"}) {
        const data_set::ModelInfo info = data_set::read_model_info(folder / "set" / name, 1);
        EXPECT_NEAR(info.diameter_m, 0.45585, 1e-4);
        const Mesh mesh = load_mesh(data_set::model_path(folder / "set" / name, 1), LengthUnit::kMillimetre).mesh;
        EXPECT_EQ(mesh.triangles.size(), embedded_part("engine_block").mesh.triangles.size());
    }
    const auto targets = data_set::JsonFile(folder / "set/test_targets_bop19.json");
    EXPECT_EQ(targets.root().elements().size(), 5u);
    EXPECT_EQ(targets.root().elements()[4].at("im_id").integer(), 4);
    EXPECT_EQ(data_set::read_camera_json(folder / "set/camera.json").depth_scale_mm, 0.1);
}

TEST(Simulate, WithoutNoiseTheTruthRendersToTheDepthAndTheMasks) {
    const fs::path folder = fresh_folder("exact");
    SimulationOptions options = small_options(folder / "set");
    options.recording.sensor = scaled(options.recording.sensor, 0.0);
    simulate_block(options);
    const data_set::BopScene scene = data_set::open_scene(folder / "set/test/000001");
    const std::map<int, Pose> truth = data_set::read_ground_truth(scene.folder, 1);
    const data_set::JsonFile info(scene.folder / "scene_gt_info.json");
    const EmbreeScene block(embedded_part("engine_block").mesh);
    for (const data_set::Frame& frame : scene.frames) {
        const DepthImage depth = data_set::load_depth(frame),
                         exact = render_depth(block, truth.at(frame.id), frame.camera);
        const Mask visible = data_set::read_mask_png(data_set::mask_path(scene.folder, frame.id, 0, true));
        const Mask whole = data_set::read_mask_png(data_set::mask_path(scene.folder, frame.id, 0, false));
        int hits = 0;
        for (std::size_t i = 0; i < depth.depth_m.size(); ++i) {
            ASSERT_EQ(visible.value[i] != 0, exact.depth_m[i] > 0.0F);  // nothing occludes the part
            ASSERT_EQ(whole.value[i] != 0, exact.depth_m[i] > 0.0F);
            if (exact.depth_m[i] == 0.0F) continue;
            ++hits;
            ASSERT_NEAR(depth.depth_m[i], exact.depth_m[i], 0.5e-4 + 1e-6);
        }
        // By brute force: the same rays on an image nine times as wide and high.
        const PixelGrid wide{-4 * 160, -4 * 120, 1, 9 * 160, 9 * 120};
        const DepthImage canvas = render_depth(block, truth.at(frame.id), camera_of(wide, frame.camera));
        const auto total = std::count_if(canvas.depth_m.begin(), canvas.depth_m.end(), [](float z) { return z > 0; });
        const auto entry = info.root().at(std::to_string(frame.id)).elements().at(0);
        EXPECT_EQ(entry.at("px_count_all").integer(), total);
        EXPECT_EQ(entry.at("px_count_visib").integer(), hits);
        EXPECT_EQ(entry.at("px_count_valid").integer(), hits);
        EXPECT_NEAR(entry.at("visib_fract").number(), static_cast<double>(hits) / static_cast<double>(total), 1e-12);
        int first_u = wide.width, last_u = -1;
        for (std::size_t i = 0; i < canvas.depth_m.size(); ++i) {
            if (canvas.depth_m[i] == 0.0F) continue;
            first_u = std::min(first_u, wide.image_u(static_cast<int>(i)));
            last_u = std::max(last_u, wide.image_u(static_cast<int>(i)));
        }
        EXPECT_EQ(entry.at("bbox_obj").numbers(4)[0], first_u);
        EXPECT_EQ(entry.at("bbox_obj").numbers(4)[2], last_u - first_u);
    }
}

TEST(Simulate, ResidualsSpreadAsTheSensorSays) {
    const fs::path folder = fresh_folder("spread");
    SimulationOptions options = small_options(folder / "set");
    options.recording.scenario = Scenario::kBaseline;
    options.recording.with_table = false;
    options.recording.sensor.jitter_pixels = 0.0;
    options.recording.sensor.bias_sigma_m = 0.0;
    options.recording.sensor.disparity_step_pixels = 0.0;
    options.recording.sensor.flying_probability = 0.0;
    simulate_block(options);
    const data_set::BopScene scene = data_set::open_scene(folder / "set/test/000001");
    const std::map<int, Pose> truth = data_set::read_ground_truth(scene.folder, 1);
    const EmbreeScene block(embedded_part("engine_block").mesh);
    std::vector<double> normalised;
    for (const data_set::Frame& frame : scene.frames) {
        const DepthImage depth = data_set::load_depth(frame),
                         exact = render_depth(block, truth.at(frame.id), frame.camera);
        for (std::size_t i = 0; i < depth.depth_m.size(); ++i) {
            if (depth.depth_m[i] == 0.0F) continue;
            ASSERT_GT(exact.depth_m[i], 0.0F);  // without a table nothing else is seen
            const double z = exact.depth_m[i];
            normalised.push_back(std::abs(depth.depth_m[i] - z) / options.recording.sensor.sigma_m(z));
        }
    }
    ASSERT_GT(normalised.size(), 3000u);
    std::sort(normalised.begin(), normalised.end());
    EXPECT_NEAR(1.4826 * normalised[normalised.size() / 2], 1.0, 0.05);
}

TEST(Simulate, PistonEndsWithThePartFillingTheImage) {
    const fs::path folder = fresh_folder("fill");
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        SimulationOptions options = small_options(folder / std::to_string(seed));
        options.recording.num_frames = 3;
        options.recording.seed = seed;
        simulate_block(options);
        const data_set::JsonFile info(options.data_set / "test/000001/scene_gt_info.json");
        const auto last = info.root().at("2").elements().at(0);
        EXPECT_GT(last.at("px_count_visib").integer(), 160 * 120 / 5);
        EXPECT_GT(last.at("px_count_valid").integer(), 160 * 120 / 6);
        EXPECT_LT(last.at("visib_fract").number(), 0.9);
    }
}

TEST(Simulate, TableFillsTheBackground) {
    const fs::path folder = fresh_folder("table");
    for (const bool with_table : {true, false}) {
        SimulationOptions options = small_options(folder / (with_table ? "with" : "without"));
        options.recording.num_frames = 1;
        options.recording.with_table = with_table;
        simulate_block(options);
        const data_set::BopScene scene = data_set::open_scene(options.data_set / "test/000001");
        const DepthImage depth = data_set::load_depth(scene.frames[0]);
        const Mask mask = *data_set::MaskSource(scene, 1).load(scene.frames[0]).mask;
        int background = 0, measured = 0;
        for (std::size_t i = 0; i < depth.depth_m.size(); ++i) {
            if (mask.value[i] != 0) continue;
            ++background;
            measured += depth.depth_m[i] > 0.0F ? 1 : 0;
        }
        const double fraction = static_cast<double>(measured) / background;
        EXPECT_TRUE(with_table ? fraction > 0.6 : fraction < 0.05) << fraction;
    }
}

TEST(Simulate, ReplacesOnlyWhatItIsToldTo) {
    const fs::path folder = fresh_folder("replace");
    SimulationOptions options = small_options(folder / "set");
    options.recording.num_frames = 1;
    fs::create_directories(options.data_set);  // empty: may be filled
    simulate_block(options);
    const auto first = files_below(options.data_set);
    options.recording.seed = 2;
    EXPECT_THROW(simulate_block(options), std::runtime_error);
    EXPECT_TRUE(files_below(options.data_set) == first);
    options.replace = true;
    simulate_block(options);
    EXPECT_FALSE(files_below(options.data_set) == first);
    std::ofstream(options.data_set / "notes.txt") << "mine";
    EXPECT_THROW(simulate_block(options), std::runtime_error);
    EXPECT_TRUE(fs::exists(options.data_set / "notes.txt"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);  // nothing is left beside it
}

TEST(Simulate, LeavesNothingBehindWhenStopped) {
    const fs::path folder = fresh_folder("stopped");
    const Mesh mesh = embedded_part("engine_block").mesh;
    int calls = 0;
    const SimulationSummary summary = write_data_set(mesh, engine_block_part(extent_of(mesh)),
                                                     small_options(folder / "set"), [&] { return ++calls < 2; });
    EXPECT_FALSE(summary.complete);
    EXPECT_EQ(calls, 2);
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST(Simulate, TakesAnyPart) {
    const fs::path folder = fresh_folder("any");
    Mesh box;
    for (int i = 0; i < 8; ++i) {
        box.vertices_in_object.emplace_back(0.15F * static_cast<float>(i & 1), 0.2F * static_cast<float>(i >> 1 & 1),
                                            0.25F * static_cast<float>(i >> 2));
    }
    box.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
    SimulationOptions options = small_options(folder / "set");
    EXPECT_EQ(write_data_set(box, box_part(extent_of(box)), options, kGoOn).frames_without_part, 0);
}

TEST(Simulate, RefusesOptionsOutOfBounds) {
    const fs::path folder = fresh_folder("bounds");
    SimulationOptions options = small_options(folder / "set");
    options.recording.num_frames = -1;
    EXPECT_THROW(simulate_block(options), std::invalid_argument);
    options = small_options(folder / "set");
    options.recording.depth_scale_mm = 200.0;  // one count would be more than the least range
    EXPECT_THROW(simulate_block(options), std::invalid_argument);
    EXPECT_TRUE(fs::is_empty(folder));
}

}  // namespace
}  // namespace nearpose::simulate
