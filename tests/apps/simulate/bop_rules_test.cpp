// What bop_toolkit requires of a data set, asked of the files themselves and not of our own readers.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/simulate/simulate.hpp"
#include "raycast/depth_renderer.hpp"

namespace nearpose::simulate {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json read(const fs::path& path) {
    std::ifstream file(path);
    return json::parse(file);
}

std::set<std::string> keys_of(const json& object) {
    std::set<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.insert(key);
    return keys;
}

std::string header_of(const fs::path& ply) {
    std::ifstream file(ply, std::ios::binary);
    std::string header, line;
    while (std::getline(file, line) && line != "end_header") header += line + "\n";
    return header;
}

// A clutter scene of the flange, with a lost frame and a wrong mask, written once.
class BopRules : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        // Of this process: the suite's tests may run side by side.
        folder_ = fs::path(testing::TempDir()) / ("bop_rules_test_" + std::to_string(getpid()));
        options_.data_set = folder_ / "set";
        options_.recording.scenario = Scenario::kClutter;
        options_.recording.num_frames = 5;
        options_.recording.dropped_fraction = 0.2;
        options_.recording.mask.grow_pixels = 1;
        options_.recording.part_name = "flange";
        options_.recording.camera = {160, 120, 150.0, 150.0, 79.5, 59.5};
        const EmbeddedPart part = embedded_part("flange");
        write_data_set(part.mesh, part.part, options_, [] { return true; });
    }
    static void TearDownTestSuite() { fs::remove_all(folder_); }
    static fs::path set() { return folder_ / "set"; }
    static fs::path scene() { return set() / "test/000001"; }

    static inline fs::path folder_;
    static inline SimulationOptions options_;
};

TEST_F(BopRules, CameraFile) {
    const json camera = read(set() / "camera.json");
    EXPECT_EQ(keys_of(camera), (std::set<std::string>{"cx", "cy", "fx", "fy", "width", "height", "depth_scale"}));
    EXPECT_TRUE(camera["width"].is_number_integer() && camera["height"].is_number_integer());
    EXPECT_EQ(camera["depth_scale"], 0.1);
}

TEST_F(BopRules, SceneFilesSpeakOfTheSameFramesAndObjects) {
    const json cameras = read(scene() / "scene_camera.json"), truth = read(scene() / "scene_gt.json"),
               info = read(scene() / "scene_gt_info.json");
    EXPECT_EQ(keys_of(cameras).size(), 4u);  // one was lost
    EXPECT_EQ(keys_of(cameras), keys_of(truth));
    EXPECT_EQ(keys_of(cameras), keys_of(info));
    for (const auto& [id, camera] : cameras.items()) {
        EXPECT_EQ(std::to_string(std::stoi(id)), id);
        EXPECT_EQ(camera["cam_K"], (json{150.0, 0.0, 79.5, 0.0, 150.0, 59.5, 0.0, 0.0, 1.0}));  // row-major
        EXPECT_EQ(camera["depth_scale"], 0.1);
        EXPECT_NEAR(camera["timestamp"].get<double>(), std::stoi(id) / 30.0, 1e-9);
        EXPECT_EQ(camera["cam_R_w2c"].size(), 9u);
        EXPECT_EQ(camera["cam_t_w2c"].size(), 3u);
        ASSERT_EQ(truth[id].size(), 2u);
        ASSERT_EQ(info[id].size(), 2u);
        EXPECT_EQ(truth[id][0]["obj_id"], 2);
        EXPECT_TRUE(truth[id][1]["obj_id"].is_number_integer());
        EXPECT_NE(truth[id][1]["obj_id"], 2);
        for (const json& object : truth[id]) {
            EXPECT_EQ(keys_of(object), (std::set<std::string>{"cam_R_m2c", "cam_t_m2c", "obj_id"}));
        }
        for (const json& object : info[id]) {
            EXPECT_EQ(keys_of(object), (std::set<std::string>{"bbox_obj", "bbox_visib", "px_count_all",
                                                              "px_count_valid", "px_count_visib", "visib_fract"}));
            for (const char* count : {"px_count_all", "px_count_valid", "px_count_visib"}) {
                EXPECT_TRUE(object[count].is_number_integer());
            }
            const double all = object["px_count_all"], visible = object["px_count_visib"];
            EXPECT_NEAR(object["visib_fract"].get<double>(), all > 0 ? visible / all : 0.0, 1e-12);
        }
    }
}

TEST_F(BopRules, RotationsAreRowMajorAndMillimetresAndFitTheMasks) {
    const json truth = read(scene() / "scene_gt.json"), info = read(scene() / "scene_gt_info.json");
    for (const auto& [id, objects] : truth.items()) {
        for (std::size_t k = 0; k < objects.size(); ++k) {
            const json& R = objects[k]["cam_R_m2c"];
            const json& t = objects[k]["cam_t_m2c"];
            Eigen::Matrix3d rotation;
            for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = R[static_cast<std::size_t>(i)];
            const Pose pose = Pose::from_matrix(rotation, 1e-3 * Eigen::Vector3d(t[0], t[1], t[2]));
            const std::string& name = part_names()[objects[k]["obj_id"].get<std::size_t>() - 1];
            const DepthImage depth =
                render_depth(EmbreeScene(embedded_part(name).mesh), pose, options_.recording.camera);
            const int frame = std::stoi(id), instance = static_cast<int>(k);
            const Mask whole = data_set::read_mask_png(data_set::mask_path(scene(), frame, instance, false), 160, 120);
            const Mask seen = data_set::read_mask_png(data_set::mask_path(scene(), frame, instance, true), 160, 120);
            int differ = 0, visible = 0;
            for (std::size_t i = 0; i < whole.value.size(); ++i) {
                differ += (whole.value[i] != 0) != (depth.depth_m[i] > 0.0F) ? 1 : 0;
                visible += seen.value[i] != 0 ? 1 : 0;
            }
            EXPECT_LE(differ, 2);
            // Counts are exact; the tracked part's mask is the given one, which was grown.
            const int counted = info[id][k]["px_count_visib"];
            EXPECT_EQ(visible > counted, k == 0);
            EXPECT_GE(visible, counted);
            EXPECT_EQ(data_set::read_count_png(data_set::depth_path(scene(), frame)).width, 160);
        }
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(scene() / "mask"), {}), 8);
    EXPECT_EQ(std::distance(fs::directory_iterator(scene() / "mask_visib"), {}), 8);
    EXPECT_EQ(std::distance(fs::directory_iterator(scene() / "depth"), {}), 4);
}

TEST_F(BopRules, TargetsCountTheInstances) {
    const json targets = read(set() / "test_targets_bop19.json"), truth = read(scene() / "scene_gt.json");
    std::map<std::string, int> asked;
    for (const json& target : targets) {
        EXPECT_EQ(keys_of(target), (std::set<std::string>{"im_id", "inst_count", "obj_id", "scene_id"}));
        EXPECT_EQ(target["scene_id"], 1);
        EXPECT_EQ(target["inst_count"], 1);
        const std::string id = std::to_string(target["im_id"].get<int>());
        ASSERT_TRUE(truth.contains(id));
        asked[id] += target["obj_id"] == 2 ? 1 : 0;
    }
    EXPECT_EQ(asked.size(), truth.size());
    for (const auto& [id, count] : asked) EXPECT_EQ(count, 1);
}

TEST_F(BopRules, AllThreeModelsAreThere) {
    for (const char* folder : {"models", "models_eval"}) {
        const json models = read(set() / folder / "models_info.json");
        EXPECT_EQ(keys_of(models), (std::set<std::string>{"1", "2", "3"}));
        for (const auto& [id, model] : models.items()) {
            const std::string ply = header_of(set() / folder / ("obj_00000" + id + ".ply"));
            std::istringstream words(ply);
            std::string word, element;
            while (words >> word) {
                if (word == "element") words >> element;
                if (word == "property") {
                    words >> word;
                    if (word == "list") {
                        EXPECT_EQ(element, "face");
                        words >> word;
                        EXPECT_EQ(word, "uchar");
                        words >> word;
                        EXPECT_EQ(word, "int");
                    } else {
                        EXPECT_EQ(word, "float");
                    }
                } else if (word == "vertex") {
                    int vertices = 0;
                    words >> vertices;
                    EXPECT_LT(vertices, 10000);  // bop_toolkit walks through them one by one
                }
            }
            EXPECT_NE(ply.find("element face"), std::string::npos);
            for (const char* key : {"diameter", "min_x", "min_y", "min_z", "size_x", "size_y", "size_z"}) {
                EXPECT_TRUE(model[key].is_number()) << key;
            }
            EXPECT_GE(model["diameter"].get<double>(), model["size_x"].get<double>() - 1e-6);  // mm
        }
    }
}

TEST_F(BopRules, TruthIsOfTheTrackedPart) {
    std::ifstream file(set() / "truth.tum");
    const json truth = read(scene() / "scene_gt.json");
    std::map<int, json> by_id;
    for (const auto& [id, objects] : truth.items()) by_id[std::stoi(id)] = objects[0];
    for (const auto& [id, object] : by_id) {
        double stamp_s, x, y, z, qx, qy, qz, qw;
        ASSERT_TRUE(file >> stamp_s >> x >> y >> z >> qx >> qy >> qz >> qw);
        EXPECT_NEAR(stamp_s, id / 30.0, 1e-8);
        EXPECT_NEAR(1e3 * z, object["cam_t_m2c"][2].get<double>(), 1e-5);
        EXPECT_NEAR(Eigen::Quaterniond(qw, qx, qy, qz).toRotationMatrix()(0, 1), object["cam_R_m2c"][1].get<double>(),
                    1e-7);
    }
    EXPECT_FALSE(file >> std::ws && !file.eof());
}

}  // namespace
}  // namespace nearpose::simulate
