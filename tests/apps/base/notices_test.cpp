#include "apps/base/notices.hpp"

#include <gtest/gtest.h>

namespace nearpose::data_set {
namespace {

TEST(Notices, TellOneMatterFromAnotherButNotByNumbers) {
    Notices notices;
    EXPECT_TRUE(notices.add(3, "000003.png: is off by 0.25"));
    EXPECT_FALSE(notices.add(4, "000004.png: is off by 1e-05"));
    EXPECT_TRUE(notices.add(4, "000004.tif: is off by 1"));
    EXPECT_FALSE(notices.add(12, "000012.png: is off by 2"));
    ASSERT_EQ(notices.all().size(), 2U);
    EXPECT_EQ(to_text(notices.all()[0]), "000003.png: is off by 0.25; the same in 2 more frames (the last: 12)");
    EXPECT_EQ(repeats_of(notices.all()[0]), "as in frame 3, so in 2 more frames (the last: 12)");
    EXPECT_EQ(to_text(notices.all()[1]), "000004.tif: is off by 1");
    EXPECT_EQ(repeats_of(notices.all()[1]), "");
}

}  // namespace
}  // namespace nearpose::data_set
