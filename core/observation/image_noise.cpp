#include "core/observation/image_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/check.hpp"
#include "core/base/statistics.hpp"

namespace nearpose {
namespace {

// |second difference of the inverse depth| along the row [1 / m].
double second_difference(const OrganisedImage& image, int pixel, int reach) {
    return std::abs(1.0 / image.depth_m[pixel - reach] - 2.0 / image.depth_m[pixel] +
                    1.0 / image.depth_m[pixel + reach]);
}

double quantile(std::vector<double>& values, double share) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

}  // namespace

void validate(const NoiseOptions& options) {
    check_option("observation.noise.reach_pixels", options.reach_pixels, 1, 1e4);
    check_option("observation.noise.samples", options.samples, 1, 1e9);
    check_option("observation.noise.min_samples", options.min_samples, 1, 1e9);
    check_option("observation.noise.least_factor", options.least_factor, 0.0, 1e3);
    check_option("observation.noise.most_factor", options.most_factor, options.least_factor, 1e3);
    check_option("observation.noise.small_reach_pixels", options.small_reach_pixels, 1, 1e4);
    check_option("observation.noise.great_reach_pixels", options.great_reach_pixels, options.small_reach_pixels, 1e4);
    check_option("observation.noise.shared_ratio", options.shared_ratio, 0.0, 1e3);
    check_option("observation.noise.independent_ratio", options.independent_ratio, options.shared_ratio, 1e3);
}

double measured_noise_factor(const OrganisedImage& image, const PinholeCamera& camera,
                             const CandidateExtent& candidates, const SensorModel& sensor,
                             const NoiseOptions& options) {
    const int reach = options.reach_pixels;
    std::vector<double> ratios;
    const int stride = std::max(1, static_cast<int>(std::sqrt(candidates.count / options.samples)));
    for (int v = candidates.box.first_v; v < candidates.box.last_v; v += stride) {
        for (int u = candidates.box.first_u + reach; u < candidates.box.last_u - reach; u += stride) {
            const int pixel = v * camera.width + u;
            bool usable = true;
            for (const int other : {pixel - reach, pixel, pixel + reach})
                usable = usable && image.states[other] == PixelState::kCandidate;
            if (!usable) continue;
            const double z_m = image.depth_m[pixel];
            const double second = second_difference(image, pixel, reach);
            ratios.push_back(second * z_m * z_m / (std::sqrt(6.0) * sensor.sigma_m(z_m)));
        }
    }
    if (ratios.empty() || ratios.size() < static_cast<std::size_t>(options.min_samples)) return 1.0;
    return std::clamp(median(std::move(ratios)) / kMedianOfAbsoluteNormal, options.least_factor, options.most_factor);
}

double measured_shared_noise(const OrganisedImage& image, const PinholeCamera& camera, const NoiseOptions& options) {
    constexpr double kShare = 0.4;  // below the median: edges and curved surfaces are among the larger ones
    const int near = options.small_reach_pixels, far = options.great_reach_pixels;
    const double pixels = static_cast<double>(camera.width) * camera.height;
    const int stride = std::max(1, static_cast<int>(std::sqrt(pixels / options.samples)));
    std::vector<double> small, great;
    for (int v = 0; v < camera.height; v += stride) {
        for (int u = far; u < camera.width - far; u += stride) {
            const int pixel = v * camera.width + u;
            bool usable = true;
            for (const int other : {pixel - far, pixel - near, pixel, pixel + near, pixel + far})
                usable = usable && image.states[other] != PixelState::kNoDepth;
            if (!usable) continue;
            const double z_m = image.depth_m[pixel];
            small.push_back(z_m * second_difference(image, pixel, near));
            great.push_back(z_m * second_difference(image, pixel, far));
        }
    }
    if (small.empty() || small.size() < static_cast<std::size_t>(options.min_samples)) return 1.0;
    const double over = quantile(great, kShare);
    if (!(over > 0.0)) return 1.0;
    const double doubt = options.independent_ratio - options.shared_ratio;
    const double above = quantile(small, kShare) / over - options.shared_ratio;
    if (!(doubt > 0.0)) return above > 0.0 ? 0.0 : 1.0;
    return 1.0 - std::clamp(above / doubt, 0.0, 1.0);
}

}  // namespace nearpose
