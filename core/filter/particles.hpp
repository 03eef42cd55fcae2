// The particle filter over SE(3): control propagation, diffusion, log-weights, effective sample size, resampling, MAP.
// Free functions over a ParticleSet, in the order of the paper's algorithm.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/pose.hpp"

namespace nearpose {

// Parallel arrays. The negative log-weights are the paper's w, up to an offset: small is good, the MAP is the minimum,
// and they need no normalisation.
struct ParticleSet {
    std::vector<Pose> poses;  // camera_from_object
    std::vector<double> negative_log_weights;

    int size() const { return static_cast<int>(poses.size()); }
};

// Standard deviations of the diffusion N(0, Sigma), about the object's centre, in object axes.
struct Diffusion {
    double sigma_rotation_rad = 0.0;
    double sigma_translation_m = 0.0;
};

// The control: each particle moves with the camera, pose <- now_from_before * pose, where now_from_before maps camera
// coordinates of the frame before to those of this frame.
void propagate(ParticleSet& particles, const Pose& now_from_before);

// theta <- theta * N(0, Sigma), a turn and a shift about `centre_in_object`: about a far origin a turn would throw the
// object aside. Particle i draws from the stream (seed, step, i).
void diffuse(ParticleSet& particles, const Diffusion& diffusion, const Eigen::Vector3d& centre_in_object,
             std::uint64_t seed, std::uint64_t step);

// w <- (w + epsilon) / 2, epsilon the negative log-likelihood of the present observation: a sum in log space whose
// halving keeps it in range and forgets the past at a rate of one half a frame.
void update_weights(ParticleSet& particles, const std::vector<double>& negative_log_likelihoods);

// p_i ~ exp(-w_i), of sum 1; computed about the smallest w, so that nothing under- or overflows. A weight that is not
// finite counts as impossible. Where all are so, the probabilities are equal.
std::vector<double> posterior_probabilities(const std::vector<double>& negative_log_weights);

// 1 / sum(p_i^2) over these probabilities, in 1..N. 0 for an empty set.
double effective_sample_size(const std::vector<double>& negative_log_weights);

// Systematic resampling (one uniform draw, `count` even pointers): particle i is taken count * p_i times, rounded up or
// down. Weights of the copies become equal (0).
ParticleSet systematic_resample(const ParticleSet& particles, int count, std::uint64_t seed, std::uint64_t step);

// KLD sampling (Fox 2003): with so many particles the Kullback-Leibler distance between them and a posterior that fills
// `num_cells` cells stays below `max_error` with 99 % probability. The chi-square quantile is approximated after Wilson
// and Hilferty. 0 for a single cell, which any number of particles describes.
int kld_sample_size(int num_cells, double max_error);

// Index of the smallest negative log-weight, the first of equals; -1 for an empty set.
int map_index(const std::vector<double>& negative_log_weights);

}  // namespace nearpose
