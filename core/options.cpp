#include "core/options.hpp"

#include "core/base/check.hpp"

namespace nearpose {

void validate(const EstimatorOptions& options) {
    validate(options.method);
    check_option("num_particles", options.num_particles, 1, 1e6);
    check_option("num_threads", options.num_threads, 0, 4096);
    check_option("budget_s", options.budget_s, 0.0, 1e6);
    check_option("min_candidates", options.min_candidates, 1, 1e9);
    check_option("tolerance.translation_m", options.tolerance.translation_m, 1e-9, 1e6);
    check_option("tolerance.rotation_rad", options.tolerance.rotation_rad, 1e-9, 3.15);
    check_option("motion_noise.sigma_rotation_rad", options.motion_noise.sigma_rotation_rad, 0.0, 3.15);
    check_option("motion_noise.sigma_translation_m", options.motion_noise.sigma_translation_m, 0.0, 1e3);
    check_option("motion_noise.fraction", options.motion_noise.fraction, 0.0, 10.0);
    check_option("motion_noise.unknown_rotation_rad", options.motion_noise.unknown_rotation_rad, 0.0, 3.15);
    check_option("motion_noise.unknown_translation_m", options.motion_noise.unknown_translation_m, 0.0, 1e3);
}

}  // namespace nearpose
