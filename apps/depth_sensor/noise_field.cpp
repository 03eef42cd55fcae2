#include "apps/depth_sensor/noise_field.hpp"

#include <array>
#include <cmath>

namespace nearpose::simulate {
namespace {

// Weights whose squares sum to 1: what they weigh keeps its variance.
std::vector<float> unit_variance_kernel(double sigma_pixels) {
    const int radius = static_cast<int>(std::ceil(3.0 * sigma_pixels));
    std::vector<double> weights;
    double sum_of_squares = 0.0;
    for (int i = -radius; i <= radius; ++i) {
        weights.push_back(radius == 0 ? 1.0 : std::exp(-0.5 * i * i / (sigma_pixels * sigma_pixels)));
        sum_of_squares += weights.back() * weights.back();
    }
    std::vector<float> kernel;
    for (const double weight : weights) kernel.push_back(static_cast<float>(weight / std::sqrt(sum_of_squares)));
    return kernel;
}

// Four B-spline weights for a point at `fraction` of the way between the middle two nodes, squares summing to 1.
std::array<double, 4> spline_weights(double fraction) {
    const double t = fraction, u = 1.0 - t;
    std::array<double, 4> weights{u * u * u, 4.0 - 6.0 * t * t + 3.0 * t * t * t, 4.0 - 6.0 * u * u + 3.0 * u * u * u,
                                  t * t * t};
    double sum_of_squares = 0.0;
    for (const double weight : weights) sum_of_squares += weight * weight;
    for (double& weight : weights) weight /= std::sqrt(sum_of_squares);
    return weights;
}

}  // namespace

std::vector<Eigen::Array4f> correlated_noise(int width, int height, double correlation_pixels, std::uint64_t seed,
                                             std::uint64_t frame, RandomPurpose purpose) {
    const std::vector<float> kernel = unit_variance_kernel(correlation_pixels);
    const int taps = static_cast<int>(kernel.size());
    const int padded_width = width + taps - 1, padded_height = height + taps - 1;
    std::vector<Eigen::Array4f> white(static_cast<std::size_t>(padded_width));
    std::vector<Eigen::Array4f> rows(static_cast<std::size_t>(padded_height) * width);
    for (int v = 0; v < padded_height; ++v) {
        for (int u = 0; u < padded_width; ++u) {
            RandomStream random(seed, frame, static_cast<std::uint64_t>(v) * padded_width + u, purpose);
            for (int channel = 0; channel < 4; ++channel) white[u][channel] = static_cast<float>(random.gaussian());
        }
        for (int u = 0; u < width; ++u) {
            Eigen::Array4f sum = Eigen::Array4f::Zero();
            for (int k = 0; k < taps; ++k) sum += kernel[k] * white[u + k];
            rows[static_cast<std::size_t>(v) * width + u] = sum;
        }
    }
    std::vector<Eigen::Array4f> noise(static_cast<std::size_t>(height) * width, Eigen::Array4f::Zero());
    for (int v = 0; v < height; ++v) {
        for (int k = 0; k < taps; ++k) {
            const Eigen::Array4f* row = &rows[static_cast<std::size_t>(v + k) * width];
            for (int u = 0; u < width; ++u) noise[static_cast<std::size_t>(v) * width + u] += kernel[k] * row[u];
        }
    }
    return noise;
}

std::vector<float> smooth_field(int width, int height, double length_pixels, std::uint64_t seed, std::uint64_t frame,
                                RandomPurpose purpose) {
    const int columns = static_cast<int>(width / length_pixels) + 4;
    const int rows = static_cast<int>(height / length_pixels) + 4;
    std::vector<double> nodes;
    for (int i = 0; i < rows * columns; ++i) {
        nodes.push_back(RandomStream(seed, frame, static_cast<std::uint64_t>(i), purpose).gaussian());
    }
    const auto node_before = [&](int pixel) { return static_cast<int>(pixel / length_pixels); };
    const auto weights_at = [&](int pixel) { return spline_weights(pixel / length_pixels - node_before(pixel)); };
    std::vector<std::array<double, 4>> weights_u;
    for (int u = 0; u < width; ++u) weights_u.push_back(weights_at(u));

    std::vector<float> field;
    field.reserve(static_cast<std::size_t>(width) * height);
    std::vector<double> blended(static_cast<std::size_t>(columns));  // the nodes' columns at the height of row v
    for (int v = 0; v < height; ++v) {
        const std::array<double, 4> weights_v = weights_at(v);
        for (int column = 0; column < columns; ++column) {
            blended[column] = 0.0;
            for (int j = 0; j < 4; ++j)
                blended[column] += weights_v[j] * nodes[(node_before(v) + j) * columns + column];
        }
        for (int u = 0; u < width; ++u) {
            double sum = 0.0;
            for (int i = 0; i < 4; ++i) sum += weights_u[u][i] * blended[node_before(u) + i];
            field.push_back(static_cast<float>(sum));
        }
    }
    return field;
}

}  // namespace nearpose::simulate
