#include "apps/fit_sensor/noise_figures.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "apps/base/simulation_draws.hpp"
#include "apps/depth_sensor/noise_field.hpp"

namespace nearpose::simulate {
namespace {

TEST(NoiseFigures, CorrelationIsThatOfTheSmoothedNoise) {
    for (const double correlation : {0.5, 0.8, 2.0}) {
        const auto noise = correlated_noise(300, 300, correlation, 5, 0, kPixelDraw);
        double products = 0.0, mean = 0.0;
        for (std::size_t i = 0; i + 1 < noise.size(); ++i) products += noise[i][0] * noise[i + 1][0];
        EXPECT_NEAR(products / static_cast<double>(noise.size()), shared_noise(correlation, 1), 0.03);
        for (int lag = 1; lag <= kLags; ++lag) mean += shared_noise(correlation, lag) / kLags;
        EXPECT_NEAR(correlation_for(mean), correlation, 1e-6);
    }
    EXPECT_EQ(variance_growth(0.0), 1.0);
    // For a Gaussian that is wide against the pixels: the integral of exp(-r^2 / (2 c^2)).
    EXPECT_NEAR(variance_growth(4.0), 2.0 * M_PI * 16.0, 2.0);
}

}  // namespace
}  // namespace nearpose::simulate
