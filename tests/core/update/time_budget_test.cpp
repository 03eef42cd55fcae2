#include "core/update/time_budget.hpp"

#include <gtest/gtest.h>

namespace nearpose {
namespace {

TEST(TimeBudget, WithoutALimitEverythingIsAffordable) {
    const TimeBudget budget;
    EXPECT_EQ(budget.affordable(Stage::kSearch, 1'000'000, 1, 1e9), 1'000'000);
}

// Once the costs are known, what it allows plus what must follow fits into what is left.
TEST(TimeBudget, WhatItAllowsFitsIntoWhatIsLeft) {
    constexpr double kParticle_s = 1e-4, kMode_s = 2e-3, kFit_s = 1e-3;
    TimeBudget budget(0.02);
    for (int k = 0; k < 200; ++k) {  // the first guesses are forgotten
        budget.took(Stage::kParticles, 100, 100 * kParticle_s);
        budget.took(Stage::kModes, 2, 2 * kMode_s);
        budget.took(Stage::kFit, 1, kFit_s);
    }
    for (const double elapsed_s : {0.0, 0.005, 0.01}) {
        const int count = budget.affordable(Stage::kParticles, 10'000, 1, elapsed_s);
        EXPECT_GT(count, 1);
        EXPECT_LE(elapsed_s + count * kParticle_s + kMode_s + kFit_s, 0.02);
        EXPECT_GT(count, 0.5 * (0.02 - elapsed_s - kMode_s - kFit_s) / kParticle_s - 10);  // nor is time given away
    }
    EXPECT_EQ(budget.affordable(Stage::kParticles, 3, 1, 0.0), 3);       // never more than is wanted
    EXPECT_EQ(budget.affordable(Stage::kParticles, 10'000, 7, 1.0), 7);  // nor less than the least
    EXPECT_EQ(budget.affordable(Stage::kParticles, 5, 7, 1.0), 5);
}

TEST(TimeBudget, ADearUnitIsRememberedForAWhile) {
    TimeBudget budget(1.0);
    for (int k = 0; k < 200; ++k) budget.took(Stage::kAlternatives, 1, 1e-4);
    const int usual = budget.affordable(Stage::kAlternatives, 1'000'000, 0, 0.0);
    budget.took(Stage::kAlternatives, 1, 1e-2);
    budget.took(Stage::kAlternatives, 1, 1e-4);
    EXPECT_LT(budget.affordable(Stage::kAlternatives, 1'000'000, 0, 0.0), usual / 50);
    for (int k = 0; k < 100; ++k) budget.took(Stage::kAlternatives, 1, 1e-4);
    EXPECT_EQ(budget.affordable(Stage::kAlternatives, 1'000'000, 0, 0.0), usual);
}

}  // namespace
}  // namespace nearpose
