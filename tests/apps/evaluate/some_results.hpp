// The result file and the log of a run on the tiny scene, made from its true poses.
#pragma once

#include <string>
#include <vector>

#include "apps/data_set/result_csv.hpp"
#include "apps/estimate/frame_log.hpp"
#include "tests/apps/support/contains.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {

// The call of evaluate for the scene's poses.csv.
std::string evaluate(const TinyScene& scene);

Pose moved(Pose pose, double offset_m);
// The true poses, each moved by `offset` along the camera's x axis; frame 1 is left out.
std::vector<data_set::PoseRow> some_rows(const TinyScene& scene, double offset_m, int scene_id = 7);
void write_results(const TinyScene& scene, const std::vector<data_set::PoseRow>& rows);

// Estimates for the same rows, with a standard deviation of 1 mm and 0.01 rad along all axes; frame 2 is predicted. It
// accepts frame 0, goes on at frame 2, gives up frame 3; frame 1 has no pose.
void write_log(const TinyScene& scene, const std::vector<data_set::PoseRow>& rows,
               const std::string& first_line = program::first_log_line({}));

}  // namespace nearpose::program_tests
