// Does the part stand still while the camera moves? And if it seems to move: does it, or is the set-up at fault?
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/world/sighting.hpp"

namespace nearpose {

// What makes the part seem to move.
enum class Cause {
    kNone,            // nothing: it stands still
    kObjectMotion,    // it moves uniformly
    kPrincipalPoint,  // the camera's principal point, or an image that is shifted
    kFocalLength,
    kDepthScale,
    kHandEyeRotation,
    kHandEyeTranslation,
    kTimeOffset,  // the arm's poses are of another time than the images
};
inline constexpr int kNumCauses = 8;

const char* to_string(Cause cause);

// Standard deviations of the errors of a set-up.
struct SetupSigmas {
    double focal_length = 0.0;            // share of itself
    double principal_point_pixels = 0.0;  // along columns and rows
    double depth_scale = 0.0;
    double hand_eye_rad = 0.0;
    double hand_eye_m = 0.0;
    double time_offset_frames = 0.0;
    double turn_rad = 0.0;  // motion of the part in one frame
    double shift_m = 0.0;
};

struct StillWorldOptions {
    // A set-up as it should be, and one that is at fault.
    SetupSigmas usual = {.focal_length = 0.002,
                         .principal_point_pixels = 1.0,
                         .depth_scale = 0.002,
                         .hand_eye_rad = 0.002,
                         .hand_eye_m = 0.001,
                         .time_offset_frames = 0.1,
                         .turn_rad = 1e-6,
                         .shift_m = 1e-6};
    SetupSigmas faulty = {.focal_length = 0.02,
                          .principal_point_pixels = 10.0,
                          .depth_scale = 0.03,
                          .hand_eye_rad = 0.03,
                          .hand_eye_m = 0.01,
                          .time_offset_frames = 2.0,
                          .turn_rad = 0.01,
                          .shift_m = 0.003};
    // Sightings of similar views share their errors: so many count as one.
    double sightings_per_error = 1.5;
    int min_sightings = 5;
    // Log-odds from which a cause counts against a part that stands still [nats]. One set-up of a hundred is at fault,
    // and where that has become one of ten, 90 % of the probability no longer lie within a tolerance.
    double min_log_odds = 2.3;
    // Causes whose evidence is smaller than the best one's by less are possible as well [nats].
    double as_likely_nats = 3.0;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const StillWorldOptions& options);

// What the sightings say of one cause.
struct CauseEvidence {
    double log_odds = 0.0;  // against a part that stands still and a usual set-up [nats]
    // What the cause does to the present pose of the part in the camera frame: size of the shift of the model's centre,
    // its estimate and standard deviation [m]. 0 for causes that leave the camera's pose right.
    double shift_m = 0.0, sigma_m = 0.0;
};

struct StillWorld {
    int sightings = 0;                    // that were compared
    Cause cause = Cause::kNone;           // the likeliest
    std::vector<CauseEvidence> evidence;  // by cause; empty where too few sightings are there
    // The largest shift of the present pose that a cause that is possible would explain, with 90 % probability [m]; 0
    // where nothing but the part's own motion, or none, is likely.
    double error_bound_m = 0.0;
};

// Linear Gaussian models over the last sightings since something was moved. The twist of a sighting from the first is
//   place + time * velocity + effect of the set-up's errors + noise,
// and a cause is a prior variance of these unknowns. Their evidences are in closed form (MacKay 1992).
StillWorld compare_causes(const std::vector<Sighting>& sightings, const Eigen::Vector3d& centre_in_object,
                          const StillWorldOptions& options = {});

}  // namespace nearpose
