#include "core/search/hypothesis_pruning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/base/parallel.hpp"

namespace nearpose {
namespace {

using PoseCell = std::array<int, 6>;

// Cells of the model's place and of three components of its axes, which suffice to tell rotations apart roughly.
PoseCell cell_of(const Pose& pose, const PruningContext& context) {
    const PruningOptions& options = context.options;
    const Eigen::Vector3d place =
        pose * context.surface.centre_in_object() / (options.cell_diameters * context.diameter_m);
    const Eigen::Matrix3d axes = pose.rotation_matrix();
    PoseCell cell{};
    for (int i = 0; i < 3; ++i) {
        cell[i] = static_cast<int>(std::floor(place[i]));
        cell[3 + i] = static_cast<int>(std::floor((i < 2 ? axes(i, 0) : axes(0, 1)) / options.cell_cosine));
    }
    return cell;
}

// Indices of the hypotheses, the best `count` by one score first.
std::vector<int> best_by(double PoseHypothesis::*score, const std::vector<PoseHypothesis>& hypotheses,
                         std::size_t count) {
    std::vector<int> order;
    for (int i = 0; i < static_cast<int>(hypotheses.size()); ++i)
        if (hypotheses[i].inlier_share > 0.0 && hypotheses[i].*score > 0.0) order.push_back(i);
    const auto better = [&](int a, int b) {
        const double of_a = hypotheses[a].*score, of_b = hypotheses[b].*score;
        return of_a != of_b ? of_a > of_b : a < b;
    };
    const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(count, order.size()));
    std::nth_element(order.begin(), end, order.end(), better);
    order.erase(end, order.end());
    std::sort(order.begin(), order.end(), better);
    return order;
}

// Best by either score in turns, where there are points of the model to score by. `distinct`: at most one from each
// cell of poses.
std::vector<PoseHypothesis> best_of(const std::vector<PoseHypothesis>& hypotheses, std::size_t count, bool distinct,
                                    const PruningContext& context) {
    const std::size_t each = distinct ? hypotheses.size() : count;  // distinct ones may lie far down in the order
    const std::vector<int> by_share = best_by(&PoseHypothesis::inlier_share, hypotheses, each);
    const std::vector<int> by_model =
        context.model.empty() ? std::vector<int>{} : best_by(&PoseHypothesis::model_score, hypotheses, each);
    std::vector<char> used(hypotheses.size(), 0);
    std::map<PoseCell, char> taken;
    std::vector<PoseHypothesis> best;
    const auto take_next = [&](const std::vector<int>& order, std::size_t& next) {
        for (; next < order.size(); ++next) {
            const int index = order[next];
            if (used[index]) continue;
            used[index] = 1;
            const PoseHypothesis& hypothesis = hypotheses[index];
            if (distinct) {
                char& held = taken[cell_of(hypothesis.camera_from_object, context)];
                if (held) continue;
                held = 1;
            }
            best.push_back(hypothesis);
            return;
        }
    };
    std::size_t next_share = 0, next_model = 0;
    while (best.size() < count && (next_share < by_share.size() || next_model < by_model.size())) {
        take_next(by_share, next_share);
        if (best.size() < count) take_next(by_model, next_model);
    }
    return best;
}

// The surfel that a point in camera coordinates (before the camera) is seen at; null out of the image or unmeasured.
class SurfelProjection {
  public:
    SurfelProjection(const PinholeCamera& camera, const SurfelGrid& grid)
        : grid_(grid),
          fx_(static_cast<float>(camera.fx)),
          fy_(static_cast<float>(camera.fy)),
          cx_(static_cast<float>(camera.cx)),
          cy_(static_cast<float>(camera.cy)),
          stride_(static_cast<float>(grid.stride)),
          width_(static_cast<float>(grid.width)),
          height_(static_cast<float>(grid.height)) {}

    const Surfel* operator()(const Eigen::Vector3f& point) const {
        const float u = (fx_ * point.x() / point.z() + cx_) / stride_;
        const float v = (fy_ * point.y() / point.z() + cy_) / stride_;
        if (!(u >= 0.0F && v >= 0.0F && u < width_ && v < height_)) return nullptr;
        const Surfel& surfel = grid_.surfels[static_cast<std::size_t>(v) * grid_.width + static_cast<std::size_t>(u)];
        return surfel.point_in_camera.z() > 0.0F ? &surfel : nullptr;
    }

  private:
    const SurfelGrid& grid_;
    float fx_, fy_, cx_, cy_, stride_, width_, height_;
};

// Scores all hypotheses of a stage, and aligns them before.
void score(std::vector<PoseHypothesis>& hypotheses, const PruningStage& stage, const PruningContext& context) {
    const std::size_t points = stage.points > 0 ? static_cast<std::size_t>(stage.points) : context.measured.size();
    const double tolerance_m = stage.score_tolerances * context.tolerance_m;
    parallel_for(static_cast<int>(hypotheses.size()), context.num_threads, [&](int i) {
        Pose& pose = hypotheses[i].camera_from_object;
        if (stage.alignment_rounds > 0)
            pose = align_to_surface(context.surface, pose, context.measured, stage.alignment_rounds,
                                    context.tolerance_m, context.options.alignment);
        hypotheses[i].inlier_share =
            inlier_share(context.surface, pose, context.measured, points, tolerance_m, context.options.inliers);
        hypotheses[i].model_score = model_score(context, pose, context.model.size(), tolerance_m);
    });
}

}  // namespace

double model_score(const PruningContext& context, const Pose& camera_from_object, std::size_t count,
                   double tolerance_m) {
    const PruningOptions& options = context.options;
    const float free_space_depth_m = options.free_space_depth_diameters * static_cast<float>(context.diameter_m);
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = camera_from_object.translation.cast<float>();
    const SurfelProjection surfel_at(context.camera, context.surfels);
    const auto tolerance = static_cast<float>(tolerance_m);
    const float max_depth_m = options.inliers.max_depth_tolerances * tolerance;
    float sum = 0.0F;
    for (std::size_t k = 0; k < std::min(count, context.model.size()); ++k) {
        const Eigen::Vector3f normal = rotation * context.model[k].normal;
        const Eigen::Vector3f point = rotation * context.model[k].point + translation;
        const float facing = -normal.dot(point);
        if (!(facing > 0.0F && point.z() > 0.0F)) continue;
        const Surfel* surfel = surfel_at(point);
        if (surfel == nullptr) continue;
        const float cosine = facing / point.norm();
        const Eigen::Vector3f& plane = surfel->surface.normal;
        const Eigen::Vector3f off = point - surfel->point_in_camera;
        if (!plane.isZero() && std::abs(plane.dot(off)) < tolerance && std::abs(off.z()) < max_depth_m) {
            if (plane.dot(normal) > options.inliers.min_normal_cosine)
                sum += cosine * static_cast<float>(surfel->evidence_weight);
        } else if (off.z() < -tolerance) {
            const float deep = std::clamp(-off.z() / free_space_depth_m - 1.0F, 0.0F, 1.0F);
            sum -= cosine * (1.0F + (options.free_space_cost - 1.0F) * deep);
        }
    }
    return sum;
}

PoseHypothesis score_coarsely(const PruningContext& context, const Pose& pose) {
    const PruningOptions& options = context.options;
    const double tolerance_m = options.coarse_tolerances * context.tolerance_m;
    const auto share_of = [&](int points) {
        return inlier_share(context.surface, pose, context.measured, static_cast<std::size_t>(points), tolerance_m,
                            options.inliers);
    };
    const auto score_of = [&](int points) {
        return model_score(context, pose, static_cast<std::size_t>(points), tolerance_m);
    };
    if (share_of(options.first_points) == 0.0 && score_of(options.first_model_points) <= 0.0) return {};
    return {pose, share_of(options.coarse_points), score_of(options.coarse_model_points)};
}

std::vector<Pose> prune_hypotheses(std::vector<PoseHypothesis> hypotheses, const PruningContext& context, int count,
                                   double share) {
    for (const PruningStage& stage : context.options.stages) {
        const int kept = std::max(count, static_cast<int>(std::ceil(share * stage.kept)));
        hypotheses = best_of(hypotheses, static_cast<std::size_t>(kept), stage.distinct, context);
        score(hypotheses, stage, context);
    }
    std::vector<Pose> poses;
    for (const PoseHypothesis& hypothesis : best_of(hypotheses, static_cast<std::size_t>(count), true, context))
        poses.push_back(hypothesis.camera_from_object);
    return poses;
}

}  // namespace nearpose
