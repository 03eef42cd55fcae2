// The generators in the filter: the same frames for all, tables of what is known.
#include <gtest/gtest.h>

#include <atomic>

#include "apps/compare/filter_table.hpp"
#include "apps/error_measures/run_summary.hpp"
#include "apps/view_quality/view_cell.hpp"
#include "raycast/depth_renderer.hpp"
#include "raycast/embree_view_generator.hpp"
#include "raycast/raster_view_generator.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::compare {
namespace {

const PinholeCamera kCamera{80, 60, 75.0, 75.0, 39.5, 29.5};

// Frames of the part at rest, without noise.
FilterRecording still_recording(int num_frames) {
    const Mesh mesh = program_tests::unsymmetric_part();
    const auto scene = std::make_shared<const EmbreeScene>(mesh);
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(2.4, Eigen::Vector3d(1.0, 0.25, 0.15).normalized()));
    const Pose pose{rotation, Eigen::Vector3d(0.0, 0.0, 0.38) - rotation * scene->extent().centre_in_object()};
    FilterRecording recording;
    recording.model.diameter_m = scene->extent().diameter_m();
    recording.model.box_min_in_object_m = scene->extent().box_min_in_object;
    recording.model.box_max_in_object_m = scene->extent().box_max_in_object;
    recording.num_frames = num_frames;
    recording.frame = [scene, pose](int index) {
        const DepthImage depth = render_depth(*scene, pose, kCamera);
        const evaluation::Visibility visibility{0.4 - 0.1 * index, 1e-4, std::nullopt};
        return FilterFrame{index, make_observation(depth, kCamera, std::nullopt), Pose::identity(),
                           evaluation::TrueFrame{index, pose, visibility}};
    };
    return recording;
}

// The paper's few particles find nothing, but fast. In so small an image 2000 samples leave some 150 in sight: too few
// to tell the part from its half turn.
std::vector<ComparedFilter> two_filters(const std::string& method = "paper", int samples = 2000) {
    const Mesh mesh = program_tests::unsymmetric_part();
    return {{"raycast", method, 8, std::make_shared<EmbreeViewGenerator>(mesh)},
            {"raster", method, 8, std::make_shared<RasterViewGenerator>(mesh, RasterOptions{samples, 1})}};
}

bool go_on() {
    return true;
}

TEST(RunFilters, FindThePoseAndTellItsErrors) {
    const auto runs = run_filters(still_recording(3), two_filters("default", 20000), 1, go_on);
    ASSERT_EQ(runs.size(), 2U);
    for (const auto& frames : runs) {
        ASSERT_EQ(frames.size(), 3U);
        EXPECT_TRUE(evaluation::within(frames.back(), {}));
        EXPECT_EQ(frames[2].frame_id, 2);
        EXPECT_GT(frames[2].time_s, 0.0);
        EXPECT_DOUBLE_EQ(frames[2].visibility->distance_m, 0.2);
    }
}

// A filter's run is its own: it does not matter who else gets the frames.
TEST(RunFilters, DoNotDisturbEachOther) {
    const std::vector<ComparedFilter> filters = two_filters();
    const auto together = run_filters(still_recording(2), filters, 4, go_on);
    for (std::size_t k = 0; k < filters.size(); ++k) {
        const auto alone = run_filters(still_recording(2), {filters[k]}, 4, go_on);
        for (std::size_t i = 0; i < 2; ++i) {
            EXPECT_EQ(alone[0][i].errors->translation_m, together[k][i].errors->translation_m);
            EXPECT_EQ(alone[0][i].errors->rotation_rad, together[k][i].errors->rotation_rad);
        }
    }
}

TEST(FilterResults, AreEmptyWhereTheUserStopped) {
    FilterTableOptions options;
    options.seeds = 2;
    int left = 1;
    const auto results = filter_results(
        two_filters(), [](std::uint64_t) { return still_recording(3); }, options, [&left] { return left-- > 0; },
        [] { ADD_FAILURE() << "no run was finished"; });
    EXPECT_TRUE(results.empty());
}

evaluation::FrameErrors frame_with(int id, double distance_m, double translation_m) {
    evaluation::FrameErrors frame;
    frame.frame_id = id;
    frame.visibility = evaluation::Visibility{distance_m, 1e-4, std::nullopt};
    frame.errors.emplace();
    frame.errors->translation_m = translation_m;
    frame.time_s = 0.02;
    return frame;
}

TEST(FilterTables, SayWhatTheFramesSay) {
    // Arrives in the second frame and holds; never arrives.
    const std::vector<evaluation::FrameErrors> good = {frame_with(0, 0.40, 0.5), frame_with(1, 0.31, 0.004),
                                                       frame_with(2, 0.20, 0.002), frame_with(3, 0.19, 0.002)};
    const std::vector<evaluation::FrameErrors> bad = {frame_with(0, 0.40, 0.5), frame_with(1, 0.31, 0.1),
                                                      frame_with(2, 0.20, 0.1), frame_with(3, 0.19, 0.1)};
    FilterTableOptions options;
    options.distances_mm = {400.0, 200.0, 50.0};
    options.seeds = 2;
    const auto tables = filter_tables({{"raycast", "paper", 16, nullptr}}, {{good, bad}}, options);
    ASSERT_EQ(tables.size(), 3U);
    const std::vector<tables::Entry>& whole = tables[0].rows.at(0).entries;
    ASSERT_EQ(whole.size(), tables[0].columns.size());
    EXPECT_EQ(tables[0].rows[0].label, "paper, raycast");
    EXPECT_EQ(tables[0].rows[0].runs, 2);
    // The burn-in is the first of four frames: means of 4, 2, 2 and of 100, 100, 100 mm.
    EXPECT_NEAR(*whole[0].value, 0.5 * (8.0 / 3.0 + 100.0), 1e-9);
    EXPECT_NEAR(*whole[3].value, 50.0, 1e-9);  // arrive
    EXPECT_NEAR(*whole[4].value, 50.0, 1e-9);  // hold
    EXPECT_NEAR(*whole[5].value, 2.0, 1e-9);   // frames to arrive, of the one that does
    EXPECT_NEAR(*whole[6].value, 20.0, 1e-9);  // ms
    // 0.31 m is nearer to 0.4 than to 0.2 by ratio.
    const std::vector<tables::Entry>& kept = tables[1].rows.at(0).entries;
    EXPECT_NEAR(*kept[0].value, 25.0, 1e-9);
    EXPECT_NEAR(*kept[1].value, 50.0, 1e-9);
    EXPECT_FALSE(kept[2].value.has_value());
    const std::vector<tables::Entry>& errors = tables[2].rows.at(0).entries;
    EXPECT_NEAR(*errors[0].value, 0.5 * (252.0 + 300.0), 1e-9);
    EXPECT_NEAR(*errors[1].value, 0.5 * (2.0 + 100.0), 1e-9);
}

TEST(SceneRecording, NeedsTheTruth) {
    const program_tests::TinyScene scene(2);
    const FilterRecording recording = scene_recording(scene.scene(), scene.models(), 1);
    EXPECT_EQ(recording.num_frames, 2);
    const FilterFrame frame = recording.frame(1);
    ASSERT_TRUE(frame.truth.has_value());
    EXPECT_NEAR((frame.truth->camera_from_object.translation - scene.truth()[1].translation).norm(), 0.0, 1e-6);
    ASSERT_TRUE(frame.truth->visibility.has_value());
    EXPECT_NEAR(frame.truth->visibility->distance_m, 0.36, 0.05);
    std::filesystem::remove(scene.scene() / "scene_gt.json");
    EXPECT_THROW(scene_recording(scene.scene(), scene.models(), 1), std::runtime_error);
}

TEST(SweepRecording, ComesFromFarToNear) {
    const auto part = simulate::embedded_part("bracket");
    const FilterRecording recording = sweep_recording(part, "bracket", 0.5, 0.2, 3, 7);
    ASSERT_EQ(recording.num_frames, 3);
    const FilterFrame first = recording.frame(0), last = recording.frame(2);
    ASSERT_TRUE(first.truth && last.truth && first.truth->visibility && last.truth->visibility);
    EXPECT_NEAR(first.truth->visibility->distance_m - last.truth->visibility->distance_m, 0.3, 0.05);
    EXPECT_EQ(last.id, 2);
    EXPECT_TRUE(last.camera_from_world.has_value());
}

}  // namespace
}  // namespace nearpose::compare
