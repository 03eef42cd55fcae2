#include "core/search/hypothesis_pruning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/base/parallel.hpp"

namespace nearpose {
namespace {

constexpr std::size_t kFirst = 8, kFirstModel = 16;  // points
constexpr std::size_t kGlance = 32, kGlanceModel = 64;
constexpr double kRough = 2.0;  // times the tolerance: a guess that was not pulled yet is off by as much

// Poses of one cell are of one basin; the cells are coarse.
std::array<int, 6> cell_of_pose(const Pose& pose, double diameter_m, const Eigen::Vector3d& centre) {
    constexpr double kLength = 0.06, kTurn = 0.25;
    const Eigen::Vector3d place = pose * centre / (kLength * diameter_m);
    const Eigen::Matrix3d axes = pose.rotation_matrix();
    std::array<int, 6> cell{};
    for (int i = 0; i < 3; ++i) {
        cell[i] = static_cast<int>(std::floor(place[i]));
        cell[3 + i] = static_cast<int>(std::floor((i < 2 ? axes(i, 0) : axes(0, 1)) / kTurn));
    }
    return cell;
}

// Indices of the poses, the best `count` by one measure first.
std::vector<int> best_by(double Guess::*measure, const std::vector<Guess>& guesses, std::size_t count) {
    std::vector<int> order;
    for (int i = 0; i < static_cast<int>(guesses.size()); ++i)
        if (guesses[i].share > 0.0 && guesses[i].*measure > 0.0) order.push_back(i);
    const auto better = [&](int a, int b) {
        const double of_a = guesses[a].*measure, of_b = guesses[b].*measure;
        return of_a != of_b ? of_a > of_b : a < b;
    };
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(count, order.size()));
    std::nth_element(order.begin(), end, order.end(), better);
    order.erase(end, order.end());
    std::sort(order.begin(), order.end(), better);
    return order;
}

// Best by share and best by gain in turns, where there is a gain; `distinct`: at most one from each cell of poses.
std::vector<Guess> best_of(const std::vector<Guess>& guesses, std::size_t count, bool distinct, const Screen& screen) {
    const std::size_t each = distinct ? guesses.size() : count;  // with doubles in both, never more
    const std::vector<int> by_share = best_by(&Guess::share, guesses, each);
    const std::vector<int> by_gain = screen.model.empty() ? std::vector<int>{} : best_by(&Guess::gain, guesses, each);
    std::vector<char> used(guesses.size(), 0);
    std::map<std::array<int, 6>, char> taken;
    std::vector<Guess> best;
    const auto take = [&](const std::vector<int>& order, std::size_t& next) {
        for (; next < order.size(); ++next) {
            const int index = order[next];
            if (used[index]) continue;
            used[index] = 1;
            const Guess& guess = guesses[index];
            if (distinct) {
                char& held =
                    taken[cell_of_pose(guess.camera_from_object, screen.diameter_m, screen.surface.centre_in_object())];
                if (held) continue;
                held = 1;
            }
            best.push_back(guess);
            return;
        }
    };
    std::size_t next_share = 0, next_gain = 0;
    while (best.size() < count && (next_share < by_share.size() || next_gain < by_gain.size())) {
        take(by_share, next_share);
        if (best.size() < count) take(by_gain, next_gain);
    }
    return best;
}

}  // namespace

std::vector<SurfaceAnchor> telling_points(const PatchGrid& grid, std::size_t count) {
    constexpr std::size_t kStep = 149;  // prime to most numbers of points
    const auto tells = [](const Patch& patch) { return patch.rarity > 0.0 ? patch.telling : 0.0; };
    double sum = 0.0;
    for (const Patch& patch : grid.patches) sum += tells(patch);
    const double step = sum / static_cast<double>(count);
    std::vector<SurfaceAnchor> in_rows, points;
    double reached = 0.0, mark = 0.5 * step;
    for (const Patch& patch : grid.patches) {
        reached += tells(patch);
        for (; mark < reached && in_rows.size() < count; mark += step) in_rows.push_back(patch.surface);
    }
    for (std::size_t k = 0; k < in_rows.size(); ++k) points.push_back(in_rows[k * kStep % in_rows.size()]);
    return points;
}

double gain_on_patches(const Screen& screen, const Pose& camera_from_object, std::size_t count, double tolerance_m) {
    constexpr float kSameSide = 0.7F;  // cosine between the normals of what may be one surface
    constexpr float kAlongRay = 4.0F;  // tolerances: the patch's plane holds no farther
    // As in the pixel cost, but a guess is still off by more than a pose that was refined.
    constexpr float kDeepDiameters = 0.05F, kDeepCost = 3.0F;
    const float deep_m = kDeepDiameters * static_cast<float>(screen.diameter_m);
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = camera_from_object.translation.cast<float>();
    const PinholeCamera& camera = screen.camera;
    const auto tolerance = static_cast<float>(tolerance_m);
    const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
    const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
    const float stride = static_cast<float>(screen.patches.stride);
    float gain = 0.0F;
    for (std::size_t k = 0; k < std::min(count, screen.model.size()); ++k) {
        const Eigen::Vector3f normal = rotation * screen.model[k].normal_in_object;
        const Eigen::Vector3f point = rotation * screen.model[k].point_in_object + translation;
        const float facing = -normal.dot(point);
        if (!(facing > 0.0F && point.z() > 0.0F)) continue;
        const float u = (fx * point.x() / point.z() + cx) / stride, v = (fy * point.y() / point.z() + cy) / stride;
        if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(screen.patches.width) &&
              v < static_cast<float>(screen.patches.height)))
            continue;
        const Patch& patch =
            screen.patches.patches[static_cast<std::size_t>(v) * screen.patches.width + static_cast<std::size_t>(u)];
        if (!(patch.point_in_camera.z() > 0.0F)) continue;
        const float cosine = facing / point.norm();
        const Eigen::Vector3f& plane = patch.surface.normal_in_object;
        const Eigen::Vector3f off = point - patch.point_in_camera;
        if (!plane.isZero() && std::abs(plane.dot(off)) < tolerance && std::abs(off.z()) < kAlongRay * tolerance)
            gain += plane.dot(normal) > kSameSide ? cosine * static_cast<float>(patch.weight) : 0.0F;
        else if (off.z() < -tolerance)
            gain -= cosine * (1.0F + (kDeepCost - 1.0F) * std::clamp(-off.z() / deep_m - 1.0F, 0.0F, 1.0F));
    }
    return gain;
}

// Most guesses are wrong everywhere, which a few points tell.
Guess glanced_at(const Screen& screen, const Pose& pose) {
    const double rough_m = kRough * screen.tolerance_m;
    if (share_on_surface(screen.surface, pose, screen.measured, kFirst, rough_m) == 0.0 &&
        gain_on_patches(screen, pose, kFirstModel, rough_m) <= 0.0)
        return {};
    return {pose, share_on_surface(screen.surface, pose, screen.measured, kGlance, rough_m),
            gain_on_patches(screen, pose, kGlanceModel, rough_m)};
}

std::vector<Pose> screened(std::vector<Guess> guesses, const Screen& screen, int count) {
    constexpr std::size_t kGlancedAt = 4000, kPulledABit = 1500, kPulled = 300;  // guesses
    constexpr std::size_t kSomePoints = 128;
    constexpr int kFewRounds = 3, kRounds = 4;
    constexpr double kFine = 0.5;  // of the tolerance, once pulled
    const auto look = [&](int rounds, std::size_t points, double tolerance_m) {
        parallel_for(static_cast<int>(guesses.size()), screen.num_threads, [&](int i) {
            Pose& pose = guesses[i].camera_from_object;
            if (rounds > 0)
                pose = pulled_onto_surface(screen.surface, pose, screen.measured, rounds, screen.tolerance_m);
            guesses[i].share = share_on_surface(screen.surface, pose, screen.measured, points, tolerance_m);
            guesses[i].gain = gain_on_patches(screen, pose, screen.model.size(), tolerance_m);
        });
    };
    guesses = best_of(guesses, kGlancedAt, false, screen);
    look(0, kSomePoints, kRough * screen.tolerance_m);
    guesses = best_of(guesses, kPulledABit, true, screen);
    look(kFewRounds, kSomePoints, screen.tolerance_m);
    guesses = best_of(guesses, kPulled, true, screen);
    look(kRounds, screen.measured.size(), kFine * screen.tolerance_m);
    std::vector<Pose> poses;
    for (const Guess& guess : best_of(guesses, static_cast<std::size_t>(count), true, screen))
        poses.push_back(guess.camera_from_object);
    return poses;
}

}  // namespace nearpose
