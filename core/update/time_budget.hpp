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

struct TimeBudgetOptions {
    double usable = 0.8;      // share of the time left that a stage may plan with: stages vary
    double remembered = 0.9;  // share of an expensive unit's time that is kept from update to update
    // Time of a unit before anything is known [s]: that of a machine ten times as slow as usual ones.
    std::array<double, 6> first_unit_s = {2e-3, 5e-4, 1e-3, 5e-4, 5e-3, 1e-2};
    // Units of each stage that an update must always be left time for.
    std::array<int, 6> least_units = {0, 8, 0, 0, 1, 1};
};

// Learns what a unit of each stage takes, elapsed, and leaves room for the stages that follow. It says what is likely
// to fit: an update that the machine holds up is late all the same. Not for several threads at once.
class TimeBudget {
  public:
    // 0: no limit, everything is affordable.
    explicit TimeBudget(double budget_s = 0.0, const TimeBudgetOptions& options = {})
        : budget_s_(budget_s), options_(options), unit_s_(options.first_unit_s) {}

    // So many of `wanted` units fit after `elapsed_s` of this update; never less than `least`.
    int affordable(Stage stage, int wanted, int least, double elapsed_s) const;
    // What `count` units took. An expensive one is remembered for a while: the next may be as expensive.
    void took(Stage stage, int count, double seconds);

  private:
    double budget_s_;
    TimeBudgetOptions options_;
    std::array<double, 6> unit_s_;  // learned
};

}  // namespace nearpose
