#include "apps/scenes/image_faults.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/base/simulation_draws.hpp"
#include "apps/scenes/pixel_moves.hpp"

namespace nearpose::simulate {
namespace {

RandomStream draws_of(const ImageContext& context) {
    return {context.seed, static_cast<std::uint64_t>(context.frame), static_cast<std::uint64_t>(context.fault),
            kFaultDraw};
}

template <typename Law>  // of a depth and its pixel (u, v); holes stay
void change_depths(DepthImage& depth, const Law& law) {
    for (int v = 0; v < depth.height; ++v) {
        for (int u = 0; u < depth.width; ++u) {
            float& value_m = depth.depth_m[static_cast<std::size_t>(v) * depth.width + u];
            if (value_m > 0.0F) value_m = static_cast<float>(law(static_cast<double>(value_m), u, v));
        }
    }
}

void drop_rows(const ImageContext& context, DepthImage& depth) {
    constexpr int kBands = 60;
    constexpr double kMissing = 0.3;
    const int rows = std::max(1, depth.height / kBands);
    RandomStream random = draws_of(context);
    for (int v = 0; v < depth.height; v += rows) {
        if (random.uniform() >= kMissing) continue;
        const auto first = depth.depth_m.begin() + static_cast<std::ptrdiff_t>(v) * depth.width;
        std::fill(first, first + static_cast<std::ptrdiff_t>(std::min(rows, depth.height - v)) * depth.width, 0.0F);
    }
}

void add_salt_and_pepper(const ImageContext& context, double share, DepthImage& depth) {
    RandomStream random = draws_of(context);
    for (float& value_m : depth.depth_m) {
        const double draw = random.uniform();
        if (draw < share) value_m = static_cast<float>(draw < 0.5 * share ? context.min_range_m : context.max_range_m);
    }
}

void punch_holes(const ImageContext& context, double share, DepthImage& depth) {
    constexpr double kLeastRadius = 0.01, kMostRadius = 0.04;  // of the image's width
    const auto wanted = static_cast<std::int64_t>(share * static_cast<double>(depth.depth_m.size()));
    std::vector<bool> is_hole(depth.depth_m.size(), false);
    RandomStream random = draws_of(context);
    for (std::int64_t pixels = 0; pixels < wanted;) {
        const int middle_u = random.below(depth.width), middle_v = random.below(depth.height);
        const auto radius = static_cast<int>(std::ceil(depth.width * random.uniform(kLeastRadius, kMostRadius)));
        for (int v = std::max(0, middle_v - radius); v <= std::min(depth.height - 1, middle_v + radius); ++v) {
            for (int u = std::max(0, middle_u - radius); u <= std::min(depth.width - 1, middle_u + radius); ++u) {
                const auto pixel = static_cast<std::size_t>(v) * depth.width + u;
                const int du = u - middle_u, dv = v - middle_v;
                if (du * du + dv * dv > radius * radius || is_hole[pixel]) continue;
                is_hole[pixel] = true;
                depth.depth_m[pixel] = 0.0F;
                if (++pixels == wanted) return;
            }
        }
    }
}

// A fist that circles about the image's middle, and a forearm from below, nearer than all else.
void put_hand(const ImageContext& context, DepthImage& depth, Mask& mask) {
    constexpr double kFist = 0.22, kForearm = 0.13, kTurn_rad = 0.15, kRounded = 0.08, kNearness = 0.7;
    std::vector<float> measured;
    std::copy_if(context.exact.depth.depth_m.begin(), context.exact.depth.depth_m.end(), std::back_inserter(measured),
                 [](float value_m) { return value_m > 0.0F; });
    double nearest_m = context.max_range_m;
    if (!measured.empty()) nearest_m = *std::min_element(measured.begin(), measured.end());
    const double hand_m = std::max(context.min_range_m, kNearness * nearest_m);
    const double angle = kTurn_rad * context.frame, height = depth.height;
    const double fist_u = depth.width * (0.5 + 0.1 * std::cos(angle)), fist_v = height * (0.5 + 0.1 * std::sin(angle));
    for (int v = 0; v < depth.height; ++v) {
        for (int u = 0; u < depth.width; ++u) {
            const double of_fist = std::hypot(u - fist_u, v - fist_v) / (kFist * height);
            const double of_forearm = v > fist_v ? std::abs(u - fist_u) / (kForearm * height) : 2.0;
            const double beside = std::min(of_fist, of_forearm);  // 1 at its outline
            if (beside > 1.0) continue;
            const auto pixel = static_cast<std::size_t>(v) * depth.width + u;
            depth.depth_m[pixel] = static_cast<float>(hand_m * (1.0 + kRounded * beside * beside));
            mask.value[pixel] = 0;
        }
    }
}

// The camera's own light falls off with the square of the distance, and with the angle to the surface's normal.
void overexpose(const ImageContext& context, double share, DepthImage& depth) {
    std::vector<std::pair<double, std::size_t>> dark_first;  // minus the brightness of pixels that have a depth
    for (std::size_t pixel = 0; pixel < depth.depth_m.size(); ++pixel) {
        const double exact_m = context.exact.depth.depth_m[pixel];
        if (!(depth.depth_m[pixel] > 0.0F) || !(exact_m > 0.0)) continue;
        const auto width = static_cast<std::size_t>(depth.width);
        const Eigen::Vector3d ray =
            context.camera.ray(static_cast<double>(pixel % width), static_cast<double>(pixel / width));
        const double cosine = -context.exact.normals_in_camera[pixel].cast<double>().dot(ray.normalized());
        dark_first.emplace_back(-cosine / (ray.squaredNorm() * exact_m * exact_m), pixel);
    }
    const auto count = static_cast<std::ptrdiff_t>(share * static_cast<double>(dark_first.size()));
    std::nth_element(dark_first.begin(), dark_first.begin() + count, dark_first.end());
    for (auto it = dark_first.begin(); it != dark_first.begin() + count; ++it) depth.depth_m[it->second] = 0.0F;
}

void wave(double amplitude_m, DepthImage& depth) {
    constexpr double kPeriods = 12.0, kSlant = 0.5;  // across the image's width
    const double per_pixel = 2.0 * std::numbers::pi * kPeriods / depth.width;
    change_depths(depth, [&](double depth_m, int u, int v) {
        return std::max(0.0, depth_m + amplitude_m * std::sin(per_pixel * (u + kSlant * v)));
    });
}

}  // namespace

void apply_fault(const Fault& fault, const ImageContext& context, DepthImage& depth, Mask& mask) {
    const auto whole = static_cast<int>(fault.value);
    const double metres = 1e-3 * fault.value;
    switch (fault.kind) {
        case FaultKind::kRotated:
            depth.depth_m = turned(depth.depth_m, depth.width, depth.height, whole);
            mask.value = turned(mask.value, mask.width, mask.height, whole);
            return;
        case FaultKind::kMirrored:
            mirror(depth.depth_m, depth.width);
            return mirror(mask.value, mask.width);
        case FaultKind::kShift:
            return shift_right(depth, whole);
        case FaultKind::kEdges:
            return grow_near_surfaces(depth, whole);
        case FaultKind::kRowsMissing:
            return drop_rows(context, depth);
        case FaultKind::kSaltPepper:
            return add_salt_and_pepper(context, fault.value, depth);
        case FaultKind::kHoles:
            return punch_holes(context, fault.value, depth);
        case FaultKind::kHand:
            return put_hand(context, depth, mask);
        case FaultKind::kQuantised:
            return change_depths(depth, [&](double d, int, int) { return std::round(d / metres) * metres; });
        case FaultKind::kWaves:
            return wave(metres, depth);
        case FaultKind::kDepthScale:
            return change_depths(depth, [&](double d, int, int) { return d * (1.0 + 0.01 * fault.value); });
        case FaultKind::kDecimation:
            return decimate(depth, whole);
        case FaultKind::kHoleFilling:
            return fill_from_left(depth);
        case FaultKind::kExposureHoles:
            return overexpose(context, fault.value, depth);
        default:
            return;
    }
}

DepthImage temporally_filtered(const DepthImage& before, DepthImage now, double alpha) {
    constexpr double kDelta_m = 0.020;
    for (std::size_t pixel = 0; pixel < now.depth_m.size(); ++pixel) {
        const double old_m = before.depth_m[pixel], new_m = now.depth_m[pixel];
        if (!(old_m > 0.0)) continue;
        if (!(new_m > 0.0))
            now.depth_m[pixel] = before.depth_m[pixel];
        else if (std::abs(new_m - old_m) < kDelta_m)
            now.depth_m[pixel] = static_cast<float>(alpha * new_m + (1.0 - alpha) * old_m);
    }
    return now;
}

void apply_faults(const std::vector<Fault>& faults, ImageContext context, FaultMemory& memory, DepthImage& depth,
                  Mask& mask) {
    for (std::size_t number = 0; number < faults.size(); ++number) {
        const Fault& fault = faults[number];
        context.fault = static_cast<int>(number);
        if (!fault.is_in(context.frame)) {
            memory.erase(number);
        } else if (fault.kind != FaultKind::kTemporalFilter) {
            apply_fault(fault, context, depth, mask);
        } else {
            const auto before = memory.find(number);
            if (before != memory.end()) depth = temporally_filtered(before->second, std::move(depth), fault.value);
            memory[number] = depth;
        }
    }
}

}  // namespace nearpose::simulate
