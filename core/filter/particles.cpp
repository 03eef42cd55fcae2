#include "core/filter/particles.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/random.hpp"

namespace nearpose {
void propagate(ParticleSet& particles, const Pose& now_from_before) {
    for (Pose& pose : particles.poses) pose = now_from_before * pose;
}

void diffuse(ParticleSet& particles, const Diffusion& diffusion, const Eigen::Vector3d& centre_in_object,
             std::uint64_t seed, std::uint64_t step) {
    for (int i = 0; i < particles.size(); ++i) {
        RandomStream random(seed, step, static_cast<std::uint64_t>(i), RandomPurpose::kDiffusion);
        Twist noise;
        for (int axis = 0; axis < 3; ++axis) noise[axis] = diffusion.sigma_rotation_rad * random.gaussian();
        for (int axis = 3; axis < 6; ++axis) noise[axis] = diffusion.sigma_translation_m * random.gaussian();
        particles.poses[i] = perturb_about(particles.poses[i], noise, centre_in_object);
    }
}

void update_weights(ParticleSet& particles, const std::vector<double>& negative_log_likelihoods) {
    assert(negative_log_likelihoods.size() == particles.negative_log_weights.size());
    for (std::size_t i = 0; i < particles.negative_log_weights.size(); ++i)
        particles.negative_log_weights[i] = 0.5 * (particles.negative_log_weights[i] + negative_log_likelihoods[i]);
}

std::vector<double> posterior_probabilities(const std::vector<double>& negative_log_weights) {
    const int best = map_index(negative_log_weights);
    std::vector<double> p(negative_log_weights.size(), 0.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (std::isfinite(negative_log_weights[i]))
            p[i] = std::exp(negative_log_weights[best] - negative_log_weights[i]);
        sum += p[i];
    }
    for (double& value : p) value = sum > 0.0 ? value / sum : 1.0 / static_cast<double>(p.size());
    return p;
}

double effective_sample_size(const std::vector<double>& negative_log_weights) {
    double sum_of_squares = 0.0;
    for (const double p : posterior_probabilities(negative_log_weights)) sum_of_squares += p * p;
    return sum_of_squares > 0.0 ? 1.0 / sum_of_squares : 0.0;
}

ParticleSet systematic_resample(const ParticleSet& particles, int count, std::uint64_t seed, std::uint64_t step) {
    const int size = particles.size();
    if (size == 0) return particles;
    const std::vector<double> p = posterior_probabilities(particles.negative_log_weights);
    const double offset = RandomStream(seed, step, 0, RandomPurpose::kResampling).uniform();
    ParticleSet resampled;
    resampled.poses.reserve(count);
    resampled.negative_log_weights.assign(count, 0.0);
    int last_possible = size - 1;  // rounding of the sum may let the last pointer run past it
    while (last_possible > 0 && p[last_possible] == 0.0) --last_possible;
    double cumulative = p[0];
    int source = 0;
    for (int k = 0; k < count; ++k) {
        const double pointer = (k + offset) / count;
        while (pointer >= cumulative && source < last_possible) cumulative += p[++source];
        resampled.poses.push_back(particles.poses[source]);
    }
    return resampled;
}

int kld_sample_size(int num_cells, double max_error) {
    constexpr double kQuantile = 2.326;  // of the normal distribution, 99 %
    const double k = num_cells - 1;
    if (k < 1.0) return 0;
    const double root = 1.0 - 2.0 / (9.0 * k) + std::sqrt(2.0 / (9.0 * k)) * kQuantile;
    return static_cast<int>(std::ceil(k / (2.0 * max_error) * root * root * root));
}

int map_index(const std::vector<double>& negative_log_weights) {
    int best = -1;
    for (std::size_t i = 0; i < negative_log_weights.size(); ++i)
        if (!std::isnan(negative_log_weights[i]) && (best < 0 || negative_log_weights[i] < negative_log_weights[best]))
            best = static_cast<int>(i);
    return best < 0 && !negative_log_weights.empty() ? 0 : best;
}

}  // namespace nearpose
