// fit-sensor, run as a user would.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "apps/data_set/bop_writer.hpp"
#include "apps/depth_sensor/sensor_file.hpp"
#include "tests/apps/support/contains.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

const PinholeCamera kCamera{120, 90, 110.0, 110.0, 59.5, 44.5};
constexpr double kScale_mm = 0.05;

std::filesystem::path new_folder() {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::filesystem::path folder =
        std::filesystem::path(testing::TempDir()) / "nearpose_fit_sensor" / test->name();
    std::filesystem::remove_all(folder);
    return folder;
}

// A frontal wall, three frames from each distance; the right half of it stands `step_m` nearer.
std::filesystem::path write_walls(const std::filesystem::path& folder, const simulate::SensorNoise& noise,
                                  const std::vector<double>& distances_m, double step_m = 0.0) {
    const simulate::DepthSensor sensor(noise, kCamera, 1);
    const std::size_t count = static_cast<std::size_t>(kCamera.width) * kCamera.height;
    data_set::BopSceneWriter writer(folder / "test/000001");
    int id = 0;
    for (const double distance_m : distances_m) {
        RenderedImage image{{kCamera.width, kCamera.height, std::vector<float>(count)},
                            std::vector<int>(count, 0),
                            std::vector<Eigen::Vector3f>(count, Eigen::Vector3f(0.0F, 0.0F, -1.0F))};
        for (std::size_t i = 0; i < count; ++i) {
            const bool right = static_cast<int>(i) % kCamera.width >= kCamera.width / 2;
            image.depth.depth_m[i] = static_cast<float>(distance_m - (right ? step_m : 0.0));
        }
        for (int i = 0; i < 3; ++i, ++id) {
            data_set::FrameRecord record;
            record.id = id;
            record.camera = kCamera;
            record.depth_scale_mm = kScale_mm;
            writer.add_frame(record, sensor.measure(image, static_cast<std::uint64_t>(id)));
        }
    }
    writer.finish();
    return folder / "test/000001";
}

simulate::SensorNoise wall_noise() {
    simulate::SensorNoise noise = simulate::scaled(simulate::SensorNoise{}, 0.0);
    noise.sigma_floor_m = 0.0006;
    noise.sigma_per_square_metre = 0.002;
    noise.edge_jump_m = 1.0;
    return noise;
}

TEST(FitSensor, WritesASensorFile) {
    const std::filesystem::path folder = new_folder();
    const auto scene = write_walls(folder, wall_noise(), {0.3, 0.6, 1.2});
    const auto out = folder / "mine.json";
    const Outcome outcome =
        run_nearpose("fit-sensor --base ideal --name mine --scene " + scene.string() + " --out " + out.string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char* part : {"range_m", "sigma_mm", "0.600", "sigma_floor_m = 0.000", "95 %", "m/m^2"}) {
        EXPECT_TRUE(contains(outcome.out, part)) << part << "\n" << outcome.out;
    }
    const simulate::SensorDescription sensor = simulate::read_sensor(out.string());
    EXPECT_EQ(sensor.name, "mine");
    EXPECT_NEAR(sensor.noise.sigma_floor_m, 0.0006, 0.05 * 0.0006);
    EXPECT_NEAR(sensor.noise.sigma_per_square_metre, 0.002, 0.05 * 0.002);
    EXPECT_NEAR(sensor.noise.correlation_pixels, wall_noise().correlation_pixels, 0.08);
    EXPECT_EQ(sensor.camera.width, kCamera.width);
    EXPECT_EQ(sensor.camera.fx, kCamera.fx);
    EXPECT_EQ(sensor.depth_scale_mm, kScale_mm);
    EXPECT_TRUE(contains(sensor.sources.at("noise.sigma_floor_m"), "fitted from 9 frames of a flat wall, 3 poses"));
    const auto base = simulate::read_sensor("ideal");
    EXPECT_EQ(sensor.noise.max_range_m, base.noise.max_range_m);
}

TEST(FitSensor, SaysWhatCouldNotBeDetermined) {
    const std::filesystem::path folder = new_folder();
    const auto scene = write_walls(folder, wall_noise(), {0.4});
    const Outcome outcome = run_nearpose("fit-sensor --base ideal --region 40 30 40 30 --scene " + scene.string() +
                                         " --out " + (folder / "mine.json").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "one distance")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "edge growth could not be determined")) << outcome.err;
    EXPECT_TRUE(contains(outcome.out, "kept from ideal")) << outcome.out;
    EXPECT_TRUE(contains(outcome.out, " 1200 ")) << outcome.out;
}

TEST(FitSensor, MeasuresEdgesOfAnObjectAtItsTruePose) {
    const std::filesystem::path folder = new_folder();
    const auto scene = write_walls(folder, wall_noise(), {0.3, 0.6, 1.2});
    std::string box;
    for (int i = 0; i < 8; ++i) {
        const auto corner = [&](int bit, int size) { return std::to_string((i >> bit & 1) * size) + " "; };
        box += "v " + corner(0, 260) + corner(1, 200) + corner(2, 120) + "\n";
    }
    for (const char* face : {"1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"})
        box += "f " + std::string(face) + "\n";
    write_text(folder / "box.obj", box);
    const Outcome simulated = run_nearpose(
        "simulate --quiet --frames 4 --scenario handheld --sensor d435 --no-symmetries --unit mm --model " +
        (folder / "box.obj").string() + " --out " + (folder / "box").string());
    ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
    const std::string command = "fit-sensor --base ideal --scene " + scene.string() + " --out " +
                                (folder / "mine.json").string() + " --edges " + (folder / "box/test/000001").string();
    const Outcome outcome = run_nearpose(command + " --models " + (folder / "box/models").string() + " --object 1");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    for (const char* part : {"correlation_rows_pixels = ", "in 4 frames", "growth_pixels", "scatter_pixels", "lower",
                             "edge_growth_columns_pixels = ", "edge_growth_rows_pixels: not determined"}) {
        EXPECT_TRUE(contains(outcome.out, part)) << part << "\n" << outcome.out;
    }
    EXPECT_TRUE(contains(outcome.err, "edge growth on the left side could not be determined")) << outcome.err;
    EXPECT_TRUE(contains(simulate::read_sensor((folder / "mine.json").string()).description, "pixels along columns"));
    const Outcome no_models = run_nearpose(command);
    EXPECT_EQ(no_models.exit_code, 2);
    EXPECT_TRUE(contains(no_models.err, "--edges and --models belong together")) << no_models.err;
    EXPECT_EQ(run_nearpose(command + " --models " + (folder / "box/models").string() + " --object 9").exit_code, 1);
}

TEST(FitSensor, RefusesAStepAndBadUse) {
    const std::filesystem::path folder = new_folder();
    const auto scene = write_walls(folder, wall_noise(), {0.5}, 0.05);
    const auto out = folder / "mine.json";
    const std::string command = "fit-sensor --scene " + scene.string() + " --out " + out.string();
    const Outcome step = run_nearpose(command);
    EXPECT_EQ(step.exit_code, 1);
    EXPECT_TRUE(contains(step.err, "flat wall") && contains(step.err, "RMS") && contains(step.err, "--region"))
        << step.err;
    EXPECT_FALSE(std::filesystem::exists(out));
    const Outcome outside = run_nearpose(command + " --region 100 0 30 90");
    EXPECT_EQ(outside.exit_code, 2);
    EXPECT_TRUE(contains(outside.err, "120 x 90")) << outside.err;
    EXPECT_EQ(run_nearpose(command + " --region 60 0 60").exit_code, 2);
    const Outcome stereo = run_nearpose(command + " --base stereo_d435");
    EXPECT_EQ(stereo.exit_code, 2);
    EXPECT_TRUE(contains(stereo.err, "--base stereo_d435: must be a sensor of simple noise")) << stereo.err;
    EXPECT_EQ(run_nearpose(command + " --region 0 0 50 90").exit_code, 0);
}

TEST(FitSensor, TellsOfFramesThatCannotBeRead) {
    const std::filesystem::path folder = new_folder();
    const auto scene = write_walls(folder, wall_noise(), {0.4, 0.8});
    write_text(scene / "depth/000001.png", "not a picture");
    const std::string command = "fit-sensor --scene " + scene.string() + " --out " + (folder / "mine.json").string();
    const Outcome outcome = run_nearpose(command);
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_TRUE(contains(outcome.err, "000001.png")) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder / "mine.json"));
    const Outcome none = run_nearpose(command + " --first 1 --last 1");
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_TRUE(contains(none.err, "none of the 1 frames")) << none.err;
}

}  // namespace
}  // namespace nearpose::program_tests
