#include "core/world/arm_check.hpp"

namespace nearpose {

void validate(const ArmCheckOptions& options) {
    validate(options.sightings);
    validate(options.motion);
    validate(options.still_world);
}

ArmFindings check_arm(const Sightings& sightings, const Eigen::Vector3d& centre_in_object, double radius_m,
                      const ArmCheckOptions& options) {
    ArmFindings findings;
    if (!options.on) return findings;
    const std::vector<Sighting>& kept = sightings.kept;
    findings.frames_since_move = sightings.frames_since_move.value_or(Evidence::kNeverMoved);
    findings.motion = compare_motions(kept, centre_in_object, radius_m, options.motion);
    findings.world = compare_causes(kept, centre_in_object, options.still_world);
    return findings;
}

}  // namespace nearpose
