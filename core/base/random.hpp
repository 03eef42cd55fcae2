// Addressed randomness: a stream is named by what it is for, never by who drew before. The same seed gives the same
// draws whatever the number of threads and in whatever order particles are worked on.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

namespace nearpose {

enum class RandomPurpose : std::uint64_t { kStart = 1, kDiffusion, kResampling, kSampleConsensus, kAlternatives };

// A stream of independent draws (SplitMix64, Steele et al. 2014). The standard library's distributions differ between
// implementations, so the draws are made here.
class RandomStream {
  public:
    RandomStream(std::uint64_t seed, std::uint64_t step, std::uint64_t particle, RandomPurpose purpose);

    std::uint64_t bits();                     // 64 uniform bits
    double uniform();                         // in [0, 1)
    double uniform(double low, double high);  // in [low, high)
    int below(int count);                     // in 0..count-1; count >= 1
    double gaussian();                        // mean 0, standard deviation 1 (Box-Muller)
    Eigen::Quaterniond rotation();            // uniform over SO(3) (Shoemake 1992)
    Eigen::Vector3d direction();              // uniform over the unit sphere

  private:
    std::uint64_t state_;
};

}  // namespace nearpose
