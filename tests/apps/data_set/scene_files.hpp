// A scene of three small frames whose scene_camera.json a test writes itself.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/data_set/bop_scene.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {

inline const std::string kK = R"("cam_K": [500, 0, 1.5, 0, 501, 1.25, 0, 0, 1], "depth_scale": 0.5)";

class SceneFiles : public testing::Test {
  protected:
    const std::filesystem::path scene_ = testing_files::write_small_scene(testing_files::new_folder());

    // `entries` are those of frames 0, 1, ...
    BopScene open(const std::vector<std::string>& entries) {
        std::string json;
        for (std::size_t i = 0; i < entries.size(); ++i) {
            json += (i == 0 ? "{\"" : ", \"") + std::to_string(i) + "\": {" + entries[i] + "}";
        }
        testing_files::write_text(scene_ / "scene_camera.json", json + "}");
        return open_scene(scene_);
    }
};

// One notice, which holds all of `parts`.
inline void expect_notice(const Notices& notices, const std::vector<std::string>& parts) {
    ASSERT_EQ(notices.all().size(), 1U);
    const std::string text = to_text(notices.all()[0]);
    for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << text;
}

}  // namespace nearpose::data_set
