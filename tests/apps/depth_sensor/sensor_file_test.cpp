#include "apps/depth_sensor/sensor_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "apps/base/file_io.hpp"
#include "apps/simulate/simulate.hpp"

namespace nearpose::simulate {
namespace {

namespace fs = std::filesystem;

fs::path test_file(const std::string& text) {
    const fs::path folder = fs::path(testing::TempDir()) / "sensor_file_test" /
                            testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::create_directories(folder);
    const fs::path path = folder / "sensor.json";
    data_set::write_file_atomically(path, text);
    return path;
}

std::string written(const SensorDescription& sensor) {
    const fs::path path = test_file("");
    write_sensor(path, sensor);
    return data_set::read_whole_file(path, 1 << 20);
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
}

std::string problem_of(const std::string& text) {
    try {
        read_sensor(test_file(text).string());
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "";
}

TEST(SensorFile, CloseStereoIsTheDefault) {
    const SensorDescription sensor = read_sensor("close_stereo");
    SensorDescription defaults = sensor;
    defaults.noise = SensorNoise{};
    defaults.camera = default_camera();
    defaults.depth_scale_mm = RecordingOptions{}.depth_scale_mm;
    EXPECT_EQ(written(sensor), written(defaults));
}

TEST(SensorFile, ThoseOfExperimentsDifferFromCloseStereoInOneFigure) {
    const SensorDescription close = read_sensor("close_stereo");
    SensorDescription distorted = read_sensor("apps/experiments/sensors/distorted.json");
    SensorDescription scale_error = read_sensor("apps/experiments/sensors/scale_error.json");
    EXPECT_EQ(distorted.noise.bias_sigma_m, 0.001);
    EXPECT_EQ(scale_error.noise.depth_scale_error, 0.004);
    distorted.noise.bias_sigma_m = close.noise.bias_sigma_m;
    scale_error.noise.depth_scale_error = close.noise.depth_scale_error;
    for (SensorDescription* sensor : {&distorted, &scale_error}) {
        EXPECT_EQ(sensor->sources.size(), close.sources.size());
        sensor->name = close.name;
        sensor->description = close.description;
        sensor->sources = close.sources;
        EXPECT_EQ(written(*sensor), written(close));
    }
}

TEST(SensorFile, EveryFigureOfTheBuiltInOnesHasItsSource) {
    EXPECT_EQ(sensor_names().size(), 6u);
    for (const std::string& name : sensor_names()) {
        const SensorDescription sensor = read_sensor(name);
        EXPECT_EQ(sensor.name, name);
        for (const std::string& key : sensor_figures()) {
            EXPECT_TRUE(sensor.sources.count(key) == 1 && sensor.sources.at(key).size() > 10) << name << " " << key;
        }
    }
}

TEST(SensorFile, WhatIsWrittenIsReadBack) {
    for (const std::string& name : sensor_names()) {
        const std::string text = written(read_sensor(name));
        EXPECT_EQ(written(read_sensor(test_file(text).string())), text);
    }
}

TEST(SensorFile, IdealMeasuresExactDepth) {
    const SensorDescription sensor = read_sensor("ideal");
    const std::size_t count = static_cast<std::size_t>(sensor.camera.width) * sensor.camera.height;
    RenderedImage image{{sensor.camera.width, sensor.camera.height, std::vector<float>(count, 0.5F)},
                        std::vector<int>(count, 0),
                        std::vector<Eigen::Vector3f>(count, -Eigen::Vector3f::UnitZ())};
    EXPECT_EQ(DepthSensor(sensor.noise, sensor.camera, 1).measure(image, 0).depth_m, image.depth.depth_m);
}

TEST(SensorFile, ErrorsNameFileKeyValueAndBound) {
    const std::string good = written(read_sensor("d405"));
    EXPECT_EQ(problem_of(good), "");
    const auto has = [](const std::string& text, const std::string& part) {
        EXPECT_NE(text.find("sensor.json"), std::string::npos) << text;
        EXPECT_NE(text.find(part), std::string::npos) << text;
    };
    has(problem_of(replaced(good, "\"jitter_pixels\"", "\"jitter\"")), "noise/jitter: unknown key");
    has(problem_of(replaced(good, "\"jitter_pixels\": 0.5,", "")), "noise: lacks the key \"jitter_pixels\"");
    has(problem_of(replaced(good, "\"jitter_pixels\": 0.5", "\"jitter_pixels\": 500")),
        "sensor.jitter_pixels is 500, but must be in 0..100");
    has(problem_of(replaced(good, "\"fx\": 382.3", "\"fx\": 0")), "fx");
    has(problem_of(replaced(good, "\"depth_scale_mm\": 0.1", "\"depth_scale_mm\": -1")), "depth_scale_mm is -1");
    has(problem_of(replaced(good, "\"format\": 1", "\"format\": 2")), "format: is 2, but must be 1");
    has(problem_of(replaced(good, "\"edge_radius_pixels\": 2", "\"edge_radius_pixels\": 2.5")), "edge_radius_pixels");
    has(problem_of(replaced(good, "\"noise.jitter_pixels\"", "\"noise.jit\"")), "sources/noise.jit: unknown key");
    EXPECT_THROW(read_sensor("d999"), std::runtime_error);
}

}  // namespace
}  // namespace nearpose::simulate
