// Does the image move as the arm says? Where it moves as much but in another direction, the set-up is at fault.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/world/sighting.hpp"

namespace nearpose {

// The usual mistakes: what the given motion has to be turned into to be the camera's.
enum class MotionMistake {
    kNone,
    kInverted,  // the motion is the inverse of the camera's
    kTurned90,  // the image is turned about its axis against the camera's frame
    kTurned180,
    kTurned270,
    kMirrored,     // the image's columns are in reverse order
    kFlipped,      // its rows are
    kMillimetres,  // the shift is given in metres where millimetres belong
    kMetres,       // the other way round
    kTurned,       // by another turn: of the hand-eye calibration, or the inverse of the pose was given
};
inline constexpr int kNumMotionMistakes = 10;

// What the image moves like: "as if the arm's motion were inverted".
const char* to_string(MotionMistake mistake);

struct ArmMotionOptions {
    int pairs = 8;  // of successive sightings, the last ones
    int min_pairs = 3;
    // Motions of the part in the camera's frame below so many standard deviations tell nothing.
    double min_motion_sigmas = 4.0;
    // The motion given is off by more than this share of itself, and what it is turned into by less than so much of
    // that.
    double off_share = 0.3;
    double explained_share = 0.3;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const ArmMotionOptions& options);

struct ArmMotion {
    int pairs = 0;           // that were compared
    double off_share = 0.0;  // by how much of itself the given motion is off: the median over the pairs
    MotionMistake mistake = MotionMistake::kNone;
};

// `radius_m`: half the model's diameter, by which turns are made lengths.
ArmMotion compare_motions(const std::vector<Sighting>& sightings, const Eigen::Vector3d& centre_in_object,
                          double radius_m, const ArmMotionOptions& options = {});

}  // namespace nearpose
