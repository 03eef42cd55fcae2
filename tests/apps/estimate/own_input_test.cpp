// What a user brings: models in another unit or as a dense cloud, clouds instead of images, another locale.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "apps/data_set/png_file.hpp"
#include "apps/data_set/result_csv.hpp"
#include "raycast/mesh_loader.hpp"
#include "tests/apps/support/contains.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

namespace fs = std::filesystem;

void expect_near_truth(const TinyScene& scene, const fs::path& csv, int num_frames, double tolerance_m,
                       double tolerance_rad) {
    const std::vector<data_set::PoseRow> rows = data_set::read_pose_csv(csv);
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(num_frames));
    for (const data_set::PoseRow& row : rows) {
        const Pose& truth = scene.truth()[row.image_id];
        EXPECT_LT((row.camera_from_object.translation - truth.translation).norm(), tolerance_m) << row.image_id;
        EXPECT_LT(angle_between(row.camera_from_object.rotation, truth.rotation), tolerance_rad) << row.image_id;
        EXPECT_GT(row.score, 0.0);
    }
}

// A cloud of the part alone: the scene has nothing else.
std::vector<Eigen::Vector3f> measured_points(const TinyScene& scene, int frame) {
    const DepthImage depth =
        data_set::read_depth_png(scene.scene() / ("depth/00000" + std::to_string(frame) + ".png"), 0.1);
    std::vector<Eigen::Vector3f> points;
    for (int pixel = 0; pixel < depth.width * depth.height; ++pixel) {
        if (!(depth.depth_m[pixel] > 0.0F)) continue;
        const Eigen::Vector3d ray = scene.camera().ray(pixel % depth.width, pixel / depth.width);
        points.push_back((depth.depth_m[pixel] * ray).cast<float>());
    }
    return points;
}

std::string bytes_of(const std::vector<Eigen::Vector3f>& points) {
    std::string bytes(points.size() * 3 * sizeof(float), '\0');
    std::memcpy(bytes.data(), points.data(), bytes.size());
    return bytes;
}

std::string pcd(const std::vector<Eigen::Vector3f>& points) {
    const std::string n = std::to_string(points.size());
    return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + n +
           "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA binary\n" + bytes_of(points);
}

std::string ply(const std::vector<Eigen::Vector3f>& points) {
    return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points.size()) +
           "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + bytes_of(points);
}

// The part's surface as points [mm], 2 mm apart, without normals.
std::vector<Eigen::Vector3f> dense_cloud_mm() {
    const Mesh mesh = unsymmetric_part();
    std::vector<Eigen::Vector3f> points;
    for (const auto& corners : mesh.triangles) {
        const Eigen::Vector3f a = mesh.vertices_in_object[corners[0]];
        const Eigen::Vector3f u = mesh.vertices_in_object[corners[1]] - a;
        const Eigen::Vector3f v = mesh.vertices_in_object[corners[2]] - a;
        const int steps_u = static_cast<int>(std::ceil(u.norm() / 0.002F));
        const int steps_v = static_cast<int>(std::ceil(v.norm() / 0.002F));
        for (int i = 0; i < steps_u; ++i) {
            for (int j = 0; j < steps_v; ++j) {
                const float s = (static_cast<float>(i) + 0.5F) / static_cast<float>(steps_u);
                const float t = (static_cast<float>(j) + 0.5F) / static_cast<float>(steps_v);
                if (s + t <= 1.0F) points.emplace_back(1000.0F * (a + s * u + t * v));
            }
        }
    }
    return points;
}

TEST(OwnInput, CloudsGiveTheTruePose) {
    const TinyScene scene(2);
    fs::create_directories(scene.file("clouds"));
    write_text(scene.file("clouds/cloud_0.pcd"), pcd(measured_points(scene, 0)));
    write_text(scene.file("clouds/cloud_1.ply"), ply(measured_points(scene, 1)));
    for (const char* mask : {"", " --no-mask"}) {
        const Outcome outcome = run_nearpose(
            "estimate --clouds " + scene.file("clouds").string() + " --camera " + scene.file("camera.json").string() +
            " --model " + (scene.models() / "obj_000001.ply").string() + " --unit mm --particles 24 --out " +
            scene.file("poses.csv").string() + " --initial-pose " + scene.file("start.json").string() + mask);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        expect_near_truth(scene, scene.file("poses.csv"), 2, 0.002, 0.02);
    }
}

TEST(OwnInput, ADenseCloudIsAModel) {
    const TinyScene scene(2);
    write_text(scene.file("part.ply"), ply(dense_cloud_mm()));
    const Outcome outcome =
        run_nearpose("estimate --scene " + scene.scene().string() + " --model " + scene.file("part.ply").string() +
                     " --unit mm --particles 24 --out " + scene.file("poses.csv").string() + " --initial-pose " +
                     scene.file("start.json").string());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    expect_near_truth(scene, scene.file("poses.csv"), 2, 0.004, 0.03);
}

TEST(OwnInput, AModelInAnotherUnitIsRefusedWithTheLikelyOne) {
    const TinyScene scene(1);
    save_ply(unsymmetric_part(), scene.file("metres.ply"), LengthUnit::kMetre);
    const std::string millimetres = (scene.models() / "obj_000001.ply").string();
    const std::string out = scene.file("poses.csv").string();
    for (const auto& [model, cure] : {std::pair(millimetres + " --unit m", "--unit mm"),
                                      std::pair(scene.file("metres.ply").string() + " --unit mm", "--unit m")}) {
        const Outcome outcome =
            run_nearpose("estimate --scene " + scene.scene().string() + " --model " + model + " --out " + out);
        EXPECT_EQ(outcome.exit_code, 1);
        EXPECT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
        EXPECT_TRUE(contains(outcome.err, ".ply: ") && contains(outcome.err, cure)) << outcome.err;
        const Outcome import = run_nearpose("import --model " + model + " --out " + scene.file("imported").string());
        EXPECT_EQ(import.exit_code, 1);
        EXPECT_TRUE(contains(import.err, cure)) << import.err;
    }
    EXPECT_FALSE(fs::exists(out));
    EXPECT_FALSE(fs::exists(scene.file("imported/obj_000001.ply")));
}

// Started far out of view, it never comes into view: a failure, though a prediction stood in for every frame.
TEST(OwnInput, AnObjectSeenInNoFrameIsAFailure) {
    const TinyScene scene(1);  // in a second frame it would be searched for and found
    write_pose(scene.file("start.json"), {Eigen::Quaterniond::Identity(), {0.0, 0.0, 90.0}});
    const Outcome outcome = run_nearpose("estimate " + scene.input() + "--out " + scene.file("poses.csv").string());
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_TRUE(contains(outcome.err, "seen in none of the 1 frames")) << outcome.err;
}

TEST(OwnInput, ADepthScaleFarOffIsNamed) {
    const TinyScene scene(2);
    const fs::path file = scene.scene() / "scene_camera.json";
    std::string text = read_text(file);
    const std::string key = "\"depth_scale\": 0.1";
    for (std::size_t at = text.find(key); at != text.npos; at = text.find(key)) {
        text.replace(at, key.size(), "\"depth_scale\": 1000");
    }
    write_text(file, text);
    const Outcome outcome = run_nearpose("estimate " + scene.input() + "--out -");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_TRUE(contains(outcome.err, "is the depth's scale right?")) << outcome.err;
}

// Where the machine lacks the locale the C locale takes its place, and the test holds as well.
TEST(OwnInput, ADecimalCommaInTheLocaleChangesNothing) {
    const TinyScene scene(1);
    const auto row = [&](const std::string& locale) {
        const Outcome outcome = run_shell("export LC_ALL=" + locale + "\n\"$NEARPOSE\" estimate " + scene.input() +
                                          "--fps 29.5 --out - --log " + scene.file(locale + ".jsonl").string());
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        return outcome.out.substr(0, outcome.out.rfind(','));  // without the time
    };
    const std::string expected = row("C");
    EXPECT_EQ(lines_of(expected).size(), 2U);
    EXPECT_EQ(row("de_DE.UTF-8"), expected);
}

}  // namespace
}  // namespace nearpose::program_tests
