// How much of an update fits into the time that the caller has for it.
#pragma once

#include <array>

namespace nearpose {

// In the order in which an update goes through them, and what is counted in each.
enum class Stage {
    kSearch,        // candidates of a start
    kParticles,     // moved
    kPreselection,  // looked at
    kAlternatives,  // tried
    kModes,         // refined
    kFit,           // one, with the verdict
};

// Learns what a unit of each stage takes, elapsed, and leaves room for the stages that follow. It says what is likely
// to fit: an update that the machine holds up is late all the same. Not for several threads at once.
class TimeBudget {
  public:
    // 0: no limit, everything is affordable.
    explicit TimeBudget(double budget_s = 0.0) : budget_s_(budget_s) {}

    // So many of `wanted` units fit after `elapsed_s` of this update; never less than `least`.
    int affordable(Stage stage, int wanted, int least, double elapsed_s) const;
    // What `count` units took. A dear one is remembered for a while: the next may be as dear.
    void took(Stage stage, int count, double seconds);

  private:
    static constexpr std::size_t kStages = 6;

    double budget_s_;
    // [s], before anything is known: of a machine ten times as slow as usual ones.
    std::array<double, kStages> unit_s_ = {2e-3, 5e-4, 1e-3, 5e-4, 5e-3, 1e-2};
};

}  // namespace nearpose
