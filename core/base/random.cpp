#include "core/base/random.hpp"

#include <cmath>

namespace nearpose {
namespace {

std::uint64_t mix(std::uint64_t x) {
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9ULL;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t step, std::uint64_t particle, RandomPurpose purpose)
    : state_(mix(seed + kGolden)) {
    // Each part of the address passes through the mixer, so that neighbouring addresses share nothing.
    state_ = mix(state_ ^ mix(step + 2 * kGolden));
    state_ = mix(state_ ^ mix(particle + 3 * kGolden));
    state_ = mix(state_ ^ mix(static_cast<std::uint64_t>(purpose) + 4 * kGolden));
}

std::uint64_t RandomStream::bits() {
    return mix(state_ += kGolden);
}

double RandomStream::uniform() {
    return static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

double RandomStream::uniform(double low, double high) {
    return low + (high - low) * uniform();
}

int RandomStream::below(int count) {
    return static_cast<int>(uniform() * count);
}

double RandomStream::gaussian() {
    const double radius = std::sqrt(-2.0 * std::log1p(-uniform()));  // log of a number in (0, 1]
    return radius * std::cos(2.0 * M_PI * uniform());
}

Eigen::Quaterniond RandomStream::rotation() {
    const double a = uniform(), b = 2.0 * M_PI * uniform(), c = 2.0 * M_PI * uniform();
    const double p = std::sqrt(1.0 - a), q = std::sqrt(a);
    return Eigen::Quaterniond(q * std::cos(c), p * std::sin(b), p * std::cos(b), q * std::sin(c));
}

Eigen::Vector3d RandomStream::direction() {
    const double z = uniform(-1.0, 1.0), angle = 2.0 * M_PI * uniform();
    const double radius = std::sqrt(1.0 - z * z);
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

}  // namespace nearpose
