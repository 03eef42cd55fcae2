// simulate, run as a user would.
#include <gtest/gtest.h>

#include <filesystem>

#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/camera_json.hpp"
#include "apps/data_set/json_file.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/depth_sensor/stereo_matcher.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

namespace fs = std::filesystem;

fs::path fresh_folder(const std::string& name) {
    const fs::path folder = fs::path(testing::TempDir()) / "nearpose_simulate_program" / name;
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

TEST(SimulateCommand, BadCombinationsAreBadUse) {
    const fs::path folder = fresh_folder("bad");
    const std::string out = " --out " + (folder / "set").string();
    struct Case {
        const char *options, *told;
    };
    for (const Case& bad :
         {Case{"--scenario piston --occlusion 0.3", "--scenario clutter"},
          Case{"--scenario baseline --conveyor-mm 3", "--scenario conveyor"},
          Case{"--conveyor-deg 0.5", "--scenario conveyor"}, Case{"--trajectory /dev/null", "--trajectory"},
          Case{"--scenario handhold", "handheld"}, Case{"--part gearbox", "flange"}, Case{"--unit mm", "--model"},
          Case{"--drop-frames 1", "--drop-frames"}, Case{"--scenario clutter --occlusion 0.9", "--occlusion"},
          Case{"--fault frozne@all", "rotated:DEGREES (the camera is mounted turned"},
          Case{"--fault frozen@all --fault holes:2@all", "holes:SHARE"},
          Case{"--frames 40 --fault frozen@10-40", "0 to 39"}, Case{"--fault dropped@all", "leaves no frame"}}) {
        const Outcome outcome = run_nearpose("simulate " + std::string(bad.options) + out);
        EXPECT_EQ(outcome.exit_code, 2) << bad.options << outcome.err;
        EXPECT_NE(outcome.err.find(bad.told), std::string::npos) << outcome.err;
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 0);
}

TEST(SimulateCommand, SensorSetsTheCameraUnlessOneIsNamed) {
    const fs::path folder = fresh_folder("sensor");
    const std::string command = "simulate --quiet --frames 1 --noise-scale 0 --part bracket --sensor d435 --out ";
    const Outcome outcome = run_nearpose(command + (folder / "own").string());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const data_set::CameraFile own = data_set::read_camera_json(folder / "own/camera.json");
    EXPECT_EQ(own.depth_scale_mm, 1.0);
    EXPECT_NE(own.camera.fx, 600.0);
    data_set::write_camera_json(folder / "camera.json", {96, 72, 90.0, 90.0, 47.5, 35.5}, 0.5);
    const Outcome named =
        run_nearpose(command + (folder / "named").string() + " --camera " + (folder / "camera.json").string());
    ASSERT_EQ(named.exit_code, 0) << named.err;
    EXPECT_EQ(data_set::read_camera_json(folder / "named/camera.json").camera.width, 96);
    EXPECT_EQ(data_set::read_camera_json(folder / "named/camera.json").depth_scale_mm, 0.5);
    const data_set::JsonFile truth(folder / "named/test/000001/scene_gt.json");
    EXPECT_EQ(truth.root().at("0").elements().at(0).at("obj_id").integer(), 3);
}

TEST(SimulateCommand, InfraredImagesAreOfSensorsThatMatchThem) {
    const fs::path folder = fresh_folder("infrared");
    data_set::write_camera_json(folder / "camera.json", {96, 72, 90.0, 90.0, 47.5, 35.5}, 0.1);
    const std::string command = "simulate --quiet --frames 1 --part bracket --camera " +
                                (folder / "camera.json").string() + " --out " + (folder / "set").string();
    for (const char* option : {" --save-infrared", " --material plastic"}) {
        const Outcome noise = run_nearpose(command + " --sensor d435" + option);
        EXPECT_EQ(noise.exit_code, 2);
        EXPECT_NE(noise.err.find("stereo_d435"), std::string::npos) << noise.err;
    }
    const Outcome stereo = run_nearpose(command + " --sensor stereo_d435 --material plastic --save-infrared");
    if (!simulate::stereo_is_built()) {
        EXPECT_NE(stereo.exit_code, 0);
        EXPECT_NE(stereo.err.find("install_packages.sh stereo"), std::string::npos) << stereo.err;
        return;
    }
    ASSERT_EQ(stereo.exit_code, 0) << stereo.err;
    for (const char* name : {"depth", "infrared_left", "infrared_right"})
        EXPECT_EQ(data_set::read_png_size(folder / "set/test/000001" / name / "000000.png").width, 96) << name;
    // The pattern is known beyond the image, by the largest disparity: 90 pixels * 0.075 m / 0.35 m.
    const Outcome light = run_nearpose(command + " --force --sensor structured_carmine --save-infrared");
    ASSERT_EQ(light.exit_code, 0) << light.err;
    EXPECT_EQ(data_set::read_png_size(folder / "set/test/000001/depth/000000.png").width, 96);
    EXPECT_EQ(data_set::read_png_size(folder / "set/test/000001/infrared_right/000000.png").width, 96 + 20);
}

TEST(SimulateCommand, WritesWhatASetUpWithTheFaultsWouldAndTheTruthAsItIs) {
    const fs::path folder = fresh_folder("faults");
    data_set::write_camera_json(folder / "camera.json", {96, 72, 90.0, 90.0, 47.5, 35.5}, 0.1);
    const std::string command = "simulate --quiet --frames 5 --part bracket --no-symmetries --camera " +
                                (folder / "camera.json").string() + " --out ";
    ASSERT_EQ(run_nearpose(command + (folder / "plain").string()).exit_code, 0);
    const Outcome faulty = run_nearpose(command + (folder / "faulty").string() +
                                        " --fault frozen@2-3 --fault focal:10@all --fault temporal-filter:0.4@4");
    ASSERT_EQ(faulty.exit_code, 0) << faulty.err;
    const auto text = [&](const char* set, const std::string& file) {
        return read_text(folder / set / "test/000001" / file);
    };
    for (const char* same : {"scene_gt.json", "scene_gt_info.json", "depth/000001.png", "mask/000003_000000.png"})
        EXPECT_EQ(text("plain", same), text("faulty", same)) << same;
    for (const char* frozen : {"depth/000002.png", "depth/000003.png"})
        EXPECT_EQ(text("faulty", frozen), text("plain", "depth/000001.png"));
    EXPECT_EQ(text("faulty", "depth/000004.png"), text("plain", "depth/000004.png"));  // nothing to mix it with
    const data_set::JsonFile cameras(folder / "faulty/test/000001/scene_camera.json");
    EXPECT_DOUBLE_EQ(cameras.root().at("3").at("cam_K").elements().at(0).number(), 99.0);
    EXPECT_DOUBLE_EQ(data_set::read_camera_json(folder / "faulty/camera.json").camera.fx, 99.0);
    const Outcome help = run_nearpose("help simulate");
    for (const char* name : {"--fault", "temporal-filter:ALPHA", "arm-transposed", "the truth follows"})
        EXPECT_NE(help.out.find(name), std::string::npos) << name;
}

// A square column: four turns about its axis and half turns about axes across.
TEST(SimulateCommand, WritesTheSymmetriesThatItFindsUnlessToldNotTo) {
    const fs::path folder = fresh_folder("symmetries");
    std::string obj;
    for (int i = 0; i < 8; ++i) {
        const auto corner = [&](int bit, int size) { return std::to_string((i >> bit & 1) * size) + " "; };
        obj += "v " + corner(0, 60) + corner(1, 60) + corner(2, 110) + "\n";
    }
    for (const char* face : {"1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"}) {
        obj += "f " + std::string(face) + "\n";
    }
    write_text(folder / "column.obj", obj);
    data_set::write_camera_json(folder / "camera.json", {96, 72, 90.0, 90.0, 47.5, 35.5}, 0.1);
    const std::string common =
        "simulate --frames 2 --scenario baseline --camera " + (folder / "camera.json").string() + " ";
    const std::string column = common + "--model " + (folder / "column.obj").string() + " --unit mm --out ";
    const Outcome found = run_nearpose(column + (folder / "found").string());
    ASSERT_EQ(found.exit_code, 0) << found.err;
    EXPECT_NE(found.err.find("4-fold about z"), std::string::npos) << found.err;
    EXPECT_TRUE(found.out.empty()) << found.out;
    for (const char* name : {"models", "models_eval"}) {
        const data_set::ModelInfo info = data_set::read_model_info(folder / "found" / name, 1);
        EXPECT_EQ(info.discrete_symmetries.size(), 7U) << name;
        EXPECT_TRUE(info.continuous_symmetries.empty());
    }
    const Outcome imported = run_nearpose("import --model " + (folder / "column.obj").string() + " --unit mm --out " +
                                          (folder / "imported").string());
    ASSERT_EQ(imported.exit_code, 0) << imported.err;
    EXPECT_EQ(read_text(folder / "imported/models_info.json"), read_text(folder / "found/models/models_info.json"));

    const Outcome none = run_nearpose(column + (folder / "none").string() + " --no-symmetries");
    ASSERT_EQ(none.exit_code, 0) << none.err;
    EXPECT_EQ(none.err.find("symmetries"), std::string::npos) << none.err;
    EXPECT_TRUE(data_set::read_model_info(folder / "none/models", 1).discrete_symmetries.empty());
    const Outcome flange = run_nearpose(common + "--part flange --out " + (folder / "flange").string());
    EXPECT_NE(flange.err.find("none; nearly the same after 60, 120"), std::string::npos) << flange.err;
}

TEST(SimulateCommand, TakesACameraPathOfFourDigits) {
    const fs::path folder = fresh_folder("hand");
    data_set::write_camera_json(folder / "camera.json", {96, 72, 90.0, 90.0, 47.5, 35.5}, 0.1);
    std::string rows = "# timestamp tx ty tz qx qy qz qw\n";
    for (int i = 0; i < 5; ++i) {
        const std::string number = std::to_string(i);
        rows.append(number).append(".0 1.3405 0.6266 1.657").append(number).append(" 0.6574 0.6126 -0.2949 -0.3248\n");
    }
    write_text(folder / "hand.tum", rows);
    const std::string command = "simulate --quiet --scenario handheld --fps 2 --camera " +
                                (folder / "camera.json").string() + " --out " + (folder / "set").string() +
                                " --trajectory " + (folder / "hand.tum").string();
    const Outcome good = run_nearpose(command + " --frames 4");
    EXPECT_EQ(good.exit_code, 0) << good.err;
    const Outcome too_long = run_nearpose(command + " --force --frames 40");
    EXPECT_EQ(too_long.exit_code, 1);
    EXPECT_NE(too_long.err.find("the trajectory lasts 4 s"), std::string::npos) << too_long.err;
    write_text(folder / "hand.tum", rows + "9 9\n");
    const Outcome broken = run_nearpose(command + " --force --frames 4");
    EXPECT_EQ(broken.exit_code, 1);
    EXPECT_NE(broken.err.find("hand.tum: line 7"), std::string::npos) << broken.err;
}

}  // namespace
}  // namespace nearpose::program_tests
