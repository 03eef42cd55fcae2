#include "apps/runs/input_doubts.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/apps/support/contains.hpp"

namespace nearpose::program {
namespace {

const PinholeCamera kCamera{640, 480, 600.0, 600.0, 319.5, 239.5};

PinholeCamera camera(int width, int height, double cx, double cy, double focal = 600.0) {
    return {width, height, focal, focal, cx, cy};
}

TEST(InputDoubts, UsualCamerasRaiseNone) {
    for (const PinholeCamera& usual : {kCamera, camera(640, 480, 311.5, 246.3, 476.0),
                                       camera(1280, 720, 655.0, 350.0, 640.0), camera(720, 540, 366.7, 277.2, 1075.0),
                                       camera(640, 576, 320.1, 336.0, 504.0), camera(480, 640, 239.5, 319.5)}) {
        EXPECT_EQ(camera_doubt(usual), "");
    }
}

TEST(InputDoubts, IntrinsicsOfAnotherImageAreNamedWithTheLikelyCause) {
    // Images at half and at double the resolution.
    EXPECT_TRUE(contains(camera_doubt(camera(320, 240, 319.5, 239.5)), "640 x 480: of another resolution"));
    EXPECT_TRUE(contains(camera_doubt(camera(1280, 960, 319.5, 239.5)), "640 x 480: of another resolution"));
    // A quarter of the rows is missing above.
    EXPECT_TRUE(contains(camera_doubt(camera(640, 360, 319.5, 239.5)), "rows or columns cut off"));
    EXPECT_TRUE(contains(camera_doubt(camera(640, 480, 239.5, 319.5)), "exchanged"));
    EXPECT_TRUE(contains(camera_doubt(camera(640, 480, 0.0, 400.0)), "may be wrong"));
    EXPECT_TRUE(contains(camera_doubt(camera(640, 480, 319.5, 239.5, 20000.0)), "field of view of 2 degrees"));
    EXPECT_TRUE(contains(camera_doubt(camera(640, 480, 319.5, 239.5, 1.0)), "field of view of 180 degrees"));
}

// A square of 100 x 100 pixels before a wall: its depth, and its mask.
struct Square {
    DepthImage depth{640, 480, std::vector<float>(640 * 480, 1.0F)};
    Mask mask{640, 480, std::vector<std::uint8_t>(640 * 480, 0)};

    explicit Square(float depth_m) {
        for (int v = 200; v < 300; ++v) {
            for (int u = 250; u < 350; ++u) {
                depth.depth_m[static_cast<std::size_t>(v * 640 + u)] = depth_m;
                mask.value[static_cast<std::size_t>(v * 640 + u)] = 255;
            }
        }
    }
    Mask inverted() const {
        Mask result = mask;
        for (std::uint8_t& value : result.value) value = static_cast<std::uint8_t>(255 - value);
        return result;
    }
};

TEST(InputDoubts, AMaskOfEverythingButWhatIsNearIsAskedAbout) {
    const Square near(0.6F), hole(1.5F);
    EXPECT_EQ(mask_doubt(near.depth, near.mask), "");
    EXPECT_TRUE(contains(mask_doubt(near.depth, near.inverted()), "everything but 3.3 % of the image"));
    EXPECT_TRUE(contains(mask_doubt(near.depth, near.inverted()), "is it inverted?"));
    // A part that fills the image has bores, which are deeper.
    EXPECT_EQ(mask_doubt(hole.depth, hole.inverted()), "");
    const Mask all{640, 480, std::vector<std::uint8_t>(640 * 480, 255)};
    EXPECT_EQ(mask_doubt(near.depth, all), "");
    // Without a background nothing is measured in the inverted mask.
    Square alone(0.6F);
    for (std::size_t i = 0; i < alone.mask.value.size(); ++i) {
        if (alone.mask.value[i] == 0) alone.depth.depth_m[i] = 0.0F;
    }
    EXPECT_TRUE(contains(mask_doubt(alone.depth, alone.inverted()), "inverted"));
}

ModelExtent box(double x_m, double y_m, double z_m) {
    return {Eigen::Vector3d::Zero(), Eigen::Vector3d(x_m, y_m, z_m)};
}

TEST(InputDoubts, AMaskThatShowsAnotherSizeThanTheModelsIsAskedAbout) {
    // 99 of 600 pixels at 0.6 m: 99 mm a side, 140 mm across.
    const Square square(0.6F);
    EXPECT_EQ(scale_doubt(square.depth, &square.mask, kCamera, box(0.1, 0.1, 0.02)), "");
    EXPECT_EQ(scale_doubt(square.depth, &square.mask, kCamera, box(0.1, 0.1, 0.3)), "");  // along its longest side
    for (const double factor : {0.25, 4.0}) {
        const std::string doubt =
            scale_doubt(square.depth, &square.mask, kCamera, box(0.1 * factor, 0.1 * factor, 0.1 * factor));
        EXPECT_TRUE(contains(doubt, "is 140 mm across")) << factor << doubt;
        EXPECT_TRUE(contains(doubt, "depth_scale")) << doubt;
    }
}

TEST(InputDoubts, ASceneThatCannotHoldThePartIsAskedAbout) {
    const Square square(0.6F);  // 1 m in most pixels: 1.07 m wide
    EXPECT_EQ(scale_doubt(square.depth, nullptr, kCamera, box(0.4, 0.2, 0.2)), "");
    const std::string doubt = scale_doubt(square.depth, nullptr, kCamera, box(1.6, 0.2, 0.2));
    EXPECT_TRUE(contains(doubt, "implausibly small")) << doubt;
    EXPECT_TRUE(contains(doubt, "1000 mm")) << doubt;
    EXPECT_EQ(scale_doubt({640, 480, std::vector<float>(640 * 480, 0.0F)}, nullptr, kCamera, box(1.6, 1, 1)), "");
}

// A slanted plane in millimetres, measured at every `step`th pixel and enlarged from `first` on.
DepthImage enlarged(int step, int first) {
    DepthImage depth{160, 120, std::vector<float>(160 * 120)};
    for (int v = 0; v < depth.height; ++v) {
        for (int u = 0; u < depth.width; ++u) {
            const int column = (u + first) / step * step, row = (v + first) / step * step;
            depth.depth_m[v * depth.width + u] =
                static_cast<float>(1e-3 * std::round(400.0 + 0.7 * column + 1.3 * row));
        }
    }
    return depth;
}

TEST(InputDoubts, ImagesThatWereEnlargedAreNamed) {
    EXPECT_TRUE(contains(decimation_doubt(enlarged(2, 0)), "blocks of 2 x 2 pixels"));
    EXPECT_TRUE(contains(decimation_doubt(enlarged(4, 3)), "blocks of 4 x 4 pixels"));
    EXPECT_TRUE(contains(decimation_doubt(enlarged(8, 0)), "blocks of 8 x 8 pixels"));
    EXPECT_EQ(decimation_doubt(enlarged(1, 0)), "") << "quantised, but at full resolution";
    EXPECT_EQ(decimation_doubt({}), "");
    EXPECT_EQ(decimation_doubt({160, 120, std::vector<float>(160 * 120, 1.0F)}), "") << "a wall that is straight ahead";
    EXPECT_EQ(decimation_doubt({160, 120, std::vector<float>(160 * 120, 0.0F)}), "");
}

}  // namespace
}  // namespace nearpose::program
