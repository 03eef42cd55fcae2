#include "apps/scenes/delivery.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace nearpose::simulate {
namespace {

Delivery delivery(const std::vector<std::string>& texts, int frames = 8) {
    std::vector<Fault> faults;
    for (const std::string& text : texts) faults.push_back(parse_fault(text));
    return delivery_of(frames, 0.0, faults, 1);
}

TEST(Delivery, WithoutFaultsEveryFrameIsItself) {
    std::vector<int> all(8);
    std::iota(all.begin(), all.end(), 0);
    const Delivery plain = delivery({});
    EXPECT_EQ(plain.ids, all);
    EXPECT_EQ(plain.copy_of, all);
    EXPECT_EQ(plain.image_of, all);
    EXPECT_EQ(plain.stamp, std::vector<double>(all.begin(), all.end()));
}

TEST(Delivery, DroppedFramesLeaveGaps) {
    EXPECT_EQ(delivery({"dropped@2-4", "dropped@7"}).ids, (std::vector<int>{0, 1, 5, 6}));
    EXPECT_TRUE(delivery({"dropped@all"}).ids.empty());
}

TEST(Delivery, AHangingCameraShowsTheFrameBefore) {
    EXPECT_EQ(delivery({"frozen@3-5"}).image_of, (std::vector<int>{0, 1, 2, 2, 2, 2, 6, 7}));
    EXPECT_EQ(delivery({"frozen@all"}).image_of, std::vector<int>(8, 0));
    EXPECT_EQ(delivery({"frozen@2-3", "frozen@4-5"}).image_of, (std::vector<int>{0, 1, 1, 1, 1, 1, 6, 7}));
    EXPECT_EQ(delivery({"frozen@3-5"}).stamp, delivery({}).stamp);
}

TEST(Delivery, EveryOtherFrameIsADuplicate) {
    EXPECT_EQ(delivery({"duplicated@3-5"}).copy_of, (std::vector<int>{0, 1, 2, 2, 4, 4, 6, 7}));
    EXPECT_EQ(delivery({"duplicated@all"}).copy_of, (std::vector<int>{0, 0, 2, 2, 4, 4, 6, 6}));
    EXPECT_EQ(delivery({"duplicated@2", "duplicated@3"}).copy_of, (std::vector<int>{0, 1, 1, 1, 4, 5, 6, 7}));
}

TEST(Delivery, LateFramesHoldUpThoseBehindThem) {
    const std::vector<double> stamp = delivery({"late@2-3"}).stamp;
    const double expected[] = {0.0, 1.0, 3.5, 4.5, 4.6, 5.0, 6.0, 7.0};
    for (std::size_t i = 0; i < 8; ++i) EXPECT_DOUBLE_EQ(stamp[i], expected[i]) << i;
}

}  // namespace
}  // namespace nearpose::simulate
