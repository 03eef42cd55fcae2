#include "core/update/time_budget.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose {
namespace {

// What an update must always be left time for.
constexpr std::array<int, 6> kLeastUnits = {0, 8, 0, 0, 1, 1};

}  // namespace

int TimeBudget::affordable(Stage stage, int wanted, int least, double elapsed_s) const {
    if (budget_s_ <= 0.0) return wanted;
    constexpr double kUsable = 0.8;  // of what is left: stages vary
    double later_s = 0.0;
    for (std::size_t k = static_cast<std::size_t>(stage) + 1; k < kStages; ++k) later_s += kLeastUnits[k] * unit_s_[k];
    const double units = (kUsable * (budget_s_ - elapsed_s) - later_s) / unit_s_[static_cast<std::size_t>(stage)];
    return std::clamp(static_cast<int>(std::clamp(units, 0.0, 1e9)), std::min(least, wanted), wanted);
}

void TimeBudget::took(Stage stage, int count, double seconds) {
    if (count <= 0) return;
    constexpr double kRemembered = 0.9;
    double& unit_s = unit_s_[static_cast<std::size_t>(stage)];
    unit_s = std::max(seconds / count, kRemembered * unit_s);
}

}  // namespace nearpose
