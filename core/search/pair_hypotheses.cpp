#include "core/search/pair_hypotheses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/parallel.hpp"
#include "core/base/random.hpp"
#include "core/search/hypothesis_pruning.hpp"

namespace nearpose {
namespace {

constexpr int kSecondPoints = 8;

// Right-handed axes of an oriented pair: the first normal, the line between the points made square to it, and the
// third. Nothing where the line runs along the normal.
std::optional<Eigen::Matrix3d> axes_of(const OrientedPoint& first, const OrientedPoint& second) {
    const Eigen::Vector3d normal = first.normal.cast<double>();
    const Eigen::Vector3d line = (second.point - first.point).cast<double>();
    const Eigen::Vector3d across = line - line.dot(normal) * normal;
    constexpr double kMinSine = 0.2;
    if (across.norm() < kMinSine * line.norm()) return std::nullopt;
    Eigen::Matrix3d axes;
    axes.col(0) = normal.normalized();
    axes.col(1) = across.normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
}

constexpr double kToleranceDistances = 0.25;  // of the shortest pair

// Within which model and depth agree, as a start [m].
double start_tolerance_m(const Observation& observation, const PointPairTable& pairs) {
    return kToleranceDistances * pairs.min_distance_m() + 2.0 * observation.sigma_m(observation.mean_distance_m());
}

// A normal needs a length over which the noise is small [pixels].
int normal_reach(const Observation& observation, const PointPairTable& pairs) {
    const double pixels = observation.camera().fx * kToleranceDistances * pairs.min_distance_m() /
                          std::max(1e-3, observation.mean_distance_m());
    return std::clamp(static_cast<int>(pixels), 2, 20);
}

// What all draws share.
struct Draw {
    const Observation& observation;
    const PointPairTable& pairs;
    const SurfelGrid& grid;
    double Surfel::*chance;       // of a surfel: its draw_weight or how balanced_draw_weight it is
    std::vector<double> chances;  // cumulative, of the surfels

    // Farther second points are out of the image.
    double max_radius_pixels(double pixels_per_metre) const {
        const PinholeCamera& camera = observation.camera();
        return std::min(pairs.max_distance_m() * pixels_per_metre, 0.7 * std::max(camera.width, camera.height));
    }
};

Draw draw_by(double Surfel::*chance, const Observation& observation, const PointPairTable& pairs,
             const SurfelGrid& grid) {
    Draw draw{observation, pairs, grid, chance, {}};
    double sum = 0.0;
    for (const Surfel& surfel : grid.surfels)
        draw.chances.push_back(sum += surfel.draw_weight > 0.0 ? surfel.*chance : 0.0);
    return draw;
}

// A measured point, as likely as its chance.
const OrientedPoint& draw_patch(const Draw& draw, RandomStream& random) {
    const double mark = random.uniform() * draw.chances.back();
    const auto at = std::upper_bound(draw.chances.begin(), draw.chances.end(), mark);
    const auto index =
        std::min<std::ptrdiff_t>(at - draw.chances.begin(), static_cast<std::ptrdiff_t>(draw.chances.size()) - 1);
    return draw.grid.surfels[index].surface;
}

// One measured point on any of the model's, normal on normal, turned at random: where all that is seen is one face, it
// takes no pair to find it.
std::optional<Pose> pose_from_point(const Draw& draw, RandomStream& random) {
    const OrientedPoint& measured = draw_patch(draw, random);
    const std::vector<OrientedPoint>& points = draw.pairs.points();
    return pose_aligning(points[random.below(static_cast<int>(points.size()))], measured,
                         random.uniform(0.0, 2.0 * M_PI));
}

std::optional<Pose> pose_from_pair(const Draw& draw, RandomStream& random) {
    const Observation& observation = draw.observation;
    const PinholeCamera& camera = observation.camera();
    const OrientedPoint& first = draw_patch(draw, random);
    const Eigen::Vector2d centre = camera.project(first.point.cast<double>());
    const double pixels_per_metre = camera.fx / first.point.z();
    // Of several second points the one that fewest of the model's pairs are like tells most.
    std::optional<OrientedPoint> second;
    const std::vector<PointPairTable::Pair>* matches = nullptr;
    for (int k = 0; k < kSecondPoints; ++k) {
        const double radius =
            random.uniform(draw.pairs.min_distance_m() * pixels_per_metre, draw.max_radius_pixels(pixels_per_metre));
        const double angle = random.uniform(0.0, 2.0 * M_PI), luck = random.uniform();
        const int pixel = camera.pixel_at(centre.x() + radius * std::cos(angle), centre.y() + radius * std::sin(angle));
        const Surfel* candidate = pixel < 0 ? nullptr : draw.grid.at(camera, pixel);
        if (candidate == nullptr || candidate->draw_weight <= 0.0 || candidate->*draw.chance <= luck) continue;
        const std::vector<PointPairTable::Pair>& pairs = draw.pairs.matches(first, candidate->surface);
        if (pairs.empty() || (matches != nullptr && pairs.size() >= matches->size())) continue;
        second = candidate->surface;
        matches = &pairs;
    }
    if (matches == nullptr) return std::nullopt;
    const PointPairTable::Pair& pair = (*matches)[random.below(static_cast<int>(matches->size()))];
    const OrientedPoint& point_of_model = draw.pairs.points()[pair.first];
    const auto in_camera = axes_of(first, *second),
               in_object = axes_of(point_of_model, draw.pairs.points()[pair.second]);
    if (!in_camera || !in_object) return std::nullopt;
    const Eigen::Quaterniond rotation(*in_camera * in_object->transpose());
    return Pose{rotation.normalized(), first.point.cast<double>() - rotation * point_of_model.point.cast<double>()};
}

// About `count` of the points, the first ones spread as all are.
std::vector<OrientedPoint> some_of(const std::vector<OrientedPoint>& points, std::size_t count) {
    constexpr std::size_t kStep = 1597;  // prime to most numbers of points
    std::vector<OrientedPoint> some;
    for (std::size_t k = 0; k < std::min(count, points.size()); ++k) some.push_back(points[k * kStep % points.size()]);
    return some;
}

}  // namespace

SurfelGrid surfels_of(const Observation& observation, const PointPairTable& pairs, std::uint64_t seed,
                      std::uint64_t step) {
    return make_surfels(observation, normal_reach(observation, pairs), start_tolerance_m(observation, pairs),
                        pairs.largest_face_m2(), RandomStream(seed, step, 0, RandomPurpose::kAlternatives));
}

std::vector<Pose> hypotheses_from_pairs(const Observation& observation, const PointPairTable& pairs,
                                        const SurfelGrid& surfels, const PairSearchOptions& options, std::uint64_t seed,
                                        std::uint64_t step) {
    constexpr std::size_t kMeasured = 256, kModel = 256;  // points
    // A plane that fills the view may be a face of the part or not: half of the draws take it for one.
    const Draw by_draw_weight = draw_by(&Surfel::draw_weight, observation, pairs, surfels);
    const Draw by_balance = draw_by(&Surfel::balanced_draw_weight, observation, pairs, surfels);
    if (by_draw_weight.chances.empty() || !(by_draw_weight.chances.back() > 0.0)) return {};
    PruningScene scene{pairs.surface(),
                       surfels,
                       observation.camera(),
                       balanced_sample(surfels, kMeasured),
                       {},
                       start_tolerance_m(observation, pairs),
                       pairs.diameter_m(),
                       options.num_threads};
    // What is segmented is the part and nothing else: the share tells all.
    if (!observation.segmented()) scene.model = some_of(pairs.points(), kModel);
    std::vector<PoseHypothesis> hypotheses(static_cast<std::size_t>(options.draws));
    parallel_for(options.draws, options.num_threads, [&](int i) {
        RandomStream random(seed, step, options.first_stream + static_cast<std::uint64_t>(i), RandomPurpose::kStart);
        const Draw& draw = i % 2 == 0 ? by_draw_weight : by_balance;
        const std::optional<Pose> pose = i % 4 != 0 ? pose_from_pair(draw, random) : pose_from_point(draw, random);
        if (pose) hypotheses[i] = coarsely_scored(scene, *pose);
    });
    return prune(std::move(hypotheses), scene, options.count);
}

}  // namespace nearpose
