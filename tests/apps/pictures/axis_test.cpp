#include "apps/pictures/axis.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace nearpose::pictures {
namespace {

TEST(Axis, HoldsItsValuesAndTicks) {
    for (const std::vector<double>& values :
         {std::vector<double>{0.0}, {0.3, 0.4}, {0.012, 7.0}, {1e-5, 300.0}, {0.0, 5.0, 1000.0}, {4.99}}) {
        const Axis axis = error_axis(values);
        ASSERT_LT(axis.low, axis.high);
        ASSERT_GE(axis.ticks.size(), 2U);
        for (const double tick : axis.ticks) {
            EXPECT_GE(tick, axis.low * 0.999);
            EXPECT_LE(tick, axis.high * 1.001);
        }
        EXPECT_LE(*std::max_element(values.begin(), values.end()), axis.high);
        EXPECT_DOUBLE_EQ(axis.fraction(axis.low), 0.0);
        EXPECT_DOUBLE_EQ(axis.fraction(axis.high), 1.0);
    }
    EXPECT_EQ(Axis::label(0.05), "0.05");
    EXPECT_EQ(Axis::label(0.002), "0.002");
    EXPECT_EQ(Axis::label(20.0), "20");
    EXPECT_EQ(Axis::label(0.0), "0");
    EXPECT_EQ(Axis::label(1.5), "1.5");
    EXPECT_EQ(Axis::label(3 * 0.1), "0.3");
}

}  // namespace
}  // namespace nearpose::pictures
