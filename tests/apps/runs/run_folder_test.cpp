#include "apps/runs/run_folder.hpp"

#include <gtest/gtest.h>

#include "tests/apps/support/test_files.hpp"

namespace nearpose::program {
namespace {

TEST(RunRecord, GivesBackWhatTheRunWasTold) {
    const std::filesystem::path folder = data_set::testing_files::new_folder();
    EstimateOptions options;
    options.scene = folder / "scene";
    options.model.models = folder / "models";
    options.model.object = 3;
    options.method = "paper";
    options.symmetries = "none";
    options.particles = 50;
    options.mask_index = 2;
    options.budget_ms = 20.0;
    options.outputs.run = folder;
    write_run_record(folder, options, 7);
    const RunRecord record = read_run_record(folder);
    EXPECT_EQ(record.scene_id, 7);
    EXPECT_EQ(record.options.scene, options.scene);
    EXPECT_EQ(record.options.model.models, options.model.models);
    EXPECT_EQ(record.options.model.object, 3);
    EXPECT_EQ(record.options.method, "paper");
    EXPECT_EQ(record.options.symmetries, "none");
    EXPECT_EQ(record.options.particles, 50);
    EXPECT_EQ(record.options.mask_index, 2);
    EXPECT_EQ(record.options.first, std::nullopt);
    EXPECT_EQ(record.options.budget_ms, 20.0);
    EXPECT_EQ(record.options.outputs.run, folder);
}

}  // namespace
}  // namespace nearpose::program
