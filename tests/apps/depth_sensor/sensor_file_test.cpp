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
    EXPECT_EQ(sensor_names().size(), 10u);
    for (const std::string& name : sensor_names()) {
        const SensorDescription sensor = read_sensor(name);
        EXPECT_EQ(sensor.name, name);
        const bool is_stereo = name.find("stereo_") == 0, is_light = name.find("structured_") == 0;
        EXPECT_EQ(sensor.stereo.has_value(), is_stereo || is_light);
        const std::string section = sensor.stereo ? section_of(*sensor.stereo) : "noise";
        EXPECT_EQ(section == "structured_light", is_light);
        for (const std::string& key : sensor_figures({section})) {
            EXPECT_TRUE(sensor.sources.count(key) == 1 && sensor.sources.at(key).size() > 10) << name << " " << key;
        }
    }
}

TEST(SensorFile, WhatIsWrittenIsReadBack) {
    for (const std::string& name : sensor_names()) {
        if (read_sensor(name).stereo) continue;
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

TEST(SensorFile, OfActiveStereoRefusesBadFigures) {
    const std::string good = data_set::read_whole_file("apps/sensors/stereo_d435.json", 1 << 20);
    EXPECT_EQ(problem_of(good), "");
    const auto has = [](const std::string& text, const std::string& part) {
        EXPECT_NE(text.find("sensor.json"), std::string::npos) << text;
        EXPECT_NE(text.find(part), std::string::npos) << text;
    };
    has(problem_of(replaced(good, "\"baseline_m\": 0.05", "\"baseline_m\": 0")), "active_stereo.baseline_m is 0");
    has(problem_of(replaced(good, "\"window_pixels\": 9", "\"window_pixels\": 8")),
        "active_stereo.window_pixels is 8, but must be odd");
    has(problem_of(replaced(good, "\"dots\": 20000", "\"dots\": 0.5")), "active_stereo/dots");
    has(problem_of(replaced(good, "\"dots\": 20000", "\"spots\": 20000")), "active_stereo/spots: unknown key");
    has(problem_of(replaced(good, "\"max_range_m\": 4.0", "\"max_range_m\": 0.1")), "max_range_m is 0.1");
    has(problem_of(replaced(good, "\"penalty_jump\": 8", "\"penalty_jump\": 2")), "active_stereo.penalty_jump is 2");
}

TEST(SensorFile, OfStructuredLightRefusesBadFigures) {
    const std::string good = data_set::read_whole_file("apps/sensors/structured_carmine.json", 1 << 20);
    EXPECT_EQ(problem_of(good), "");
    const SensorDescription sensor = read_sensor("structured_carmine");
    EXPECT_EQ(sensor.stereo->projector_m, sensor.stereo->baseline_m);
    const auto has = [](const std::string& text, const std::string& part) {
        EXPECT_NE(text.find("sensor.json"), std::string::npos) << text;
        EXPECT_NE(text.find(part), std::string::npos) << text;
    };
    has(problem_of(replaced(good, "\"baseline_m\": 0.075", "\"baseline_m\": 2")),
        "structured_light.baseline_m is 2, but must be in 0.001..1");
    has(problem_of(replaced(good, "\"baseline_m\": 0.075", "\"projector_m\": 0.075")),
        "structured_light/projector_m: unknown key");
    has(problem_of(replaced(good, "\"dots\": 35000,", "")), "structured_light: lacks the key \"dots\"");
    has(problem_of(replaced(good, "\"window_pixels\": 7", "\"window_pixels\": 6")),
        "structured_light.window_pixels is 6, but must be odd");
    has(problem_of(replaced(good, "\"structured_light.dots\"", "\"active_stereo.dots\"")),
        "sources/active_stereo.dots: unknown key");
    has(problem_of(replaced(good, "\"structured_light\": {", "\"active_stereo\": {}, \"structured_light\": {")),
        "has active_stereo and structured_light, but must have one of them");
    try {
        write_sensor(test_file(""), sensor);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("structured_light cannot be written"), std::string::npos);
    }
}

TEST(SensorFile, OfActiveStereoMayAlsoHoldTheNoiseThatItsDepthIsLike) {
    const std::string stereo = data_set::read_whole_file("apps/sensors/stereo_d435.json", 1 << 20);
    const std::string noise = data_set::read_whole_file("apps/sensors/d435.json", 1 << 20);
    const std::size_t begin = noise.find("  \"noise\""), end = noise.find("  \"sources\"");
    const std::string both =
        replaced(stereo, "  \"active_stereo\"", noise.substr(begin, end - begin) + "  \"active_stereo\"");
    EXPECT_NE(problem_of(both).find("must be those of noise"), std::string::npos) << problem_of(both);
    const SensorDescription sensor =
        read_sensor(test_file(replaced(both, "\"max_range_m\": 10.0", "\"max_range_m\": 4.0")).string());
    EXPECT_TRUE(sensor.stereo);
    EXPECT_EQ(sensor.noise.sigma_per_square_metre, read_sensor("d435").noise.sigma_per_square_metre);
}

}  // namespace
}  // namespace nearpose::simulate
