// What each task promises of its path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apps/scenes/scene.hpp"
#include "apps/scenes/surface_points.hpp"
#include "core/base/random.hpp"
#include "tests/apps/scenes/small_recording.hpp"

namespace nearpose::simulate {
namespace {

TEST(Sweep, GoesStraightFromSixtyToTenCentimetresOverASurfacePoint) {
    Part part = block().part;
    part.surface_points_in_object_m = surface_points_from_above(block().mesh);
    const EmbreeScene scene(block().mesh);
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const std::vector<Pose> path = task_path(Scenario::kSweep, part, kCamera, 11, seed).camera_from_object;
        PinholeCamera axis = kCamera;
        axis.cx = 80.0;
        axis.cy = 60.0;
        const double tilt = std::acos(-(path[0].inverse().rotation * Eigen::Vector3d::UnitZ()).z());
        EXPECT_LE(tilt, kMaxSweepTilt_rad + 1e-9);
        for (std::size_t i = 0; i < path.size(); ++i) {
            // What lies on the axis is the point aimed at: its depth is the distance.
            const float depth = render_depth(scene, path[i], axis).depth_m[60 * 160 + 80];
            EXPECT_NEAR(depth, 0.60 - 0.05 * static_cast<double>(i), 1e-5) << seed;
            EXPECT_LT(angle_between(path[i].rotation, path[0].rotation), 1e-7);
        }
    }
}

TEST(Sweep, ScalesWithThePartUnlessItIsTold) {
    const EmbeddedPart flange = embedded_part("flange");
    Part part = flange.part;
    part.surface_points_in_object_m = surface_points_from_above(flange.mesh);
    const auto length = [&](const ScenarioOptions& options) {
        const auto path = task_path(Scenario::kSweep, part, kCamera, 3, 1, options).camera_from_object;
        return (eye_of(path[2]) - eye_of(path[0])).norm();
    };
    EXPECT_NEAR(length({}), 0.5 * part.extent.diameter_m() / kReferenceDiameter_m, 1e-9);
    ScenarioOptions told;
    told.far_m = 0.5;
    told.near_m = 0.2;
    EXPECT_NEAR(length(told), 0.3, 1e-12);
}

TEST(SurfacePoints, LieOnTheSurfaceAndFaceUp) {
    for (const std::string& name : part_names()) {
        const EmbeddedPart part = embedded_part(name);
        const std::vector<Eigen::Vector3d> points = surface_points_from_above(part.mesh);
        ASSERT_FALSE(points.empty());
        const EmbreeScene scene(part.mesh);
        for (const Eigen::Vector3d& point : points) {
            Pose object_from_camera;
            object_from_camera.rotation = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
            object_from_camera.translation = point + Eigen::Vector3d(0.0, 0.0, 1.0);
            const RayHits hits = scene.cast(object_from_camera.inverse(), {1, 1, 1.0, 1.0, 0.0, 0.0});
            ASSERT_EQ(hits.size(), 1u) << name;
            EXPECT_NEAR(hits.depth_m[0], 1.0, 2e-4) << name;
            EXPECT_GT(hits.normals_in_object[0].z(), 0.9F) << name;
        }
    }
}

TEST(Crankcase, SeesTheUndersideOfAPartThatLiesOnItsDeck) {
    const Part& part = block().part;
    const EmbreeScene scene(block().mesh);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const TaskPath path = task_path(Scenario::kCrankcase, part, kCamera, 5, seed);
        for (const Pose& pose : path.camera_from_object) {
            EXPECT_LT(eye_of(pose).z(), part.extent.box_min_in_object.z());
            const RayHits hits = scene.cast(pose, kCamera);
            ASSERT_GT(hits.size(), 1000u);
            std::size_t from_above = 0, from_below = 0;
            for (const Eigen::Vector3f& normal : hits.normals_in_object) {
                from_above += normal.z() > 0.95F ? 1 : 0;
                from_below += normal.z() < -0.95F ? 1 : 0;
            }
            EXPECT_EQ(from_above, 0u);
            EXPECT_GT(from_below, hits.size() / 8);
        }
        EXPECT_NEAR(eye_of(path.camera_from_object.front()).z(), -0.045 - 0.60, 1e-6);
        EXPECT_NEAR(eye_of(path.camera_from_object.back()).z(), -0.045 - 0.18, 1e-6);
        // The table touches the deck, and up is away from it.
        EXPECT_NEAR(path.scene_from_ground.translation.z(), part.extent.box_max_in_object.z(), 1e-12);
        EXPECT_NEAR((path.scene_from_ground.rotation * Eigen::Vector3d::UnitZ()).z(), -1.0, 1e-12);
    }
}

TEST(Crankcase, AimsAtTheSurfaceOfTheSaddles) {
    const EmbreeScene scene(block().mesh);
    ASSERT_EQ(block().part.underside_targets_in_object_m.size(), 5u);
    for (const Eigen::Vector3d& saddle : block().part.underside_targets_in_object_m) {
        Pose object_from_camera;  // looks up
        object_from_camera.translation = saddle - Eigen::Vector3d(0.0, 0.0, 1.0);
        const RayHits hits = scene.cast(object_from_camera.inverse(), {1, 1, 1.0, 1.0, 0.0, 0.0});
        ASSERT_EQ(hits.size(), 1u);
        EXPECT_NEAR(hits.depth_m[0], 1.0, 1e-3);
    }
}

TEST(Conveyor, MovesAndTurnsByTheSameStepUnderACameraThatStandsStill) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        ScenarioOptions told;
        if (seed % 2 == 0) told = {{}, {}, 0.004, 0.01, {}, {}};
        const TaskPath path = task_path(Scenario::kConveyor, block().part, kCamera, 12, seed, told);
        const Eigen::Vector3d centre = block().part.extent.centre_in_object();
        const auto step = [&](std::size_t i) {
            return Eigen::Vector3d(path.camera_from_object[i] * centre - path.camera_from_object[i - 1] * centre);
        };
        const double turn = angle_between(path.camera_from_object[0].rotation, path.camera_from_object[1].rotation);
        EXPECT_LE(step(1).norm(), kMaxConveyorStep_m);
        EXPECT_LE(turn, kMaxConveyorTurn_rad);
        if (seed % 2 == 0) {
            EXPECT_NEAR(step(1).norm(), 0.004, 1e-12);
            EXPECT_NEAR(turn, 0.01, 1e-9);
        }
        for (std::size_t i = 1; i < 12; ++i) {
            EXPECT_LT((step(i) - step(1)).norm(), 1e-12);
            EXPECT_NEAR(angle_between(path.camera_from_object[i - 1].rotation, path.camera_from_object[i].rotation),
                        turn, 1e-9);
            EXPECT_EQ(path.camera_from_scene[i].translation, path.camera_from_scene[0].translation);
            // It stays on the belt.
            const Pose scene_from_object = path.camera_from_scene[i].inverse() * path.camera_from_object[i];
            EXPECT_NEAR((scene_from_object * centre).z(), centre.z(), 1e-12);
        }
    }
}

TEST(Conveyor, TheArmDoesNotReportThePartsMotion) {
    RecordingOptions options = small(Scenario::kConveyor, 6);
    options.path.conveyor_step_m = 0.01;
    options.arm.sigma_rotation_rad = options.arm.sigma_translation_m = 0.0;
    const Recording recording(block().mesh, block().part, options);
    const SimulatedFrame first = recording.frame(0), last = recording.frame(5);
    EXPECT_LT(log(last.camera_from_world * first.camera_from_world.inverse()).norm(), 1e-12);
    EXPECT_GT((last.camera_from_object.translation - first.camera_from_object.translation).norm(), 0.03);
    for (const SimulatedFrame* frame : {&first, &last}) {
        EXPECT_EQ(frame->truth.visible_pixels, frame->truth.silhouette_pixels);  // whole in view
    }
}

std::vector<data_set::StampedPose> some_trajectory(int rows, double step_s) {
    std::vector<data_set::StampedPose> trajectory;
    for (int i = 0; i < rows; ++i) {
        const double t = i * step_s;
        Twist twist;
        twist << 0.1 * std::sin(t), 0.07 * std::cos(2.0 * t), 0.05 * t, 0.2 * std::sin(t), 0.1 * t, 0.15 * std::cos(t);
        trajectory.push_back({100.0 + t, exp(twist)});
    }
    return trajectory;
}

TEST(Handheld, MovesAsTheFileUpToScale) {
    ScenarioOptions options;
    options.trajectory = some_trajectory(41, 0.1);
    // As many frames as rows, so that no part is drawn and nothing is between the rows.
    const std::vector<Pose> path =
        task_path(Scenario::kHandheld, block().part, kCamera, 41, 3, options, 10.0).camera_from_object;
    double scale = 0.0;
    for (std::size_t i = 1; i < path.size(); ++i) {
        const Pose moved = path[0] * path[i].inverse();  // first camera from camera i
        const Pose wanted = options.trajectory[0].pose.inverse() * options.trajectory[i].pose;
        EXPECT_LT(angle_between(moved.rotation, wanted.rotation), 1e-6);
        if (i == 1) scale = moved.translation.norm() / wanted.translation.norm();
        EXPECT_LT((moved.translation - scale * wanted.translation).norm(), 1e-6);
    }
    EXPECT_GT(scale, 0.1);
    EXPECT_LE(scale, 1.0 + 1e-9);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Pose& pose : path) mean += pose * block().part.extent.centre_in_object() / 41.0;
    EXPECT_GE(kCamera.pixel_at(kCamera.project(mean).x(), kCamera.project(mean).y()), 0);
    EXPECT_NEAR(mean.z() / (kBaselineDistance * block().part.extent.diameter_m()), 1.0, 0.1);
}

TEST(Handheld, TakesAPartOfALongFileAndRefusesAShortOne) {
    ScenarioOptions options;
    options.trajectory = some_trajectory(400, 0.01);
    const auto first = [&](std::uint64_t seed) {
        const auto path = task_path(Scenario::kHandheld, block().part, kCamera, 30, seed, options).camera_from_object;
        return Pose(path[0] * path[20].inverse());
    };
    EXPECT_GT(log(first(1).inverse() * first(2)).norm(), 1e-4);  // another part
    try {
        task_path(Scenario::kHandheld, block().part, kCamera, 200, 1, options);
        ADD_FAILURE() << "200 frames are longer than the trajectory";
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("3.99 s"), std::string::npos) << error.what();
    }
}

TEST(Handheld, AMadeUpHandSwaysAndTrembles) {
    const Eigen::Vector3d centre = block().part.extent.centre_in_object();
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const auto path = task_path(Scenario::kHandheld, block().part, kCamera, 120, seed).camera_from_object;
        double furthest_m = 0.0, bend_m = 0.0;
        for (std::size_t i = 0; i < path.size(); ++i) {
            const Eigen::Vector3d seen = path[i] * centre;
            EXPECT_GE(kCamera.pixel_at(kCamera.project(seen).x(), kCamera.project(seen).y()), 0);
            furthest_m = std::max(furthest_m, (eye_of(path[i]) - eye_of(path[0])).norm());
            if (i < 2) continue;
            bend_m += (eye_of(path[i]) - 2.0 * eye_of(path[i - 1]) + eye_of(path[i - 2])).squaredNorm();
        }
        EXPECT_GT(furthest_m, 0.03);
        EXPECT_LT(furthest_m, 0.5);
        // Tremor of 1 mm and 0.3 degrees (about half a metre) at 3 to 9 Hz: steps that differ by millimetres.
        const double bend_rms_m = std::sqrt(bend_m / static_cast<double>(path.size() - 2));
        EXPECT_GT(bend_rms_m, 0.0005);
        EXPECT_LT(bend_rms_m, 0.012);
    }
}

TEST(Tasks, RefuseOptionsOfOtherTasks) {
    ScenarioOptions options;
    options.occlusion = 0.3;
    EXPECT_THROW(validate(options, Scenario::kBin), std::invalid_argument);
    EXPECT_NO_THROW(validate(options, Scenario::kClutter));
    options = {};
    options.conveyor_step_m = 0.001;
    EXPECT_THROW(validate(options, Scenario::kPiston), std::invalid_argument);
    options = {};
    options.near_m = 0.5;
    options.far_m = 0.3;
    EXPECT_THROW(validate(options, Scenario::kSweep), std::invalid_argument);
    EXPECT_THROW(validate(options, Scenario::kBaseline), std::invalid_argument);
    options = {};
    options.trajectory = some_trajectory(3, 0.1);
    EXPECT_THROW(validate(options, Scenario::kConveyor), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::simulate
