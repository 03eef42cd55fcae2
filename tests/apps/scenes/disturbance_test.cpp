#include "apps/scenes/disturbance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"

namespace nearpose::simulate {
namespace {

const EmbeddedPart& part_named(const std::string& name) {
    static const EmbeddedPart block = embedded_part("engine_block"), flange = embedded_part("flange");
    return name == "flange" ? flange : block;
}

RecordingOptions coarse(Scenario scenario, int frames, std::uint64_t seed = 1) {
    RecordingOptions options;
    options.scenario = scenario;
    options.num_frames = frames;
    options.seed = seed;
    options.camera = {96, 72, 90.0, 90.0, 47.5, 35.5};
    options.part_name = "engine_block";
    return options;
}

Recording recording_of(const RecordingOptions& options) {
    const EmbeddedPart& part = part_named(options.part_name);
    return Recording(part.mesh, part.part, options);
}

std::vector<SimulatedFrame> frames_of(const RecordingOptions& options) {
    const Recording recording = recording_of(options);
    std::vector<SimulatedFrame> frames;
    for (int i = 0; i < recording.num_frames(); ++i) frames.push_back(recording.frame(i));
    return frames;
}

int count(const Mask& mask) {
    return static_cast<int>(mask.value.size() - std::count(mask.value.begin(), mask.value.end(), 0));
}

bool is_same_view(const SimulatedFrame& a, const SimulatedFrame& b) {
    return a.depth.depth_m == b.depth.depth_m && a.given_mask.value == b.given_mask.value &&
           a.camera_from_object.translation == b.camera_from_object.translation;
}

constexpr Scenario kStillScenarios[] = {Scenario::kBaseline, Scenario::kPiston, Scenario::kCrankcase, Scenario::kSweep,
                                        Scenario::kHandheld};

TEST(NonsenseFrames, AreAsManyAsAskedForAndLeaveTheOthersAlone) {
    RecordingOptions options = coarse(Scenario::kPiston, 12);
    const std::vector<SimulatedFrame> plain = frames_of(options);
    options.disturbances.nonsense_frames = 4;
    const std::vector<SimulatedFrame> disturbed = frames_of(options);
    std::set<bool> flat;
    for (std::size_t i = 0; i < plain.size(); ++i) {
        const SimulatedFrame& frame = disturbed[i];
        EXPECT_EQ(frame.camera_from_object.translation, plain[i].camera_from_object.translation);
        EXPECT_EQ(frame.camera_from_world.translation, plain[i].camera_from_world.translation);
        EXPECT_EQ(frame.given_mask.value, plain[i].given_mask.value);
        EXPECT_EQ(frame.nonsense, frame.depth.depth_m != plain[i].depth.depth_m);
        EXPECT_EQ(frame.shows_part(), !frame.nonsense);
        if (!frame.nonsense) continue;
        EXPECT_GE(i, 3U);
        const auto [nearest, farthest] = std::minmax_element(frame.depth.depth_m.begin(), frame.depth.depth_m.end());
        EXPECT_GE(*nearest, static_cast<float>(options.sensor.min_range_m) - 1e-4F);
        EXPECT_LE(*farthest, static_cast<float>(options.sensor.max_range_m) + 1e-4F);
        EXPECT_TRUE(*nearest == *farthest || *farthest - *nearest > 1.0F);
        flat.insert(*nearest == *farthest);
    }
    EXPECT_EQ(std::count_if(disturbed.begin(), disturbed.end(), [](const auto& frame) { return frame.nonsense; }), 4);
    EXPECT_EQ(flat.size(), 2U);  // walls and noise in turns
}

TEST(NonsenseFrames, AreDrawnFromWhatIsDeliveredAndShowsTheScene) {
    const Disturbances disturbances{3, 4, false, SceneContent::kPart};
    const std::vector<int> delivered = {0, 1, 3, 4, 5, 6, 8, 9, 11};  // 4..7 of 12 look away
    std::set<std::vector<int>> patterns;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        const std::vector<int> frames = nonsense_frames(disturbances, delivered, 12, seed);
        EXPECT_EQ(frames, (std::vector<int>{8, 9, 11}));
        patterns.insert(nonsense_frames({1, 4, false, SceneContent::kPart}, delivered, 12, seed));
    }
    EXPECT_EQ(patterns.size(), 3U);
}

TEST(LookAway, ShowsTheTableAloneInTheMiddleThird) {
    for (const Scenario scenario : kStillScenarios) {
        RecordingOptions options = coarse(scenario, 9);
        options.mask.grow_pixels = 2;
        options.sensor = scaled(options.sensor, 0.0);
        const std::vector<SimulatedFrame> plain = frames_of(options);
        options.disturbances.look_away = 3;
        const std::vector<SimulatedFrame> away = frames_of(options);
        for (std::size_t i = 0; i < away.size(); ++i) {
            EXPECT_EQ(away[i].camera_from_world.translation, plain[i].camera_from_world.translation);
            if (i < 3 || i > 5) {
                EXPECT_TRUE(is_same_view(away[i], plain[i])) << name_of(scenario) << i;
                continue;
            }
            EXPECT_FALSE(away[i].shows_part());
            EXPECT_EQ(count(away[i].given_mask) + count(away[i].visible) + count(away[i].silhouette), 0);
            for (std::size_t pixel = 0; pixel < plain[i].visible.value.size(); ++pixel) {
                const float with = plain[i].depth.depth_m[pixel], without = away[i].depth.depth_m[pixel];
                // The part hid the table.
                if (plain[i].visible.value[pixel] != 0 && with > 0.0F && without > 0.0F) {
                    EXPECT_GT(without, with - 2e-4F);  // to a count or two
                }
            }
        }
    }
}

TEST(ObjectMoves, WithinThePlaneOfTheTableByWhatIsPromised) {
    std::set<bool> senses;
    for (const Scenario scenario : kStillScenarios) {
        for (std::uint64_t seed = 1; seed <= 3; ++seed) {
            RecordingOptions options = coarse(scenario, 6, seed);
            const std::vector<SimulatedFrame> plain = frames_of(options);
            options.disturbances.object_moves = true;
            const std::vector<SimulatedFrame> moved = frames_of(options);
            const Part& part = part_named("engine_block").part;
            const Eigen::Vector3d centre = part.extent.centre_in_object();
            for (std::size_t i = 0; i < moved.size(); ++i) {
                EXPECT_EQ(moved[i].part_moved, i >= 3);
                EXPECT_EQ(moved[i].camera_from_world.translation, plain[i].camera_from_world.translation);
                if (i < 3) {
                    EXPECT_TRUE(is_same_view(moved[i], plain[i]));
                    continue;
                }
                // In the object's frame before it moved, in which up is z.
                const Pose motion = plain[i].camera_from_object.inverse() * moved[i].camera_from_object;
                const Eigen::Vector3d shift = motion * centre - centre;
                EXPECT_NEAR(shift.z(), 0.0, 1e-9);
                EXPECT_GE(shift.norm(), 0.1 * part.extent.diameter_m() - 1e-9);
                EXPECT_LE(shift.norm(), 0.2 * part.extent.diameter_m() + 1e-9);
                const Eigen::AngleAxisd turn(motion.rotation);
                EXPECT_NEAR(std::abs(turn.axis().z()), 1.0, 1e-9);
                EXPECT_GE(turn.angle(), 20.0 * M_PI / 180.0 - 1e-9);
                EXPECT_LE(turn.angle(), 160.0 * M_PI / 180.0 + 1e-9);
                senses.insert(turn.axis().z() > 0.0);
                EXPECT_TRUE(moved[i].shows_part());
                EXPECT_GT(count(moved[i].visible), count(plain[i].visible) / 3) << name_of(scenario) << seed;
            }
        }
    }
    EXPECT_EQ(senses.size(), 2U);
}

TEST(ObjectMoves, WhileTheCameraLooksAway) {
    RecordingOptions options = coarse(Scenario::kBaseline, 9);
    options.disturbances.look_away = 2;
    options.disturbances.object_moves = true;
    const std::vector<SimulatedFrame> frames = frames_of(options);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        EXPECT_EQ(frames[i].shows_part(), i < 3 || i > 4) << i;
        EXPECT_EQ(frames[i].part_moved, i > 4) << i;
    }
}

TEST(EmptyScene, GivesAMaskOfWhatIsNotThere) {
    for (const Scenario scenario : kStillScenarios) {
        RecordingOptions options = coarse(scenario, 3);
        const std::vector<SimulatedFrame> full = frames_of(options);
        options.disturbances.scene = SceneContent::kEmpty;
        const std::vector<SimulatedFrame> empty = frames_of(options);
        for (std::size_t i = 0; i < empty.size(); ++i) {
            EXPECT_FALSE(empty[i].shows_part());
            EXPECT_EQ(count(empty[i].visible), 0);
            const data_set::BopBox box = data_set::box_of(empty[i].given_mask),
                                   part_box = data_set::box_of(full[i].visible);
            EXPECT_EQ(box.u, part_box.u);
            EXPECT_EQ(box.v, part_box.v);
            EXPECT_EQ(box.width, part_box.width);
            EXPECT_EQ(box.height, part_box.height);
            // An ellipse fills pi / 4 of its box.
            const double area = (box.width + 1.0) * (box.height + 1.0);
            EXPECT_NEAR(count(empty[i].given_mask) / area, M_PI / 4.0, 0.05);
        }
    }
}

TEST(OtherPart, LiesWhereTheCameraLooks) {
    for (const Scenario scenario : kStillScenarios) {
        for (const char* name : {"engine_block", "flange"}) {
            RecordingOptions options = coarse(scenario, 5);
            options.part_name = name;
            const std::vector<SimulatedFrame> own = frames_of(options);
            options.disturbances.scene = SceneContent::kOther;
            const std::vector<SimulatedFrame> other = frames_of(options);
            for (std::size_t i = 0; i < other.size(); ++i) {
                EXPECT_FALSE(other[i].shows_part());
                EXPECT_EQ(count(other[i].visible) + count(other[i].silhouette), 0);
                EXPECT_GT(count(other[i].given_mask), 50) << name_of(scenario) << name << i;
                EXPECT_NE(other[i].given_mask.value, own[i].given_mask.value);
                EXPECT_EQ(other[i].camera_from_object.translation, own[i].camera_from_object.translation);
            }
        }
    }
}

TEST(OtherPart, IsAnotherOneAndNoLarger) {
    for (const std::string name : {"engine_block", "flange", "bracket", ""}) {
        const EmbeddedPart part = embedded_part(name.empty() ? "bracket" : name);
        const TaskPath path = task_path(Scenario::kPiston, part.part, coarse(Scenario::kPiston, 3).camera, 3, 1);
        const StandIn other = stand_in(name, part.part, path, 1);
        EXPECT_LE(extent_of(other.mesh).diameter_m(), part.part.extent.diameter_m() * (1.0 + 1e-6));
        EXPECT_EQ(other.mesh.triangles.size(),
                  embedded_part(name == "flange" ? "engine_block" : "flange").mesh.triangles.size());
        // It stands on the table.
        double lowest_m = 1.0;
        const Pose ground_from_other = path.scene_from_ground.inverse() * other.scene_from_object;
        for (const Eigen::Vector3f& vertex : other.mesh.vertices_in_object)
            lowest_m = std::min(lowest_m, (ground_from_other * vertex.cast<double>().eval()).z());
        EXPECT_NEAR(lowest_m, 0.0, 1e-6);
    }
}

TEST(Blob, OfAnEmptyMaskIsEmpty) {
    const Mask none{4, 3, std::vector<std::uint8_t>(12, 0)};
    EXPECT_EQ(count(blob_over(none)), 0);
    Mask dot = none;
    dot.value[5] = 255;
    EXPECT_EQ(blob_over(dot).value, dot.value);
}

TEST(Disturbances, GiveTheSameBitsForTheSameSeedAndOthersForAnother) {
    RecordingOptions options = coarse(Scenario::kHandheld, 9);
    options.disturbances = {2, 2, true, SceneContent::kPart};
    const std::vector<SimulatedFrame> one = frames_of(options), again = frames_of(options);
    options.seed = 2;
    const std::vector<SimulatedFrame> other = frames_of(options);
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_TRUE(is_same_view(one[i], again[i]));
        EXPECT_FALSE(is_same_view(one[i], other[i]));
    }
}

RecordingOptions bare(SceneContent content) {
    RecordingOptions options = coarse(Scenario::kSweep, 3);
    options.disturbances.scene = content;
    return options;
}

// Second differences of inverse depth along rows, as lengths [m]: 0 on a plane, but for the rounding of depths.
double largest_bend_m(const DepthImage& image) {
    double largest_m = 0.0;
    for (int v = 0; v < image.height; ++v)
        for (int u = 1; u + 1 < image.width; ++u) {
            const float* depth_m = &image.depth_m[static_cast<std::size_t>(v) * image.width + u];
            if (depth_m[-1] == 0.0F || depth_m[0] == 0.0F || depth_m[1] == 0.0F) continue;
            const double bend = 1.0 / depth_m[-1] - 2.0 / depth_m[0] + 1.0 / depth_m[1];
            largest_m = std::max(largest_m, std::abs(bend) * depth_m[0] * depth_m[0]);
        }
    return largest_m;
}

TEST(Disturbance, AWallIsOnePlaneACornerIsNoneAndAConstantImageHasOneDepth) {
    RecordingOptions options = bare(SceneContent::kWall);
    options.sensor = scaled(SensorNoise{}, 0.0);
    for (const SimulatedFrame& frame : frames_of(options)) EXPECT_LT(largest_bend_m(frame.depth), 0.0003);
    options.disturbances.scene = SceneContent::kCorner;
    double corner_m = 0.0;
    for (const SimulatedFrame& frame : frames_of(options)) corner_m = std::max(corner_m, largest_bend_m(frame.depth));
    EXPECT_GT(corner_m, 0.001);
    options.disturbances.scene = SceneContent::kConstant;
    for (const SimulatedFrame& frame : frames_of(options)) {
        const auto [low, high] = std::minmax_element(frame.depth.depth_m.begin(), frame.depth.depth_m.end());
        EXPECT_EQ(*low, *high);
    }
}

TEST(Disturbance, ContentsOfAScenesHaveNames) {
    for (const std::string& name : scene_content_names())
        EXPECT_EQ(scene_content_names()[static_cast<std::size_t>(scene_content_of(name))], name);
    EXPECT_THROW(scene_content_of("nothing"), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::simulate
