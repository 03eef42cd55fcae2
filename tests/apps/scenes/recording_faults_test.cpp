// Recordings with faults: what they deliver, and that their truth stays.
#include <gtest/gtest.h>

#include "tests/apps/scenes/small_recording.hpp"

namespace nearpose::simulate {
namespace {

using Frames = std::vector<SimulatedFrame>;

RecordingOptions with(const std::vector<std::string>& faults, int frames = 6) {
    RecordingOptions options = small(Scenario::kPiston, frames);
    for (const std::string& fault : faults) options.faults.push_back(parse_fault(fault));
    return options;
}

Frames frames_of(const RecordingOptions& options) {
    const Recording recording(block().mesh, block().part, options);
    Frames frames;
    for (int i = 0; i < recording.num_frames(); ++i) frames.push_back(recording.frame(i));
    return frames;
}

bool same_pose(const Pose& a, const Pose& b) {
    return a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
}

bool same_image(const SimulatedFrame& a, const SimulatedFrame& b) {
    return a.depth.depth_m == b.depth.depth_m && a.given_mask.value == b.given_mask.value;
}

bool same_truth(const SimulatedFrame& a, const SimulatedFrame& b) {
    return same_pose(a.camera_from_object, b.camera_from_object) && a.visible.value == b.visible.value &&
           a.silhouette.value == b.silhouette.value && a.truth.measured_pixels == b.truth.measured_pixels &&
           a.truth.visible_pixels == b.truth.visible_pixels &&
           same_pose(a.truth.camera_from_object, b.truth.camera_from_object);
}

bool same_camera(const PinholeCamera& a, const PinholeCamera& b) {
    return a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy && a.width == b.width && a.height == b.height;
}

TEST(RecordingFaults, ChangeNothingOutsideTheirFramesAndNeverTheTruth) {
    const Frames plain = frames_of(with({}));
    for (const FaultRule& rule : fault_rules()) {
        if (rule.kind >= FaultKind::kDropped) continue;
        std::string value = *rule.value == '\0' ? "" : ":0.3";
        if (rule.whole) value = rule.kind == FaultKind::kRotated ? ":180" : ":2";
        const Frames faulty = frames_of(with({rule.name + value + "@2-3"}));
        ASSERT_EQ(faulty.size(), plain.size());
        for (std::size_t i = 0; i < plain.size(); ++i) {
            const bool same = same_image(faulty[i], plain[i]) && same_camera(faulty[i].camera, plain[i].camera) &&
                              same_pose(faulty[i].camera_from_world, plain[i].camera_from_world);
            const bool is_in = i == 2 || i == 3, starts = i == 2 && rule.kind == FaultKind::kTemporalFilter;
            const bool outlier = i == 3 && rule.kind == FaultKind::kArmOutlier;
            EXPECT_EQ(same, !is_in || starts || outlier) << rule.name << i;
            EXPECT_TRUE(same_truth(faulty[i], plain[i])) << rule.name << i;
            EXPECT_EQ(faulty[i].after_fault, i > 3);
            EXPECT_EQ(faulty[i].stamp_s, plain[i].stamp_s);
        }
    }
}

TEST(RecordingFaults, AHangingCameraGivesTheSameBitsWhileTheArmMovesOn) {
    const Frames plain = frames_of(with({})), frozen = frames_of(with({"frozen@3-", "salt-pepper:0.1@all"}));
    for (std::size_t i = 3; i < frozen.size(); ++i) {
        EXPECT_TRUE(same_image(frozen[i], frozen[2]));
        EXPECT_TRUE(same_pose(frozen[i].camera_from_world, plain[i].camera_from_world));
    }
    EXPECT_FALSE(same_image(frozen[2], frozen[1]));
}

TEST(RecordingFaults, DepthIsScaledBeforeItIsCounted) {
    RecordingOptions exact = with({}, 1), scaled = with({"depth-scale:100@all"}, 1);
    exact.depth_scale_mm = 0.5;
    scaled.depth_scale_mm = 1.0;
    const std::vector<float> once = frames_of(exact)[0].depth.depth_m, twice = frames_of(scaled)[0].depth.depth_m;
    for (std::size_t i = 0; i < once.size(); ++i) EXPECT_FLOAT_EQ(2.0F * once[i], twice[i]);
}

TEST(RecordingFaults, DepthBeyondTheCountsIsNone) {
    RecordingOptions options = with({"depth-scale:900@all"}, 1);
    options.depth_scale_mm = 0.1;
    const Frames frames = frames_of(options);
    for (const float value_m : frames[0].depth.depth_m) EXPECT_LE(value_m, 6.5536F);
}

TEST(RecordingFaults, FilteredFramesDoNotDependOnTheOrderInWhichTheyAreAskedFor) {
    const RecordingOptions options = with({"temporal-filter:0.4@1-", "dropped@3", "frozen@5", "hole-filling@4-"}, 7);
    const Frames in_order = frames_of(options);
    const Recording recording(block().mesh, block().part, options);
    for (const int index : {5, 2, 2, 3, 0, 4, 1, 5}) {
        const SimulatedFrame frame = recording.frame(index);
        EXPECT_TRUE(same_image(frame, in_order[static_cast<std::size_t>(index)])) << index;
    }
    EXPECT_TRUE(remembers_images(options.faults));
}

TEST(RecordingFaults, AFilterOfAlphaOneChangesNothingThatWasMeasured) {
    const Frames plain = frames_of(with({})), filtered = frames_of(with({"temporal-filter:1@all"}));
    for (std::size_t i = 0; i < plain.size(); ++i) {
        for (std::size_t pixel = 0; pixel < plain[i].depth.depth_m.size(); ++pixel) {
            const float depth_m = plain[i].depth.depth_m[pixel];
            if (depth_m > 0.0F) {
                EXPECT_EQ(filtered[i].depth.depth_m[pixel], depth_m);
            }
        }
    }
}

TEST(RecordingFaults, FramesAreLostLateOrDouble) {
    const Frames plain = frames_of(with({})), dropped = frames_of(with({"dropped@1-2"})),
                 doubled = frames_of(with({"duplicated@3"})), late = frames_of(with({"late@2"}));
    ASSERT_EQ(dropped.size(), 4U);
    EXPECT_EQ(dropped[1].id, 3);
    EXPECT_TRUE(same_image(dropped[1], plain[3]));
    EXPECT_EQ(dropped[1].stamp_s, plain[3].stamp_s);
    EXPECT_EQ(doubled[3].id, 3);
    EXPECT_TRUE(same_image(doubled[3], plain[2]));
    EXPECT_TRUE(same_truth(doubled[3], plain[2]));
    EXPECT_EQ(doubled[3].stamp_s, plain[2].stamp_s);
    EXPECT_TRUE(same_pose(doubled[3].camera_from_world, plain[2].camera_from_world));
    EXPECT_TRUE(same_image(late[2], plain[2]));
    EXPECT_TRUE(same_truth(late[2], plain[2]));
    EXPECT_DOUBLE_EQ(late[2].stamp_s, 3.5 / 30.0);
    const Pose half_way = interpolate(plain[3].camera_from_world, plain[4].camera_from_world, 0.5);
    EXPECT_LT(log(late[2].camera_from_world.inverse() * half_way).norm(), 1e-9);
}

TEST(RecordingFaults, TheTruthFollowsAPartThatIsMoved) {
    const Frames plain = frames_of(with({}));
    for (const char* fault : {"pushed:20@3", "carried@3-4"}) {
        const Frames moved = frames_of(with({fault}));
        for (std::size_t i = 0; i < plain.size(); ++i) {
            EXPECT_EQ(moved[i].part_moved, i >= 3) << fault << i;
            EXPECT_EQ(same_image(moved[i], plain[i]) && same_truth(moved[i], plain[i]), i < 3) << fault << i;
            EXPECT_TRUE(same_pose(moved[i].camera_from_object, moved[i].truth.camera_from_object));
            EXPECT_TRUE(same_pose(moved[i].camera_from_world, plain[i].camera_from_world));
            const double way_m =
                (moved[i].camera_from_object.inverse().translation - plain[i].camera_from_object.inverse().translation)
                    .norm();
            if (i >= 3 && *fault == 'p') {
                EXPECT_NEAR(way_m, 0.020, 1e-9);
            }
        }
    }
}

TEST(RecordingFaults, ARecordingThatLosesAllIsRefused) {
    EXPECT_THROW(validate(with({"dropped@all"})), std::invalid_argument);
    EXPECT_EQ(num_delivered(with({"dropped@2-"})), 2);
}

}  // namespace
}  // namespace nearpose::simulate
