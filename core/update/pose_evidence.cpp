#include "core/update/pose_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/update/ray_grids.hpp"

namespace nearpose {

PoseEvidence evidence_at(const Pose& camera_from_object, const StepContext& context,
                         const RefinementOptions& refinement, const Frame& frame, double shared_sigma_m) {
    const PixelCostOptions options = refined_cost_options(context, refinement);
    const View view = context.views.generate(camera_from_object, context.observed.camera);
    const auto planes = fit_background(view, context.observed, options, frame.method().background);
    PoseEvidence evidence;
    evidence.pixels = pixel_cost(view, camera_from_object, context.observed, options);
    evidence.judged = evidence.pixels;
    if (shared_sigma_m > 0.0) {
        PixelCostOptions wider = options;
        wider.extra_sigma_m = std::hypot(options.extra_sigma_m, shared_sigma_m);
        evidence.judged = pixel_cost(view, camera_from_object, context.observed, wider);
    }
    evidence.positive =
        positive_evidence(view, camera_from_object, context.observed, planes, options, frame.method().background);
    evidence.log_odds_present = log_odds_present(evidence.positive, context.observed.grid.stride,
                                                 frame.method().pixel_cost, frame.observation.sensor());
    return evidence;
}

void penalise_absent(std::vector<Mode>& modes, const RefinementOptions& refinement, const Frame& frame) {
    const int rays = std::min(refinement.max_rays, frame.method().preselection.presence_rays);
    if (rays == 0) return;
    parallel_for(static_cast<int>(modes.size()), frame.options.num_threads, [&](int k) {
        const ObservedGrid observed = observe(frame.observation, ray_grid(frame, modes[k].camera_from_object, rays));
        const StepContext context = frame.context(observed, frame.method().step);
        const PoseEvidence evidence = evidence_at(modes[k].camera_from_object, context, refinement, frame);
        modes[k].log_evidence += std::min(0.0, evidence.log_odds_present);
    });
}

}  // namespace nearpose
