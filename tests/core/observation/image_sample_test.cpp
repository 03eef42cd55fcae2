#include "core/observation/image_sample.hpp"

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace nearpose {
namespace {

const PinholeCamera kCamera{320, 240, 300.0, 300.0, 159.5, 119.5};

// A wall with noise at 0.5 m.
Observation noisy_wall(std::uint64_t seed) {
    RandomStream random(seed, 0, 0, RandomPurpose::kDiffusion);
    DepthImage image{kCamera.width, kCamera.height, {}};
    for (int i = 0; i < kCamera.width * kCamera.height; ++i)
        image.depth_m.push_back(0.5F + 0.0005F * static_cast<float>(random.gaussian()));
    return make_observation(std::move(image), kCamera, std::nullopt, {});
}

// The same depths, some of which are changed.
Observation with_changes(const Observation& before, int every) {
    DepthImage image{kCamera.width, kCamera.height, before.depth_m()};
    for (std::size_t i = 0; i < image.depth_m.size(); i += every) image.depth_m[i] += 0.001F;
    return make_observation(std::move(image), kCamera, std::nullopt, {});
}

const Pose kMoved{Eigen::Quaterniond::Identity(), {0.0, 0.0, -0.004}};

// How often in a row each image was seen again.
std::vector<int> repeats_of(const std::vector<Observation>& images, const std::optional<Pose>& now_from_before) {
    std::vector<int> repeats;
    ImageMemory memory;
    for (const Observation& image : images) {
        memory = seen_again(memory, image, now_from_before, {});
        repeats.push_back(memory.repeats);
    }
    return repeats;
}

TEST(ImageSample, EqualImagesAreOneAndNoiseMakesAnother) {
    const Observation one = noisy_wall(1), other = noisy_wall(2);
    const auto same = [](const Observation& a, const Observation& b) {
        return same_image(sample_of(a, {}), sample_of(b, {}), {});
    };
    EXPECT_TRUE(same(one, noisy_wall(1)));
    EXPECT_FALSE(same(one, other));
    EXPECT_TRUE(same(one, with_changes(one, 1009))) << "but for a few pixels";
    EXPECT_FALSE(same(one, with_changes(one, 7)));
}

TEST(ImageSample, AnEmptyImageIsLikeNoOther) {
    const ImageSample empty{320, 240, std::vector<float>(4800, 0.0F)};
    EXPECT_FALSE(same_image(empty, empty, {}));
}

TEST(ImageSample, RepeatsAreCountedUntilTheImageChanges) {
    const Observation one = noisy_wall(1), other = noisy_wall(2);
    const std::vector<Observation> images = {one, one, one, other, one, one};
    EXPECT_EQ(repeats_of(images, kMoved), (std::vector<int>{0, 1, 2, 0, 0, 1}));
    EXPECT_EQ(repeats_of(images, std::nullopt), (std::vector<int>{0, 1, 2, 0, 0, 1}));
}

TEST(ImageSample, ACameraAtRestMaySeeTheSameAgain) {
    const Observation one = noisy_wall(1);
    EXPECT_EQ(repeats_of({one, one, one}, Pose{}), (std::vector<int>{0, 0, 0}));
}

TEST(ImageSample, ACameraThatCreepsIsNotAtRestForEver) {
    const Observation one = noisy_wall(1);
    // 0.1 mm a frame at 0.5 m is 0.06 pixels: a quarter is exceeded in the fifth frame after the first.
    const Pose creeping{Eigen::Quaterniond::Identity(), {0.0001, 0.0, 0.0}};
    EXPECT_EQ(repeats_of({one, one, one, one, one, one, one}, creeping), (std::vector<int>{0, 0, 0, 0, 0, 1, 2}));
}

TEST(ImageSample, TheMotionSinceTheImageAddsUp) {
    const Observation one = noisy_wall(1);
    ImageMemory memory;
    for (int frame = 0; frame < 4; ++frame) memory = seen_again(memory, one, kMoved, {});
    EXPECT_EQ(memory.repeats, 3);
    EXPECT_NEAR(memory.now_from_sample.translation.z(), -0.012, 1e-12);
}

}  // namespace
}  // namespace nearpose
