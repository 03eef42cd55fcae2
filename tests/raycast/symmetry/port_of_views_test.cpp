// The search for symmetries through the port of views alone: a part of boxes in closed form, without any ray caster.
#include <gtest/gtest.h>

#include "raycast/symmetry/find_symmetries.hpp"
#include "tests/core/analytic_part.hpp"

namespace nearpose {
namespace {

TEST(FindSymmetries, NeedsNoMoreThanThePortOfViews) {
    const auto cube = test::BoxViewGenerator({{{-0.02, -0.02, -0.02}, {0.02, 0.02, 0.02}}});
    EXPECT_EQ(find_symmetries(cube, 5e-4).discrete.size(), 23U);
    // Two equal towers at opposite corners: a half turn.
    const auto towers = test::BoxViewGenerator({{{-0.10, -0.07, -0.03}, {0.10, 0.07, 0.03}},
                                                {{-0.09, -0.06, 0.03}, {-0.03, 0.01, 0.09}},
                                                {{0.03, -0.01, 0.03}, {0.09, 0.06, 0.09}}});
    const Symmetries found = find_symmetries(towers, 5e-4);
    ASSERT_EQ(found.discrete.size(), 1U);
    EXPECT_LT((found.discrete[0] * Eigen::Vector3d(0.1, 0.07, 0) - Eigen::Vector3d(-0.1, -0.07, 0)).norm(), 1e-3);
    EXPECT_TRUE(find_symmetries(test::BoxViewGenerator(test::asymmetric_part()), 5e-4).empty());
}

}  // namespace
}  // namespace nearpose
