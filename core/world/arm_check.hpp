// Image and arm held against each other: what the verdict wants to know of the set-up.
#pragma once

#include "core/evidence/verdict.hpp"
#include "core/world/arm_motion.hpp"
#include "core/world/still_world.hpp"

namespace nearpose {

struct ArmCheckOptions {
    bool on = true;
    SightingOptions sightings;
    ArmMotionOptions motion;
    StillWorldOptions still_world;
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const ArmCheckOptions& options);

struct ArmFindings {
    int frames_since_move = Evidence::kNeverMoved;  // since image and arm last contradicted each other
    ArmMotion motion;
    StillWorld world;
};

ArmFindings check_arm(const Sightings& sightings, const Eigen::Vector3d& centre_in_object, double radius_m,
                      const ArmCheckOptions& options);

}  // namespace nearpose
