// A set-up is calibrated from one approach to a part that stands still: the errors put in come out, within their
// sigmas.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "apps/runs/estimator_setup.hpp"
#include "apps/scenes/arm.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"
#include "apps/set_up/calibration.hpp"
#include "apps/set_up/corrected_source.hpp"

namespace nearpose {
namespace {

using program::SetupErrors;

class RecordingSource : public program::FrameSource {
  public:
    explicit RecordingSource(const simulate::Recording& recording) {
        for (int k = 0; k < recording.num_frames(); ++k) {
            const simulate::SimulatedFrame frame = recording.frame(k);
            frames_.push_back({k, frame.stamp_s, frame.camera, frame.camera_from_world});
            data_.push_back({frame.depth, frame.given_mask, {}, {}});
        }
    }
    program::FrameData load(std::size_t index) const override { return data_[index]; }

  private:
    std::vector<program::FrameData> data_;
};

struct Trial {
    SetupErrors truth;
    program::Calibration found;
};

Trial calibrated(const simulate::ArmErrors& arm, const std::vector<std::string>& faults, const SetupErrors& camera,
                 const program::CalibrationOptions& how) {
    const Mesh mesh = simulate::embedded_part("engine_block").mesh;
    simulate::RecordingOptions options;
    options.num_frames = 40;
    options.seed = 5;
    options.camera = {320, 240, 300.0, 300.0, 159.5, 119.5};
    options.arm = arm;
    for (const std::string& fault : faults) options.faults.push_back(simulate::parse_fault(fault));
    const simulate::Recording recording(mesh, simulate::engine_block_part(extent_of(mesh)), options);
    const program::EstimatorSetup setup;
    Trial trial;
    trial.truth = camera;
    trial.truth.given_from_camera = simulate::hand_eye_error(arm, options.seed);
    trial.truth.time_offset_s = arm.time_offset_s;
    trial.found = program::calibrate(
        std::make_shared<const RecordingSource>(recording), extent_of(mesh).centre_in_object(), setup,
        program::make_view_generator(setup, mesh), [] { return true; }, how);
    return trial;
}

void expect_within(const Trial& trial, double sigmas) {
    ASSERT_TRUE(trial.found.solved);
    const double frame_s = trial.found.frame_s;
    const SetupVector off = trial.found.estimate - program::in_order(trial.truth, frame_s);
    for (Eigen::Index i = 0; i < kSetupUnknowns; ++i) {
        EXPECT_LT(std::abs(off[i]), sigmas * trial.found.sigma[i]) << "unknown " << i;
        EXPECT_LE(trial.found.sigma[i], trial.found.prior_sigma[i] * (1.0 + 1e-9)) << "unknown " << i;
    }
}

TEST(Calibrate, FindsTheErrorsThatWerePutIn) {
    simulate::ArmErrors arm;
    arm.hand_eye_translation_m = 0.004;
    arm.hand_eye_rotation_rad = 0.012;
    arm.time_offset_s = 0.03;
    SetupErrors camera;
    camera.focal_length = 0.015;
    camera.depth_scale = -0.012;
    camera.principal_point_pixels.x() = -4.0;
    program::CalibrationOptions all_unknown;
    all_unknown.unknown = program::setup_parts();
    const Trial trial =
        calibrated(arm, {"focal:1.5@all", "depth-scale:-1.2@all", "principal-point:-4@all"}, camera, all_unknown);
    expect_within(trial, 3.5);
    // What this motion shows is known far better than before.
    for (const Eigen::Index i :
         {Eigen::Index{kFocalLengthError}, Eigen::Index{kDepthScaleError}, Eigen::Index{kTimeOffset}})
        EXPECT_LT(trial.found.sigma[i], 0.3 * trial.found.prior_sigma[i]) << "unknown " << i;
}

TEST(Calibrate, OnlyWhatIsAtFaultIsCorrected) {
    const Trial good = calibrated({}, {}, {}, {});
    expect_within(good, 3.5);
    EXPECT_TRUE(good.found.unknown.empty());
    EXPECT_EQ(program::in_order(good.found.errors, 1.0), SetupVector::Zero());
    simulate::ArmErrors arm;
    arm.time_offset_s = 0.04;
    const Trial late = calibrated(arm, {}, {}, {});
    expect_within(late, 3.5);
    EXPECT_EQ(late.found.unknown, std::vector<std::string>{"time"});
    EXPECT_NEAR(late.found.errors.time_offset_s, arm.time_offset_s, 0.004);
    EXPECT_EQ(late.found.errors.focal_length, 0.0);
}

}  // namespace
}  // namespace nearpose
