#include "tests/faults/command_cases.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "apps/data_set/camera_json.hpp"

namespace nearpose::program_tests {
namespace {

namespace fs = std::filesystem;

// No figure depends on the time.
constexpr const char* kExperiment = R"({"format": 1, "name": "tiny", "tables": [
  {"name": "runs", "columns": ["translation_mean"],
   "with": {"part": "bracket", "frames": 2, "image_scale": 16, "particles": 4, "method": "paper", "burn_in": 1},
   "rows": [{"scenario": ["baseline", "sweep"]}], "seeds": 1,
   "curves": [{"x": "distance", "y": "translation", "bins": 5, "low": 1, "high": 1000}]}]})";

void make_recording(const TinyScene& scene) {
    fs::create_directories(scene.file("raw"));
    for (const char* stamp : {"1.5", "2.5", "3.5"})
        write_text(scene.file("raw") / ("part_Depth_" + std::string(stamp) + ".raw"), std::string(2 * 96 * 72, '\3'));
    data_set::write_camera_json(scene.file("raw_camera.json"), {96, 72, 90.0, 90.0, 47.5, 35.5}, 0.1);
}

bool grows(const std::string& path) {
    for (const char* ending : {"poses.csv", ".jsonl", ".tum"})
        if (path.ends_with(ending)) return true;
    return false;
}

// Times differ from run to run.
std::string without_times(const std::string& path, const std::string& text) {
    static const std::regex last_column(",[^,\n]*\n"), time_of_cell("\"time\": \\{[^}]*\\}"),
        seconds("\"(seconds|seconds_summed_over_threads)\": ?\\{[^}]*\\}"), time_s("\"[a-z_]*time_s\": ?[-0-9.e]+");
    if (path.ends_with("poses.csv")) return std::regex_replace(text, last_column, "\n");
    if (path.ends_with("cell.json")) return std::regex_replace(text, time_of_cell, "");
    if (path.ends_with("log.jsonl")) return std::regex_replace(std::regex_replace(text, seconds, ""), time_s, "");
    return text;
}

}  // namespace

std::vector<CommandCase> command_cases(const TinyScene& scene) {
    make_recording(scene);
    write_text(scene.file("tiny.json"), kExperiment);
    const std::string camera = scene.file("raw_camera.json").string();
    const std::string model = (scene.models() / "obj_000001.ply").string();
    const fs::path outputs = scene.file("outputs");
    return {
        {"estimate", "estimate --quiet " + scene.input(), "--run", outputs / "run", true},
        {"experiment", "experiment --quiet --threads 1 " + scene.file("tiny.json").string(), "--out",
         outputs / "experiment", true},
        {"simulate",
         "simulate --quiet --threads 2 --frames 2 --no-symmetries --unit mm --model " + model + " --camera " + camera,
         "--out", outputs / "set", true},
        {"import_recording",
         "import --quiet --realsense-raw " + scene.file("raw").string() + " --depth-unit-m 0.001 --camera " + camera,
         "--out", outputs / "recording/test/000001", false},
        {"import_model", "import --quiet --no-symmetries --unit mm --model " + model, "--out", outputs / "models",
         false}};
}

std::string line_of(const CommandCase& command, const std::string& before) {
    return before + " \"$NEARPOSE\" " + command.arguments + " " + command.output + " " + command.out.string();
}

Files files_below(const fs::path& folder) {
    Files files;
    std::error_code not_there;
    for (const auto& entry : fs::recursive_directory_iterator(folder, not_there)) {
        const std::string path = fs::relative(entry.path(), folder).string();
        if (entry.is_regular_file()) files[path] = without_times(path, read_text(entry.path()));
    }
    return files;
}

bool is_temporary(const std::string& path) {
    static const std::regex names("(.*/)?[^/]*\\.(part|tmp)[0-9]+|\\.[^/]*\\.(new|old)-[A-Za-z0-9]{6}/.*");
    return std::regex_match(path, names);
}

void expect_whole(const Files& left, const Files& expected, bool temporaries, const std::string& what) {
    for (const auto& [path, text] : left) {
        if (is_temporary(path)) {
            EXPECT_TRUE(temporaries) << what << " left " << path;
            continue;
        }
        const auto found = expected.find(path);
        ASSERT_TRUE(found != expected.end()) << what << " left " << path;
        if (text == found->second) continue;
        EXPECT_TRUE(grows(path)) << what << ": " << path << " is not whole";
        EXPECT_TRUE(found->second.starts_with(text)) << what << ": " << path << " has other rows:\n" << text;
        EXPECT_TRUE(text.empty() || text.back() == '\n') << what << ": the last row of " << path << " is cut";
    }
}

}  // namespace nearpose::program_tests
