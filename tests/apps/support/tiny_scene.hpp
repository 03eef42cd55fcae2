// A data set of a few small frames of an unsymmetric part, and the program run on it as a user would.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::program_tests {

struct Outcome {
    int exit_code = -1;
    std::string out, err;
};

// Runs `nearpose <arguments>` through the shell.
Outcome run_nearpose(const std::string& arguments);
// Runs a whole shell command in which $NEARPOSE is the program.
Outcome run_shell(const std::string& command);

std::string read_text(const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, const std::string& text);
// As JSON with BOP's short keys.
void write_pose(const std::filesystem::path& path, const Pose& camera_from_object);
std::vector<std::string> lines_of(const std::string& text);

// Three boxes of different sizes joined to one part of 0.16 m.
Mesh unsymmetric_part();

// <folder>/{models, camera.json, test/000007/...} below a fresh folder of the running test's name.
class TinyScene {
  public:
    explicit TinyScene(int num_frames = 3);

    const std::filesystem::path& folder() const { return folder_; }
    std::filesystem::path scene() const { return folder_ / "test/000007"; }
    std::filesystem::path models() const { return folder_ / "models"; }
    std::filesystem::path file(const std::string& name) const { return folder_ / name; }
    const PinholeCamera& camera() const { return camera_; }
    const std::vector<Pose>& truth() const { return truth_; }  // camera_from_object, by frame

    // --scene, --models, --object and few particles.
    std::string input_from_nothing() const;
    // The same, started at the true pose of frame 0: four times as fast.
    std::string input() const;

  private:
    std::filesystem::path folder_;
    PinholeCamera camera_;
    std::vector<Pose> truth_;
};

}  // namespace nearpose::program_tests
