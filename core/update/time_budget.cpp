#include "core/update/time_budget.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose {

int TimeBudget::affordable(Stage stage, int wanted, int least, double elapsed_s) const {
    if (budget_s_ <= 0.0) return wanted;
    double later_s = 0.0;
    for (std::size_t k = static_cast<std::size_t>(stage) + 1; k < unit_s_.size(); ++k)
        later_s += options_.least_units[k] * unit_s_[k];
    const double units =
        (options_.usable * (budget_s_ - elapsed_s) - later_s) / unit_s_[static_cast<std::size_t>(stage)];
    return std::clamp(static_cast<int>(std::clamp(units, 0.0, 1e9)), std::min(least, wanted), wanted);
}

void TimeBudget::took(Stage stage, int count, double seconds) {
    if (count <= 0) return;
    double& unit_s = unit_s_[static_cast<std::size_t>(stage)];
    unit_s = std::max(seconds / count, options_.remembered * unit_s);
}

}  // namespace nearpose
