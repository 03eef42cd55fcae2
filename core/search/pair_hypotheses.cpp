#include "core/search/pair_hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/search/hypothesis_pruning.hpp"

namespace nearpose {
namespace {

// Within which model and depth agree, as a start [m].
double initial_tolerance_m(const Observation& observation, const PointPairTable& pairs,
                           const PairSearchOptions& options) {
    return options.tolerance_min_distances * pairs.min_distance_m() +
           options.tolerance_sigmas * observation.sigma_m(observation.mean_distance_m());
}

// Half the side of a normal's window [pixels].
int normal_reach(const Observation& observation, const PointPairTable& pairs, const SurfelOptions& options) {
    constexpr double kNearest_m = 1e-3;
    const double pixels = observation.camera().fx * options.reach_min_distances * pairs.min_distance_m() /
                          std::max(kNearest_m, observation.mean_distance_m());
    return std::clamp(static_cast<int>(pixels), options.min_reach_pixels, options.max_reach_pixels);
}

// Right-handed axes of a pair: the first normal, the line between the points made square to it, and their product.
// Nothing where the line runs along the normal.
std::optional<Eigen::Matrix3d> axes_of(const OrientedPoint& first, const OrientedPoint& second, double min_sine) {
    const Eigen::Vector3d normal = first.normal.cast<double>();
    const Eigen::Vector3d line = (second.point - first.point).cast<double>();
    const Eigen::Vector3d across = line - line.dot(normal) * normal;
    if (across.norm() < min_sine * line.norm()) return std::nullopt;
    Eigen::Matrix3d axes;
    axes.col(0) = normal.normalized();
    axes.col(1) = across.normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
}

// Draws hypotheses from the surfels, each as likely as one of their weights says.
class HypothesisSampler {
  public:
    HypothesisSampler(double Surfel::*weight, const Observation& observation, const PointPairTable& pairs,
                      const SurfelGrid& surfels, const PairSearchOptions& options)
        : weight_(weight), camera_(observation.camera()), pairs_(pairs), surfels_(surfels), options_(options) {
        double sum = 0.0;
        for (const Surfel& surfel : surfels.surfels)
            cumulative_weights_.push_back(sum += surfel.draw_weight > 0.0 ? surfel.*weight : 0.0);
    }

    bool can_draw() const { return !cumulative_weights_.empty() && cumulative_weights_.back() > 0.0; }

    // A measured point on any of the model's, turned about the normal at random.
    std::optional<Pose> pose_from_point(RandomStream& random) const {
        const OrientedPoint& measured = draw_surfel(random);
        const std::vector<OrientedPoint>& points = pairs_.points();
        return pose_aligning(points[random.below(static_cast<int>(points.size()))], measured,
                             random.uniform(0.0, 2.0 * M_PI));
    }

    // A measured pair on one of the model's that match it.
    std::optional<Pose> pose_from_pair(RandomStream& random) const;

  private:
    // A second measured point, and the model's pairs that match the first one and it.
    struct SecondPoint {
        const OrientedPoint* measured = nullptr;
        const std::vector<PointPairTable::Pair>* matches = nullptr;
    };

    const OrientedPoint& draw_surfel(RandomStream& random) const;
    SecondPoint draw_second(const OrientedPoint& first, RandomStream& random) const;

    double Surfel::*weight_;
    const PinholeCamera& camera_;
    const PointPairTable& pairs_;
    const SurfelGrid& surfels_;
    const PairSearchOptions& options_;
    std::vector<double> cumulative_weights_;  // of the surfels
};

const OrientedPoint& HypothesisSampler::draw_surfel(RandomStream& random) const {
    const double mark = random.uniform() * cumulative_weights_.back();
    const auto at = std::upper_bound(cumulative_weights_.begin(), cumulative_weights_.end(), mark);
    const auto index = std::min<std::ptrdiff_t>(at - cumulative_weights_.begin(),
                                                static_cast<std::ptrdiff_t>(cumulative_weights_.size()) - 1);
    return surfels_.surfels[index].surface;
}

// Of several second points that with the fewest matches: it leaves the fewest poses open. None may match.
HypothesisSampler::SecondPoint HypothesisSampler::draw_second(const OrientedPoint& first, RandomStream& random) const {
    const Eigen::Vector2d centre = camera_.project(first.point.cast<double>());
    const double pixels_per_metre = camera_.fx / first.point.z();
    const double max_radius_pixels =
        std::min(pairs_.max_distance_m() * pixels_per_metre,
                 options_.max_radius_image_sides * std::max(camera_.width, camera_.height));
    SecondPoint second;
    for (int k = 0; k < options_.second_points; ++k) {
        const double radius = random.uniform(pairs_.min_distance_m() * pixels_per_metre, max_radius_pixels);
        const double angle = random.uniform(0.0, 2.0 * M_PI), mark = random.uniform();
        const int pixel =
            camera_.pixel_at(centre.x() + radius * std::cos(angle), centre.y() + radius * std::sin(angle));
        const Surfel* candidate = pixel < 0 ? nullptr : surfels_.at(camera_, pixel);
        if (candidate == nullptr || candidate->draw_weight <= 0.0 || candidate->*weight_ <= mark) continue;
        const std::vector<PointPairTable::Pair>& matches = pairs_.matches(first, candidate->surface);
        if (matches.empty() || (second.matches != nullptr && matches.size() >= second.matches->size())) continue;
        second = {&candidate->surface, &matches};
    }
    return second;
}

std::optional<Pose> HypothesisSampler::pose_from_pair(RandomStream& random) const {
    const OrientedPoint& first = draw_surfel(random);
    const SecondPoint second = draw_second(first, random);
    if (second.matches == nullptr) return std::nullopt;
    const PointPairTable::Pair& pair = (*second.matches)[random.below(static_cast<int>(second.matches->size()))];
    const OrientedPoint &model_first = pairs_.points()[pair.first], &model_second = pairs_.points()[pair.second];
    const auto axes_in_camera = axes_of(first, *second.measured, options_.min_sine);
    const auto axes_in_object = axes_of(model_first, model_second, options_.min_sine);
    if (!axes_in_camera || !axes_in_object) return std::nullopt;
    const Eigen::Quaterniond rotation(*axes_in_camera * axes_in_object->transpose());
    return Pose{rotation.normalized(), first.point.cast<double>() - rotation * model_first.point.cast<double>()};
}

// `count` of the points, or all of fewer. Any number of the first ones are spread as all are.
std::vector<OrientedPoint> spread_sample(const std::vector<OrientedPoint>& points, std::size_t count) {
    constexpr std::size_t kStride = 1597;  // prime to most numbers of points, so that none is taken twice
    std::vector<OrientedPoint> sample;
    for (std::size_t k = 0; k < std::min(count, points.size()); ++k)
        sample.push_back(points[k * kStride % points.size()]);
    return sample;
}

}  // namespace

SurfelGrid surfels_of(const Observation& observation, const PointPairTable& pairs, const SearchOptions& options,
                      std::uint64_t seed, std::uint64_t step) {
    return make_surfels(observation, normal_reach(observation, pairs, options.surfels),
                        initial_tolerance_m(observation, pairs, options.pairs), pairs.largest_face_m2(),
                        RandomStream(seed, step, 0, RandomPurpose::kAlternatives), options.surfels);
}

std::vector<Pose> hypotheses_from_pairs(const Observation& observation, const PointPairTable& pairs,
                                        const SurfelGrid& surfels, const SearchOptions& options,
                                        const PairDraws& wanted, std::uint64_t seed, std::uint64_t step) {
    const PairSearchOptions& search = options.pairs;
    const HypothesisSampler unbalanced(&Surfel::draw_weight, observation, pairs, surfels, search);
    const HypothesisSampler balanced(&Surfel::balanced_draw_weight, observation, pairs, surfels, search);
    if (!unbalanced.can_draw()) return {};
    PruningContext context{.surface = pairs.surface(),
                           .surfels = surfels,
                           .camera = observation.camera(),
                           .measured = systematic_sample(surfels, static_cast<std::size_t>(search.measured_points)),
                           .model = {},
                           .tolerance_m = initial_tolerance_m(observation, pairs, search),
                           .diameter_m = pairs.diameter_m(),
                           .num_threads = wanted.num_threads,
                           .options = options.pruning};
    // What is segmented is the part and nothing else: the share of the measured points decides alone.
    if (!observation.segmented())
        context.model = spread_sample(pairs.points(), static_cast<std::size_t>(search.model_points));
    std::vector<PoseHypothesis> hypotheses(static_cast<std::size_t>(wanted.draws));
    parallel_for(wanted.draws, wanted.num_threads, [&](int i) {
        RandomStream random(seed, step, wanted.first_stream + static_cast<std::uint64_t>(i), RandomPurpose::kStart);
        const HypothesisSampler& sampler = i % search.unbalanced_period == 0 ? unbalanced : balanced;
        const std::optional<Pose> pose =
            i % search.single_point_period == 0 ? sampler.pose_from_point(random) : sampler.pose_from_pair(random);
        if (pose) hypotheses[i] = score_coarsely(context, *pose);
    });
    return prune_hypotheses(std::move(hypotheses), context, wanted.count, wanted.share);
}

}  // namespace nearpose
