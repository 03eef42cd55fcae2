#include "core/start_pairs.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "core/parallel.hpp"
#include "core/random.hpp"

namespace nearpose {
namespace {

constexpr int kDistanceCells = 10, kAngleCells = 9;  // 20 degrees
constexpr int kSecondPoints = 8;
constexpr int kMaxPairAnchors = 500;  // their pairs are a quarter of a million

int angle_cell(double cosine) {
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    return std::min(kAngleCells - 1, static_cast<int>(angle / M_PI * kAngleCells));
}

// Right-handed axes of an oriented pair: the first normal, the line between the points made square to it, and the
// third. Nothing where the line runs along the normal.
std::optional<Eigen::Matrix3d> axes_of(const SurfaceAnchor& first, const SurfaceAnchor& second) {
    const Eigen::Vector3d normal = first.normal_in_object.cast<double>();
    const Eigen::Vector3d line = (second.point_in_object - first.point_in_object).cast<double>();
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
double start_tolerance_m(const Observation& observation, const AnchorPairs& pairs) {
    return kToleranceDistances * pairs.min_distance_m() + 2.0 * observation.sigma_m(observation.mean_distance_m());
}

// A normal needs a length over which the noise is small [pixels].
int normal_reach(const Observation& observation, const AnchorPairs& pairs) {
    const double pixels = observation.camera().fx * kToleranceDistances * pairs.min_distance_m() /
                          std::max(1e-3, observation.mean_distance_m());
    return std::clamp(static_cast<int>(pixels), 2, 20);
}

// What all draws share.
struct Draw {
    const Observation& observation;
    const AnchorPairs& pairs;
    const PatchGrid& grid;
    std::vector<double> chances;  // cumulative, of the patches
    double tolerance_m = 0.0;     // within which model and depth agree

    // Farther second points are out of the image.
    double max_radius_pixels(double pixels_per_metre) const {
        const PinholeCamera& camera = observation.camera();
        return std::min(pairs.max_distance_m() * pixels_per_metre, 0.7 * std::max(camera.width, camera.height));
    }
};

struct Guess {
    Pose camera_from_object;
    double score = -1.0;  // see score_of; below every score where there is no pose
};

// A measured point, as likely as it is rare.
const SurfaceAnchor& draw_patch(const Draw& draw, RandomStream& random) {
    const double mark = random.uniform() * draw.chances.back();
    const auto at = std::upper_bound(draw.chances.begin(), draw.chances.end(), mark);
    const auto index =
        std::min<std::ptrdiff_t>(at - draw.chances.begin(), static_cast<std::ptrdiff_t>(draw.chances.size()) - 1);
    return draw.grid.patches[index].surface;
}

// One measured point on any of the model's, normal on normal, turned at random: where all that is seen is one face, it
// takes no pair to find it.
std::optional<Pose> pose_from_point(const Draw& draw, RandomStream& random) {
    const SurfaceAnchor& measured = draw_patch(draw, random);
    const std::vector<SurfaceAnchor>& anchors = draw.pairs.anchors();
    return laid_on(anchors[random.below(static_cast<int>(anchors.size()))], measured, random.uniform(0.0, 2.0 * M_PI));
}

std::optional<Pose> pose_from_pair(const Draw& draw, RandomStream& random) {
    const Observation& observation = draw.observation;
    const PinholeCamera& camera = observation.camera();
    const SurfaceAnchor& first = draw_patch(draw, random);
    const Eigen::Vector2d centre = camera.project(first.point_in_object.cast<double>());
    const double pixels_per_metre = camera.fx / first.point_in_object.z();
    // Of several second points the one that fewest of the model's pairs are like tells most.
    std::optional<SurfaceAnchor> second;
    const std::vector<AnchorPairs::Pair>* alike = nullptr;
    for (int k = 0; k < kSecondPoints; ++k) {
        const double radius =
            random.uniform(draw.pairs.min_distance_m() * pixels_per_metre, draw.max_radius_pixels(pixels_per_metre));
        const double angle = random.uniform(0.0, 2.0 * M_PI), luck = random.uniform();
        const int pixel = camera.pixel_at(centre.x() + radius * std::cos(angle), centre.y() + radius * std::sin(angle));
        const Patch* candidate = pixel < 0 ? nullptr : draw.grid.at(camera, pixel);
        if (candidate == nullptr || candidate->rarity <= luck) continue;
        const std::vector<AnchorPairs::Pair>& pairs = draw.pairs.alike(first, candidate->surface);
        if (pairs.empty() || (alike != nullptr && pairs.size() >= alike->size())) continue;
        second = candidate->surface;
        alike = &pairs;
    }
    if (alike == nullptr) return std::nullopt;
    const AnchorPairs::Pair& pair = (*alike)[random.below(static_cast<int>(alike->size()))];
    const SurfaceAnchor& anchor = draw.pairs.anchors()[pair.first];
    const auto in_camera = axes_of(first, *second), in_object = axes_of(anchor, draw.pairs.anchors()[pair.second]);
    if (!in_camera || !in_object) return std::nullopt;
    const Eigen::Quaterniond rotation(*in_camera * in_object->transpose());
    return Pose{rotation.normalized(),
                first.point_in_object.cast<double>() - rotation * anchor.point_in_object.cast<double>()};
}

// Looks at a few points of the model that are seen from about there. What lies behind the measured surface may be
// hidden by something else, what lies in front of it cannot be.
double score_of(const Pose& pose, const Draw& draw) {
    constexpr double kBehindFar = 0.7, kBehindNear = 0.2;  // near, other points are seen than from afar
    constexpr double kShrink = 16.0;                       // points: few that agree say little
    constexpr int kLeastSeen = 8, kEnoughSeen = 64;
    const Observation& observation = draw.observation;
    const PinholeCamera& camera = observation.camera();
    const Eigen::Matrix3f rotation = pose.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = pose.translation.cast<float>();
    const auto tolerance_m = static_cast<float>(draw.tolerance_m);
    int seen = 0, in_front = 0, behind = 0;
    double agreeing = 0.0;
    const Eigen::Vector3f camera_in_object = rotation.transpose() * -translation;
    const bool near = (camera_in_object - draw.pairs.centre_in_object()).norm() < draw.pairs.diameter_m();
    for (const Eigen::Vector3f& in_object : draw.pairs.seen_from(camera_in_object)) {
        const Eigen::Vector3f point = rotation * in_object + translation;
        if (!(point.z() > 0.0F)) continue;
        const Eigen::Vector2d uv = camera.project(point.cast<double>());
        const int pixel = camera.pixel_at(uv.x(), uv.y());
        if (pixel < 0 || observation.states()[pixel] == PixelState::kNoDepth) continue;
        const float off_m = observation.depth_m()[pixel] - point.z();
        const bool on_object = observation.states()[pixel] == PixelState::kCandidate;
        if (++seen > kEnoughSeen) break;
        const Patch* patch = draw.grid.at(camera, pixel);
        if (on_object && std::abs(off_m) < tolerance_m)
            agreeing += patch == nullptr ? 0.0 : near ? patch->telling : patch->weight;
        in_front += off_m >= tolerance_m;
        behind += off_m <= -tolerance_m && on_object;
    }
    return seen < kLeastSeen ? -1.0
                             : (agreeing - in_front - (near ? kBehindNear : kBehindFar) * behind) / (seen + kShrink);
}

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

// What is seen of the model from all around, a few points from each direction.
std::vector<AnchorPairs::Screen> find_screens(const ViewGenerator& views) {
    constexpr int kDirections = 128, kSide = 32;
    constexpr std::size_t kPoints = 256;  // close up most of them lie beyond the image's border
    constexpr std::size_t kStep = 37;     // prime to their number: the first few are spread over the view
    std::vector<AnchorPairs::Screen> screens;
    for (const Eigen::Vector3d& direction : directions_all_around(kDirections)) {
        const View view = view_from(views, direction, kSide);
        AnchorPairs::Screen screen{direction.cast<float>(), {}};
        for (std::size_t k = 0; k < kPoints && view.size() > 0; ++k)
            screen.points_in_object.push_back(view.points_in_object[k * kStep % kPoints * view.size() / kPoints]);
        screens.push_back(screen);
    }
    return screens;
}

}  // namespace

AnchorPairs::AnchorPairs(const ViewGenerator& views)
    : anchors_(find_anchors(views)),
      screens_(find_screens(views)),
      diameter_m_(views.extent().diameter_m()),
      cells_(static_cast<std::size_t>(kDistanceCells) * kAngleCells * kAngleCells * kAngleCells) {
    centre_in_object_ = views.extent().centre_in_object().cast<float>();
    const int count = static_cast<int>(anchors_.size());
    const int every = std::max(1, count / kMaxPairAnchors);
    for (int i = 0; i < count; i += every) {
        for (int j = 0; j < count; j += every) {
            const int cell = i == j ? -1 : cell_of(anchors_[i], anchors_[j]);
            if (cell >= 0) cells_[cell].push_back({i, j});
        }
    }
    largest_face_m2_ = largest_face(anchors_, 0.02 * diameter_m_);
}

const std::vector<Eigen::Vector3f>& AnchorPairs::seen_from(const Eigen::Vector3f& camera_in_object) const {
    const Eigen::Vector3f direction = camera_in_object - centre_in_object_;
    std::size_t best = 0;
    for (std::size_t k = 1; k < screens_.size(); ++k) {
        if (screens_[k].direction.dot(direction) > screens_[best].direction.dot(direction)) best = k;
    }
    return screens_[best].points_in_object;
}

int AnchorPairs::cell_of(const SurfaceAnchor& first, const SurfaceAnchor& second) const {
    const Eigen::Vector3f line = second.point_in_object - first.point_in_object;
    const double distance = line.norm();
    const double place = (distance / diameter_m_ - kMinDistance) / (kMaxDistance - kMinDistance);
    if (!(place >= 0.0 && place < 1.0)) return -1;
    const Eigen::Vector3f direction = line / static_cast<float>(distance);
    const int angles = (angle_cell(first.normal_in_object.dot(direction)) * kAngleCells +
                        angle_cell(second.normal_in_object.dot(direction))) *
                           kAngleCells +
                       angle_cell(first.normal_in_object.dot(second.normal_in_object));
    return static_cast<int>(place * kDistanceCells) * kAngleCells * kAngleCells * kAngleCells + angles;
}

const std::vector<AnchorPairs::Pair>& AnchorPairs::alike(const SurfaceAnchor& first,
                                                         const SurfaceAnchor& second) const {
    static const std::vector<Pair> kNone;
    const int cell = cell_of(first, second);
    return cell < 0 ? kNone : cells_[cell];
}

PatchGrid patches_of(const Observation& observation, const AnchorPairs& pairs, std::uint64_t seed, std::uint64_t step) {
    return make_patches(observation, normal_reach(observation, pairs), start_tolerance_m(observation, pairs),
                        pairs.largest_face_m2(), RandomStream(seed, step, 0, RandomPurpose::kRivals));
}

std::vector<Pose> start_on_pairs(const Observation& observation, const AnchorPairs& pairs, const PatchGrid& patches,
                                 const PairStartOptions& options, std::uint64_t seed, std::uint64_t step) {
    const double diameter_m = pairs.diameter_m();
    Draw draw{observation, pairs, patches, {}, start_tolerance_m(observation, pairs)};
    double sum = 0.0;
    for (const Patch& patch : draw.grid.patches) draw.chances.push_back(sum += patch.rarity);
    if (!(sum > 0.0)) return {};
    std::vector<Guess> guesses(static_cast<std::size_t>(options.draws));
    parallel_for(options.draws, options.num_threads, [&](int i) {
        RandomStream random(seed, step, options.first_stream + static_cast<std::uint64_t>(i), RandomPurpose::kStart);
        const std::optional<Pose> pose = i % 4 != 0 ? pose_from_pair(draw, random) : pose_from_point(draw, random);
        if (pose) guesses[i] = {*pose, score_of(*pose, draw)};
    });
    std::vector<int> order(guesses.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return guesses[a].score > guesses[b].score; });
    const Eigen::Vector3d centre = pairs.anchors().front().point_in_object.cast<double>();
    constexpr double kWorst = -0.7;
    std::map<std::array<int, 6>, int> taken;
    std::vector<Pose> poses;
    for (const int index : order) {
        if (static_cast<int>(poses.size()) >= options.count || guesses[index].score <= kWorst) break;
        if (taken[cell_of_pose(guesses[index].camera_from_object, diameter_m, centre)]++ > 0) continue;
        poses.push_back(guesses[index].camera_from_object);
    }
    return poses;
}

}  // namespace nearpose
