#include "apps/scenes/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "apps/data_set/png_file.hpp"
#include "apps/scenes/parts.hpp"
#include "core/base/parallel.hpp"

namespace nearpose::simulate {
namespace {

const EmbeddedPart& block() {
    static const EmbeddedPart part = embedded_part("engine_block");
    return part;
}

RecordingOptions small(Scenario scenario, int frames) {
    RecordingOptions options;
    options.scenario = scenario;
    options.num_frames = frames;
    options.camera = {96, 72, 90.0, 90.0, 47.5, 35.5};
    return options;
}

bool same(const SimulatedFrame& a, const SimulatedFrame& b) {
    bool others = a.others.size() == b.others.size();
    for (std::size_t i = 0; others && i < a.others.size(); ++i) {
        others = a.others[i].visible.value == b.others[i].visible.value &&
                 a.others[i].silhouette.value == b.others[i].silhouette.value;
    }
    return others && a.id == b.id && a.depth.depth_m == b.depth.depth_m && a.given_mask.value == b.given_mask.value &&
           a.camera_from_world.translation == b.camera_from_world.translation &&
           a.camera_from_object.translation == b.camera_from_object.translation &&
           a.truth.silhouette_pixels == b.truth.silhouette_pixels;
}

TEST(Recording, GivesTheSameBitsInAnyOrderAndNumberOfThreads) {
    for (const std::string& name : scenario_names()) {
        RecordingOptions options = small(scenario_of(name), 4);
        options.dropped_fraction = 0.25;
        options.mask.grow_pixels = 1;
        const Recording recording(block().mesh, block().part, options);
        ASSERT_EQ(recording.num_frames(), 3);
        std::vector<SimulatedFrame> forwards;
        for (int i = 0; i < 3; ++i) forwards.push_back(recording.frame(i));
        for (const int num_threads : {1, 2, 3}) {
            const Recording again(block().mesh, block().part, options);
            std::vector<SimulatedFrame> frames(3);
            parallel_for(3, num_threads, [&](int i) { frames[static_cast<std::size_t>(2 - i)] = again.frame(2 - i); });
            for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(same(frames[i], forwards[i])) << name;
        }
        options.seed = 2;
        EXPECT_FALSE(same(Recording(block().mesh, block().part, options).frame(0), forwards[0])) << name;
    }
}

TEST(Recording, DepthIsWhatAFileWouldHold) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "recording_test";
    std::filesystem::create_directories(folder);
    for (const double scale_mm : {0.1, 0.125, 1.0}) {
        RecordingOptions options = small(Scenario::kPiston, 2);
        options.depth_scale_mm = scale_mm;
        const SimulatedFrame frame = Recording(block().mesh, block().part, options).frame(1);
        data_set::write_depth_png(folder / "depth.png", frame.depth, scale_mm);
        EXPECT_EQ(data_set::read_depth_png(folder / "depth.png", scale_mm).depth_m, frame.depth.depth_m);
    }
}

TEST(Recording, DropsTheFractionAskedForButNeverTheFirst) {
    RecordingOptions options = small(Scenario::kBaseline, 40);
    options.dropped_fraction = 0.3;
    std::set<std::vector<int>> patterns;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        options.seed = seed;
        const Recording recording(block().mesh, block().part, options);
        ASSERT_EQ(recording.num_frames(), 28);
        std::vector<int> ids;
        for (int i = 0; i < recording.num_frames(); ++i) {
            if (seed > 1 && i > 3) break;  // enough to tell them apart
            const SimulatedFrame frame = recording.frame(i);
            ids.push_back(frame.id);
            EXPECT_NEAR(frame.stamp_s, frame.id / 30.0, 1e-12);
            EXPECT_TRUE(i == 0 ? frame.id == 0 : ids[ids.size() - 1] > ids[ids.size() - 2]);
        }
        patterns.insert({ids.begin(), ids.begin() + 4});
    }
    EXPECT_GT(patterns.size(), 1u);
    options.dropped_fraction = 0.95;
    options.num_frames = 2;
    EXPECT_EQ(Recording(block().mesh, block().part, options).num_frames(), 1);
}

TEST(Recording, AFrameIsTheSameWhetherOthersAreDropped) {
    RecordingOptions options = small(Scenario::kPiston, 10);
    const Recording whole(block().mesh, block().part, options);
    options.dropped_fraction = 0.5;
    const Recording holes(block().mesh, block().part, options);
    const SimulatedFrame last = holes.frame(holes.num_frames() - 1);
    EXPECT_TRUE(same(last, whole.frame(last.id)));
}

TEST(Recording, CountsOfTheScenarioAndBounds) {
    RecordingOptions options = small(Scenario::kConveyor, 0);
    EXPECT_EQ(Recording(block().mesh, block().part, options).num_frames(), default_frames(Scenario::kConveyor));
    options.part_name = "flnge";
    EXPECT_THROW(Recording(block().mesh, block().part, options), std::invalid_argument);
    options = small(Scenario::kConveyor, 2);
    options.dropped_fraction = 1.0;
    EXPECT_THROW(Recording(block().mesh, block().part, options), std::invalid_argument);
    options = small(Scenario::kConveyor, 2);
    options.mask.bleed_pixels = -1;
    EXPECT_THROW(Recording(block().mesh, block().part, options), std::invalid_argument);
}

TEST(Recording, OnlyTheGivenMaskHasErrors) {
    RecordingOptions options = small(Scenario::kBaseline, 1);
    const SimulatedFrame exact = Recording(block().mesh, block().part, options).frame(0);
    EXPECT_EQ(exact.given_mask.value, exact.visible.value);
    options.mask.grow_pixels = 2;
    const SimulatedFrame grown = Recording(block().mesh, block().part, options).frame(0);
    EXPECT_EQ(grown.visible.value, exact.visible.value);
    EXPECT_EQ(grown.truth.visible_pixels, exact.truth.visible_pixels);
    int more = 0;
    for (std::size_t i = 0; i < exact.visible.value.size(); ++i) {
        EXPECT_GE(grown.given_mask.value[i], exact.visible.value[i]);
        more += grown.given_mask.value[i] != exact.visible.value[i] ? 1 : 0;
    }
    EXPECT_GT(more, 50);
}

}  // namespace
}  // namespace nearpose::simulate
