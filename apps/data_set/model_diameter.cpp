#include "apps/data_set/model_diameter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace nearpose::data_set {
namespace {

using Points = std::vector<Eigen::Vector3f>;

struct Pair {
    std::size_t a = 0, b = 0;
    float squared = 0.0F;  // distance squared
};

Pair farthest_pair(const Points& points, const std::vector<std::size_t>& among) {
    Pair best;
    for (std::size_t i = 0; i < among.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const float squared = (points[among[i]] - points[among[j]]).squaredNorm();
            if (squared > best.squared) best = {among[i], among[j], squared};
        }
    }
    return best;
}

// The points that lie farthest out in evenly spread directions, each once.
std::vector<std::size_t> extreme_points(const Points& points) {
    constexpr int kDirections = 512;  // over a half sphere: both ends of each are taken
    const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
    std::vector<std::size_t> extremes;
    for (int k = 0; k < kDirections; ++k) {
        const double z = (k + 0.5) / kDirections;
        const double radius = std::sqrt(1.0 - z * z);
        const Eigen::Vector3f direction =
            Eigen::Vector3d(radius * std::cos(golden_angle * k), radius * std::sin(golden_angle * k), z).cast<float>();
        std::size_t low = 0;
        std::size_t high = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const float along = points[i].dot(direction);
            if (along < points[low].dot(direction)) low = i;
            if (along > points[high].dot(direction)) high = i;
        }
        extremes.push_back(low);
        extremes.push_back(high);
    }
    std::sort(extremes.begin(), extremes.end());
    extremes.erase(std::unique(extremes.begin(), extremes.end()), extremes.end());
    return extremes;
}

// Walks from one end to the point farthest from it, and from there on, until the distance grows no more.
Pair grown(const Points& points, Pair pair) {
    for (int walks_without_gain = 0; walks_without_gain < 2; std::swap(pair.a, pair.b)) {
        ++walks_without_gain;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const float squared = (points[i] - points[pair.a]).squaredNorm();
            if (squared <= pair.squared) continue;
            pair = {pair.a, i, squared};
            walks_without_gain = 0;
        }
    }
    return pair;
}

}  // namespace

double diameter_of(const std::vector<Eigen::Vector3f>& points) {
    constexpr std::size_t kExact = 10'000;  // all pairs of these take a tenth of a second
    if (points.size() < 2) return 0.0;
    std::vector<std::size_t> among(points.size());
    for (std::size_t i = 0; i < among.size(); ++i) among[i] = i;
    const bool exact = points.size() <= kExact;
    Pair pair = farthest_pair(points, exact ? among : extreme_points(points));
    if (!exact) pair = grown(points, pair);
    return (points[pair.a].cast<double>() - points[pair.b].cast<double>()).norm();
}

}  // namespace nearpose::data_set
