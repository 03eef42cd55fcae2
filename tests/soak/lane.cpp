#include "tests/soak/lane.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "apps/base/thread_time.hpp"
#include "apps/runs/estimator_setup.hpp"

namespace nearpose::soak {
namespace {

constexpr int kUsualWidth = 320;
constexpr double kGross = 2.0;  // tolerances; an accepted pose is never so far off, whatever its 90 % region says

EstimatorOptions options_of(std::uint64_t seed, int threads) {
    EstimatorOptions options;
    options.seed = seed;
    options.num_threads = threads;
    return options;
}

bool is_finite(const Pose& pose) {
    return pose.rotation.coeffs().allFinite() && pose.translation.allFinite();
}

bool is_finite(const UpdateResult& result) {
    bool finite = is_finite(result.camera_from_object) && result.covariance.allFinite();
    for (const double number : {result.cost, result.score, result.pixels.agreement(), result.positive_evidence.total(),
                                result.log_odds_present, result.effective_sample_size})
        finite = finite && std::isfinite(number);
    for (const Mode& mode : result.modes)
        finite = finite && is_finite(mode.camera_from_object) && mode.covariance.allFinite() &&
                 std::isfinite(mode.cost) && std::isfinite(mode.weight);
    for (const Shortfall& shortfall : result.missing)
        finite = finite && std::isfinite(shortfall.value) && std::isfinite(shortfall.limit);
    return finite;
}

bool is_covariance(const Matrix6d& covariance) {
    constexpr double kRounding = 1e-9;
    const double size = covariance.cwiseAbs().maxCoeff();
    if (!((covariance - covariance.transpose()).cwiseAbs().maxCoeff() <= kRounding * size)) return false;
    // Rotations and translations differ in size: positive definite once each axis has the variance 1.
    const Twist sigma = covariance.diagonal().cwiseSqrt();
    if (!(sigma.minCoeff() > 0.0)) return false;
    const Matrix6d correlation = sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal();
    return Eigen::SelfAdjointEigenSolver<Matrix6d>(correlation, Eigen::EigenvaluesOnly).eigenvalues()(0) > 0.0;
}

// Whether an accepted pose is off by at most so many tolerances.
bool is_within(double tolerances, const UpdateResult& result, const Frame& frame,
               const Eigen::Vector3d& centre_in_object) {
    const Tolerance tolerance;
    const Pose &pose = result.camera_from_object, &truth = frame.camera_from_object;
    return frame.shows_part &&
           (pose * centre_in_object - truth * centre_in_object).norm() <= tolerances * tolerance.translation_m &&
           angle_between(pose.rotation, truth.rotation) <= tolerances * tolerance.rotation_rad;
}

// Of an accepted pose that is wrong: by how much, where, and how sure it is.
std::string error_of(const UpdateResult& result, const Frame& frame, const Eigen::Vector3d& centre_in_object) {
    constexpr double kDegrees = 57.29577951308232;
    const Pose &pose = result.camera_from_object, &truth = frame.camera_from_object;
    if (!frame.shows_part) return "which does not show the part";
    const auto text = [](double number) { return std::to_string(number); };
    return text(1e3 * (pose * centre_in_object - truth * centre_in_object).norm()) + " mm and " +
           text(kDegrees * angle_between(pose.rotation, truth.rotation)) + " deg off at " +
           text((truth * centre_in_object).z()) + " m, " + std::to_string(frame.camera.width) +
           " pixels wide; sigma of the worst rotation " +
           text(kDegrees * std::sqrt(result.covariance.topLeftCorner<3, 3>().diagonal().maxCoeff())) + " deg";
}

}  // namespace

Lane::Lane(const Recordings& recordings, std::uint64_t seed, int threads)
    : recordings_(recordings),
      estimator_(recordings.views, program::make_solver({}), options_of(seed, threads)),
      random_(seed) {
    counts_.tracked_cpu_s.reserve(1 << 18);  // no growth of its own
    begin_piece();
}

// Most pieces begin with an estimator that knows nothing; in the others the part was exchanged under its eyes.
void Lane::begin_piece() {
    constexpr int kShortest = 6;
    piece_.recording = draw(static_cast<int>(recordings_.frames.size()));
    const int frames = static_cast<int>(recordings_.frames[piece_.recording].size());
    piece_.next = draw(frames - kShortest);
    piece_.end = piece_.next + kShortest + draw(frames - kShortest - piece_.next + 1);
    piece_.with_mask = chance(60);
    const bool knows_nothing = chance(70);
    if (knows_nothing) estimator_.reset();
    history_ += knows_nothing ? "; reset" : "; exchanged";
    camera_from_world_before_.reset();
}

void Lane::keep_or_put_back() {
    if (chance(5) && camera_from_world_before_)
        kept_ = {estimator_.belief(), *camera_from_world_before_, piece_.recording};
    if (!chance(3) || !kept_) return;
    estimator_.restore(kept_->belief);
    camera_from_world_before_.reset();
    if (kept_->recording == piece_.recording) camera_from_world_before_ = kept_->camera_from_world;
    ++counts_.fed["put back"];
    history_ += "; put back";
}

// Measured, missing, not finite, no rotation, or one that no arm makes.
std::optional<Pose> Lane::motion_to(const Pose& camera_from_world) {
    const std::optional<Pose> before = camera_from_world_before_;
    camera_from_world_before_ = camera_from_world;
    if (!before || chance(5)) return std::nullopt;
    Pose motion = camera_from_world * before->inverse();
    if (!chance(4)) return motion;
    switch (draw(4)) {
        case 0:
            motion.translation.x() = std::numeric_limits<double>::quiet_NaN();
            break;
        case 1:
            motion.rotation.coeffs().setZero();
            break;
        case 2:
            motion.translation = Eigen::Vector3d(1e5, -3e4, 1e300);
            break;
        default:
            motion = motion * exp((Twist() << 1.0, -0.5, 2.0, 0.3, 0.2, -0.4).finished());
    }
    ++counts_.fed["absurd motion"];
    history_ += "; absurdly";
    return motion;
}

void Lane::feed() {
    keep_or_put_back();
    if (chance(1)) estimator_.reset();
    if (chance(12)) return feed_nonsense();
    feed_piece();
}

void Lane::feed_piece() {
    if (piece_.next >= piece_.end) begin_piece();
    const Frame& frame = recordings_.frames[piece_.recording][piece_.next];
    if (!chance(3)) ++piece_.next;  // else the same image comes again
    std::optional<Mask> mask;
    if (piece_.with_mask) mask = frame.mask;
    std::string kind = piece_.with_mask ? "with mask" : "without mask";
    if (mask && chance(4)) {
        const int change = draw(3);
        for (std::uint8_t& value : mask->value) value = change == 0 ? 0 : change == 1 ? 255 : (value == 0 ? 255 : 0);
        kind = "wrong mask";
    }
    update(frame, mask, motion_to(frame.camera_from_world), kind);
}

// The camera stands still meanwhile.
void Lane::feed_nonsense() {
    const Frame& frame = recordings_.without_part[draw(static_cast<int>(recordings_.without_part.size()))];
    std::optional<Mask> mask;
    if (chance(50)) {
        mask.emplace(
            Mask{frame.depth.width, frame.depth.height, std::vector<std::uint8_t>(frame.depth.depth_m.size())});
        for (std::uint8_t& value : mask->value) value = static_cast<std::uint8_t>(random_() % 3);
    }
    const bool still = chance(50);
    if (!still) camera_from_world_before_.reset();
    update(frame, mask, still ? std::optional(Pose::identity()) : std::nullopt, "nonsense");
}

void Lane::update(const Frame& frame, const std::optional<Mask>& mask, const std::optional<Pose>& now_from_before,
                  const std::string& kind) {
    constexpr std::size_t kHistory = 160;
    ++counts_.fed[kind];
    history_ += (now_from_before ? "; moved, " : "; ") + kind;
    if (history_.size() > kHistory) history_.erase(0, history_.size() - kHistory);
    const double begin_s = thread_cpu_s();
    try {
        const Observation observation = make_observation(frame.depth, frame.camera, mask);
        const UpdateResult result = estimator_.update(observation, now_from_before);
        const bool tracks = estimator_.belief().lock.phase == Phase::kTracking && kind != "nonsense";
        if (tracks && frame.camera.width == kUsualWidth && result.status == UpdateStatus::kEstimated)
            counts_.tracked_cpu_s.push_back(thread_cpu_s() - begin_s);
        check(result, frame, kind);
    } catch (const std::exception& error) {
        breach("an exception", kind + ": " + error.what());
    }
}

void Lane::check(const UpdateResult& result, const Frame& frame, const std::string& kind) {
    if (!is_finite(result)) breach("a number that is not finite", kind);
    const bool accepted = result.verdict == Verdict::kAccept;
    if (result.status == UpdateStatus::kNoPose) {
        if (accepted) breach("accepted without a pose", kind);
        return;
    }
    if (result.status == UpdateStatus::kEstimated) ++counts_.estimated;
    if (std::abs(result.camera_from_object.rotation.norm() - 1.0) > 1e-9) breach("a rotation that is none", kind);
    if (!is_covariance(result.covariance)) breach("a covariance that is none", kind + ", " + to_string(result.status));
    if (!accepted) return;
    ++counts_.accepted;
    const Eigen::Vector3d centre = recordings_.views->extent().centre_in_object();
    if (is_within(1.0, result, frame, centre)) return;
    const std::string error = kind + ", " + error_of(result, frame, centre);
    if (!is_within(kGross, result, frame, centre)) return breach("accepted falsely", error);
    counts_.beyond_tolerance.push_back(error);
}

void Lane::breach(const std::string& what, const std::string& detail) {
    constexpr std::size_t kKept = 20;
    ++counts_.breaches[what];
    if (counts_.first_breaches.size() < kKept)
        counts_.first_breaches.push_back(what + ": " + detail + "; before it" + history_);
}

}  // namespace nearpose::soak
