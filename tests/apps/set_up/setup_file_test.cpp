#include "apps/set_up/setup_file.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/apps/support/contains.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::program {
namespace {

using data_set::testing_files::read_text;
using data_set::testing_files::write_text;

Calibration found() {
    SetupVector errors;
    errors << 0.02, 3.0, -2.0, 0.01, 0.02, -0.01, 0.03, 0.004, 0.001, -0.002, 0.5;
    Calibration calibration;
    calibration.solved = true;
    calibration.frame_s = 0.05;
    calibration.errors = errors_of(errors, calibration.frame_s);
    calibration.sigma = 0.1 * calibration.prior_sigma;
    return calibration;
}

TEST(SetupFile, ComesBackAsItWasWritten) {
    const std::filesystem::path file = data_set::testing_files::new_folder() / "set_up.json";
    write_setup_file(file, found());
    const SetupErrors errors = read_setup_file(file);
    EXPECT_LT((in_order(errors, 0.05) - in_order(found().errors, 0.05)).norm(), 1e-9);
}

TEST(SetupFile, OtherFilesAreRefusedByName) {
    const std::filesystem::path file = data_set::testing_files::new_folder() / "set_up.json";
    const auto message = [&](const std::string& from, const std::string& to) {
        write_setup_file(file, found());
        std::string text = read_text(file);
        text.replace(text.find(from), from.size(), to);
        write_text(file, text);
        try {
            read_setup_file(file);
        } catch (const std::runtime_error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_TRUE(contains(message("nearpose set-up", "camera"), "set_up.json"));
    EXPECT_TRUE(contains(message("nearpose set-up", "camera"), "nearpose calibrate --out"));
    EXPECT_TRUE(contains(message("\"version\": 1", "\"version\": 2"), "version 2"));
    EXPECT_TRUE(contains(message("time_offset_ms", "time_offset_s"), "time_offset_ms"));
    EXPECT_TRUE(contains(message("depth_scale_percent\": ", "depth_scale_percent\": -100"), "depth scale"));
}

}  // namespace
}  // namespace nearpose::program
