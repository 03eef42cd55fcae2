#include "tests/apps/support/tiny_scene.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/bop_writer.hpp"
#include "raycast/depth_renderer.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose::program_tests {
namespace {

void add_box(Mesh& mesh, const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
    const int first = static_cast<int>(mesh.vertices_in_object.size());
    for (int i = 0; i < 8; ++i) {
        mesh.vertices_in_object.emplace_back((i & 1 ? high : low).x(), (i & 2 ? high : low).y(),
                                             (i & 4 ? high : low).z());
    }
    constexpr int kSides[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    for (const auto& side : kSides) {
        mesh.triangles.push_back({first + side[0], first + side[1], first + side[2]});
        mesh.triangles.push_back({first + side[0], first + side[2], first + side[3]});
    }
}

std::filesystem::path fresh_folder() {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("program_") + test->test_suite_name() + "_" + test->name();
    std::replace(name.begin(), name.end(), '/', '_');
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / name;
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder;
}

Mask mask_of(const DepthImage& depth) {
    Mask mask{depth.width, depth.height, {}};
    for (const float value_m : depth.depth_m) mask.value.push_back(value_m > 0.0F ? 255 : 0);
    return mask;
}

// The camera moves a little sideways and turns from frame to frame.
Pose camera_from_world(int frame) {
    Twist motion;
    motion << 0.0, 0.015, 0.01, 0.002, -0.001, -0.003;
    return exp(Twist(frame * motion));
}

}  // namespace

Outcome run_shell(const std::string& command) {
    const std::filesystem::path folder = testing::TempDir();
    const std::string base = (folder / ("program_run_" + std::to_string(getpid()))).string();
    write_text(base + ".sh", "NEARPOSE='" NEARPOSE_PROGRAM "'\n" + command + "\n");
    const int status = std::system(("exec bash " + base + ".sh >" + base + ".out 2>" + base + ".err").c_str());
    Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(base + ".out"), read_text(base + ".err")};
    for (const char* ending : {".sh", ".out", ".err"}) std::filesystem::remove(base + ending);
    return outcome;
}

Outcome run_nearpose(const std::string& arguments) {
    return run_shell("\"$NEARPOSE\" " + arguments);
}

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

void write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file << text;
    ASSERT_TRUE(file.flush().good()) << path;
}

void write_pose(const std::filesystem::path& path, const Pose& camera_from_object) {
    nlohmann::json json;
    const Eigen::Matrix3d rotation = camera_from_object.rotation_matrix();
    for (int i = 0; i < 9; ++i) json["R"].push_back(rotation(i / 3, i % 3));
    for (int i = 0; i < 3; ++i) json["t"].push_back(1e3 * camera_from_object.translation[i]);
    write_text(path, json.dump());
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

Mesh unsymmetric_part() {
    Mesh mesh;
    add_box(mesh, {0.0F, 0.0F, 0.0F}, {0.16F, 0.06F, 0.04F});
    add_box(mesh, {0.0F, 0.06F, 0.0F}, {0.05F, 0.12F, 0.04F});
    add_box(mesh, {0.10F, 0.0F, 0.04F}, {0.14F, 0.04F, 0.08F});
    return mesh;
}

TinyScene::TinyScene(int num_frames) : folder_(fresh_folder()), camera_{160, 120, 150.0, 150.0, 79.5, 59.5} {
    const Mesh mesh = unsymmetric_part();
    std::filesystem::create_directories(models());
    save_ply(mesh, models() / "obj_000001.ply", LengthUnit::kMillimetre);
    const EmbreeScene scene(mesh);
    data_set::ModelInfo info;
    info.diameter_m = scene.extent().diameter_m();
    info.box_min_in_object_m = scene.extent().box_min_in_object;
    info.box_max_in_object_m = scene.extent().box_max_in_object;
    data_set::write_models_info(models() / "models_info.json", {{1, info}});

    // Seen from above and aside, its centre 0.38 m in front of the camera.
    const Eigen::Quaterniond rotation(Eigen::AngleAxisd(2.4, Eigen::Vector3d(1.0, 0.25, 0.15).normalized()));
    const Eigen::Vector3d centre = scene.extent().centre_in_object();
    const Pose world_from_object{rotation, Eigen::Vector3d(-0.01, 0.005, 0.38) - rotation * centre};
    data_set::BopSceneWriter writer(this->scene());
    for (int frame = 0; frame < num_frames; ++frame) {
        const Pose camera_from_object = camera_from_world(frame) * world_from_object;
        truth_.push_back(camera_from_object);
        const DepthImage depth = render_depth(scene, camera_from_object, camera_);
        data_set::FrameRecord record;
        record.id = frame;
        record.camera = camera_;
        record.depth_scale_mm = 0.1;
        record.camera_from_world = camera_from_world(frame);
        record.objects.push_back({});
        record.objects.back().object_id = 1;
        record.objects.back().camera_from_object = camera_from_object;
        writer.add_frame(record, depth, {mask_of(depth)}, {mask_of(depth)});
    }
    writer.finish();
    write_pose(file("start.json"), truth_.front());
}

std::string TinyScene::input() const {
    return input_from_nothing() + "--initial-pose " + file("start.json").string() + " ";
}

std::string TinyScene::input_from_nothing() const {
    return "--scene " + scene().string() + " --models " + models().string() + " --object 1 --particles 24 --threads 1 ";
}

}  // namespace nearpose::program_tests
