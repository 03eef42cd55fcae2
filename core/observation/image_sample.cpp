#include "core/observation/image_sample.hpp"

#include <algorithm>
#include <cstddef>

#include "core/base/check.hpp"

namespace nearpose {

void validate(const RepeatedImageOptions& options) {
    check_option("repeated_image.columns", options.columns, 1, 10000);
    check_option("repeated_image.rows", options.rows, 1, 10000);
    check_option("repeated_image.min_measured", options.min_measured, 1, 1e9);
    check_option("repeated_image.rest_pixels", options.rest_pixels, 0.0, 1e6);
    check_option("repeated_image.equal_share", options.equal_share, 0.0, 1.0);
}

ImageSample sample_of(const Observation& observation, const RepeatedImageOptions& options) {
    const PinholeCamera& camera = observation.camera();
    ImageSample sample{camera.width, camera.height, {}};
    const int columns = std::min(options.columns, camera.width), rows = std::min(options.rows, camera.height);
    sample.depth_m.reserve(static_cast<std::size_t>(columns) * rows);
    const int step_u = camera.width / columns, step_v = camera.height / rows;
    for (int row = 0; row < rows; ++row) {
        const float* depth_m = observation.depth_m().data() + row * step_v * camera.width;
        for (int column = 0; column < columns; ++column) sample.depth_m.push_back(depth_m[column * step_u]);
    }
    return sample;
}

bool same_image(const ImageSample& a, const ImageSample& b, const RepeatedImageOptions& options) {
    if (!options.on || a.width != b.width || a.height != b.height || a.depth_m.size() != b.depth_m.size()) return false;
    int measured = 0, equal = 0;
    for (std::size_t i = 0; i < a.depth_m.size(); ++i) {
        if (!(a.depth_m[i] > 0.0F) && !(b.depth_m[i] > 0.0F)) continue;
        ++measured;
        equal += a.depth_m[i] == b.depth_m[i];
    }
    return measured >= options.min_measured && equal >= options.equal_share * measured;
}

namespace {

// Whether a motion shifts pixels by less than can be told.
bool at_rest(const Pose& now_from_before, const Observation& observation, double rest_pixels) {
    const Twist motion = log(now_from_before);
    const double angle_rad =
        motion.head<3>().norm() + motion.tail<3>().norm() / std::max(observation.mean_distance_m(), 1e-3);
    return angle_rad * observation.camera().fx < rest_pixels;
}

}  // namespace

ImageMemory seen_again(const ImageMemory& before, const Observation& observation,
                       const std::optional<Pose>& now_from_before, const RepeatedImageOptions& options) {
    ImageMemory now{sample_of(observation, options), 0, {}};
    if (!same_image(before.sample, now.sample, options)) return now;
    const Pose moved = now_from_before.value_or(Pose{}) * before.now_from_sample;
    const bool may_be_equal =
        before.repeats == 0 && now_from_before && at_rest(moved, observation, options.rest_pixels);
    // The motion adds up from the first of the equal images on, however slow it is.
    return {before.sample, may_be_equal ? 0 : before.repeats + 1, moved};
}

}  // namespace nearpose
