#include "core/update/repeated_image.hpp"

#include "core/base/text.hpp"
#include "core/update/belief.hpp"

namespace nearpose {
UpdateResult predicted_alone(const Belief& predicted, const Frame& frame) {
    constexpr double kMillimetres = 1e3;
    UpdateResult result;
    result.points_observed = frame.observation.num_candidates();
    result.verdict = predicted.tracked ? Verdict::kContinue : Verdict::kLost;
    result.status = predicted.tracked ? UpdateStatus::kPredicted : UpdateStatus::kNoPose;
    const ImageMemory& image = predicted.image;
    const double moved_m = image.now_from_sample.translation.norm();
    result.missing = {{Requirement::kNewImage, static_cast<double>(image.repeats), 0.0,
                       frame.now_from_before ? fixed_text(kMillimetres * moved_m, 1) + " mm" : ""}};
    if (!predicted.tracked) return result;
    result.camera_from_object = predicted.tracked->camera_from_object;
    result.cost = predicted.tracked->cost;
    if (predicted.track)
        result.covariance = about_origin(predicted.track->whole_covariance(), frame.model.centre_in_object());
    return result;
}

}  // namespace nearpose
