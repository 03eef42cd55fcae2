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
constexpr double kRough = 2.0;  // times the tolerance: a hypothesis that was not pulled yet is off by as much

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
std::vector<int> best_by(double PoseHypothesis::*measure, const std::vector<PoseHypothesis>& hypotheses,
                         std::size_t count) {
    std::vector<int> order;
    for (int i = 0; i < static_cast<int>(hypotheses.size()); ++i)
        if (hypotheses[i].share > 0.0 && hypotheses[i].*measure > 0.0) order.push_back(i);
    const auto better = [&](int a, int b) {
        const double of_a = hypotheses[a].*measure, of_b = hypotheses[b].*measure;
        return of_a != of_b ? of_a > of_b : a < b;
    };
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(count, order.size()));
    std::nth_element(order.begin(), end, order.end(), better);
    order.erase(end, order.end());
    std::sort(order.begin(), order.end(), better);
    return order;
}

// Best by share and best by gain in turns, where there is a gain; `distinct`: at most one from each cell of poses.
std::vector<PoseHypothesis> best_of(const std::vector<PoseHypothesis>& hypotheses, std::size_t count, bool distinct,
                                    const PruningScene& scene) {
    const std::size_t each = distinct ? hypotheses.size() : count;  // with doubles in both, never more
    const std::vector<int> by_share = best_by(&PoseHypothesis::share, hypotheses, each);
    const std::vector<int> by_gain =
        scene.model.empty() ? std::vector<int>{} : best_by(&PoseHypothesis::gain, hypotheses, each);
    std::vector<char> used(hypotheses.size(), 0);
    std::map<std::array<int, 6>, char> taken;
    std::vector<PoseHypothesis> best;
    const auto take = [&](const std::vector<int>& order, std::size_t& next) {
        for (; next < order.size(); ++next) {
            const int index = order[next];
            if (used[index]) continue;
            used[index] = 1;
            const PoseHypothesis& hypothesis = hypotheses[index];
            if (distinct) {
                char& held = taken[cell_of_pose(hypothesis.camera_from_object, scene.diameter_m,
                                                scene.surface.centre_in_object())];
                if (held) continue;
                held = 1;
            }
            best.push_back(hypothesis);
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

std::vector<OrientedPoint> balanced_sample(const SurfelGrid& grid, std::size_t count) {
    constexpr std::size_t kStep = 149;  // prime to most numbers of points
    const auto tells = [](const Surfel& surfel) {
        return surfel.draw_weight > 0.0 ? surfel.balanced_draw_weight : 0.0;
    };
    double sum = 0.0;
    for (const Surfel& surfel : grid.surfels) sum += tells(surfel);
    const double step = sum / static_cast<double>(count);
    std::vector<OrientedPoint> in_rows, points;
    double reached = 0.0, mark = 0.5 * step;
    for (const Surfel& surfel : grid.surfels) {
        reached += tells(surfel);
        for (; mark < reached && in_rows.size() < count; mark += step) in_rows.push_back(surfel.surface);
    }
    for (std::size_t k = 0; k < in_rows.size(); ++k) points.push_back(in_rows[k * kStep % in_rows.size()]);
    return points;
}

double evidence_gain(const PruningScene& scene, const Pose& camera_from_object, std::size_t count, double tolerance_m) {
    constexpr float kSameSide = 0.7F;  // cosine between the normals of what may be one surface
    constexpr float kAlongRay = 4.0F;  // tolerances: the surfel's plane holds no farther
    // As in the pixel cost, but a hypothesis is still off by more than a pose that was refined.
    constexpr float kDeepDiameters = 0.05F, kDeepCost = 3.0F;
    const float free_space_depth_m = kDeepDiameters * static_cast<float>(scene.diameter_m);
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = camera_from_object.translation.cast<float>();
    const PinholeCamera& camera = scene.camera;
    const auto tolerance = static_cast<float>(tolerance_m);
    const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
    const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
    const float stride = static_cast<float>(scene.surfels.stride);
    float gain = 0.0F;
    for (std::size_t k = 0; k < std::min(count, scene.model.size()); ++k) {
        const Eigen::Vector3f normal = rotation * scene.model[k].normal;
        const Eigen::Vector3f point = rotation * scene.model[k].point + translation;
        const float facing = -normal.dot(point);
        if (!(facing > 0.0F && point.z() > 0.0F)) continue;
        const float u = (fx * point.x() / point.z() + cx) / stride, v = (fy * point.y() / point.z() + cy) / stride;
        if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(scene.surfels.width) &&
              v < static_cast<float>(scene.surfels.height)))
            continue;
        const Surfel& surfel =
            scene.surfels.surfels[static_cast<std::size_t>(v) * scene.surfels.width + static_cast<std::size_t>(u)];
        if (!(surfel.point_in_camera.z() > 0.0F)) continue;
        const float cosine = facing / point.norm();
        const Eigen::Vector3f& plane = surfel.surface.normal;
        const Eigen::Vector3f off = point - surfel.point_in_camera;
        if (!plane.isZero() && std::abs(plane.dot(off)) < tolerance && std::abs(off.z()) < kAlongRay * tolerance)
            gain += plane.dot(normal) > kSameSide ? cosine * static_cast<float>(surfel.weight) : 0.0F;
        else if (off.z() < -tolerance)
            gain -= cosine * (1.0F + (kDeepCost - 1.0F) * std::clamp(-off.z() / free_space_depth_m - 1.0F, 0.0F, 1.0F));
    }
    return gain;
}

// Most hypotheses are wrong everywhere, which a few points tell.
PoseHypothesis coarsely_scored(const PruningScene& scene, const Pose& pose) {
    const double rough_m = kRough * scene.tolerance_m;
    if (inlier_share_on(scene.surface, pose, scene.measured, kFirst, rough_m) == 0.0 &&
        evidence_gain(scene, pose, kFirstModel, rough_m) <= 0.0)
        return {};
    return {pose, inlier_share_on(scene.surface, pose, scene.measured, kGlance, rough_m),
            evidence_gain(scene, pose, kGlanceModel, rough_m)};
}

std::vector<Pose> prune(std::vector<PoseHypothesis> hypotheses, const PruningScene& scene, int count) {
    constexpr std::size_t kGlancedAt = 4000, kPulledABit = 1500, kPulled = 300;  // hypotheses
    constexpr std::size_t kSomePoints = 128;
    constexpr int kFewRounds = 3, kRounds = 4;
    constexpr double kFine = 0.5;  // of the tolerance, once pulled
    const auto look = [&](int rounds, std::size_t points, double tolerance_m) {
        parallel_for(static_cast<int>(hypotheses.size()), scene.num_threads, [&](int i) {
            Pose& pose = hypotheses[i].camera_from_object;
            if (rounds > 0) pose = aligned_to_surface(scene.surface, pose, scene.measured, rounds, scene.tolerance_m);
            hypotheses[i].share = inlier_share_on(scene.surface, pose, scene.measured, points, tolerance_m);
            hypotheses[i].gain = evidence_gain(scene, pose, scene.model.size(), tolerance_m);
        });
    };
    hypotheses = best_of(hypotheses, kGlancedAt, false, scene);
    look(0, kSomePoints, kRough * scene.tolerance_m);
    hypotheses = best_of(hypotheses, kPulledABit, true, scene);
    look(kFewRounds, kSomePoints, scene.tolerance_m);
    hypotheses = best_of(hypotheses, kPulled, true, scene);
    look(kRounds, scene.measured.size(), kFine * scene.tolerance_m);
    std::vector<Pose> poses;
    for (const PoseHypothesis& hypothesis : best_of(hypotheses, static_cast<std::size_t>(count), true, scene))
        poses.push_back(hypothesis.camera_from_object);
    return poses;
}

}  // namespace nearpose
