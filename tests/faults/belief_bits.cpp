#include "tests/faults/belief_bits.hpp"

namespace nearpose::test {
namespace {

using Numbers = std::vector<double>;

template <typename Derived>
void add(Numbers& numbers, const Eigen::DenseBase<Derived>& matrix) {
    for (int column = 0; column < matrix.cols(); ++column)
        for (int row = 0; row < matrix.rows(); ++row) numbers.push_back(matrix(row, column));
}

void add(Numbers& numbers, const Pose& pose) {
    const auto& [rotation, translation] = pose;
    add(numbers, rotation.coeffs());
    add(numbers, translation);
}

void add(Numbers& numbers, const Mode& mode) {
    const auto& [pose, cost, support, log_evidence, log_prior, weight, covariance] = mode;
    add(numbers, pose);
    numbers.insert(numbers.end(), {cost, support, log_evidence, log_prior, weight});
    add(numbers, covariance);
}

void add(Numbers& numbers, const Alternative& alternative) {
    const auto& [pose, log_odds] = alternative;
    add(numbers, pose);
    numbers.push_back(log_odds);
}

void add(Numbers& numbers, const Track& track) {
    const auto& [pose, covariance, object_motion, constant_covariance] = track;
    const auto& [rotation_rad, translation_m] = object_motion;
    add(numbers, pose);
    add(numbers, covariance);
    numbers.insert(numbers.end(), {rotation_rad, translation_m});
    add(numbers, constant_covariance);
}

void add(Numbers& numbers, const Sighting& sighting) {
    const auto& [arm, pose, covariance, setup_effect, camera_motion, other_mode, moved] = sighting;
    add(numbers, arm);
    add(numbers, pose);
    add(numbers, covariance);
    add(numbers, setup_effect);
    add(numbers, camera_motion);
    numbers.insert(numbers.end(), {other_mode ? 1.0 : 0.0, moved ? 1.0 : 0.0});
}

void add(Numbers& numbers, int number) {
    numbers.push_back(number);
}

template <typename Value>
void add(Numbers& numbers, const std::optional<Value>& value) {
    numbers.push_back(value ? 1.0 : 0.0);
    if (value) add(numbers, *value);
}

template <typename Value>
void add(Numbers& numbers, const std::vector<Value>& values) {
    numbers.push_back(static_cast<double>(values.size()));
    for (const Value& value : values) add(numbers, value);
}

void add(Numbers& numbers, const Sightings& sightings) {
    const auto& [kept, arm, camera_motion, frames_since_move] = sightings;
    add(numbers, kept);
    add(numbers, arm);
    add(numbers, camera_motion);
    add(numbers, frames_since_move);
}

void add(Numbers& numbers, const ImageMemory& image) {
    const auto& [sample, repeats, now_from_sample] = image;
    const auto& [width, height, depth_m] = sample;
    numbers.insert(numbers.end(), {static_cast<double>(width), static_cast<double>(height)});
    numbers.insert(numbers.end(), depth_m.begin(), depth_m.end());
    numbers.push_back(repeats);
    add(numbers, now_from_sample);
}

void add(Numbers& numbers, const Lock& lock) {
    const auto& [phase, verified, low_agreement, tried, weight, unreplaced, contradicted, low, evidence, log_odds] =
        lock;
    numbers.insert(numbers.end(), {static_cast<double>(phase), verified ? 1.0 : 0.0, low_agreement ? 1.0 : 0.0,
                                   static_cast<double>(tried), weight, static_cast<double>(unreplaced),
                                   static_cast<double>(contradicted), static_cast<double>(low), evidence, log_odds});
}

}  // namespace

std::vector<double> bits_of(const Belief& belief) {
    const auto& [particles, tracked, alternatives, track, before_loss, sightings, image, lock, step] = belief;
    const auto& [poses, weights] = particles;
    Numbers numbers;
    add(numbers, poses);
    numbers.insert(numbers.end(), weights.begin(), weights.end());
    add(numbers, tracked);
    add(numbers, alternatives);
    add(numbers, track);
    add(numbers, before_loss);
    add(numbers, sightings);
    add(numbers, image);
    add(numbers, lock);
    numbers.push_back(static_cast<double>(step));
    return numbers;
}

std::vector<double> bits_of(const UpdateResult& result) {
    Numbers numbers = {static_cast<double>(result.status),
                       static_cast<double>(result.verdict),
                       result.cost,
                       result.score,
                       result.pixels.agreement(),
                       result.positive_evidence.total(),
                       result.log_odds_present,
                       result.effective_sample_size,
                       static_cast<double>(result.points_observed),
                       static_cast<double>(result.missing.size())};
    add(numbers, result.camera_from_object);
    add(numbers, result.covariance);
    add(numbers, result.modes);
    for (const Shortfall& shortfall : result.missing)
        numbers.insert(numbers.end(), {static_cast<double>(shortfall.requirement), shortfall.value, shortfall.limit});
    return numbers;
}

}  // namespace nearpose::test
