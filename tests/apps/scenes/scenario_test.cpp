#include "apps/scenes/scenario.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "apps/scenes/parts.hpp"
#include "raycast/depth_renderer.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::simulate {
namespace {

const PinholeCamera kCamera{160, 120, 150.0, 150.0, 79.5, 59.5};

Part block() {
    static const ModelExtent extent = extent_of(embedded_part("engine_block").mesh);
    return engine_block_part(extent);
}

struct Sight {
    Eigen::Vector3d eye;   // object frame [m]
    double height_m;       // over the deck
    double tilt_rad;       // of the line of sight from the deck's normal
    Eigen::Vector3d foot;  // where the line of sight meets the deck
};

Sight sight_of(const Pose& camera_from_object, const Part& part) {
    const Pose object_from_camera = camera_from_object.inverse();
    const Eigen::Vector3d axis = object_from_camera.rotation * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d eye = object_from_camera.translation;
    const double height = eye.z() - part.deck_z_m;
    return {eye, height, std::acos(std::min(1.0, -axis.z())), eye - axis * (height / axis.z())};
}

TEST(EmbeddedModel, IsTheReferenceOfTheScenarios) {
    EXPECT_NEAR(block().extent.diameter_m(), kReferenceDiameter_m, 1e-5);
    EXPECT_LT(block().extent.centre_in_object().norm(), 1e-5);
}

TEST(EmbeddedModel, HasItsDeckAndBoresWhereThePartSays) {
    const Part part = block();
    const EmbreeScene scene(embedded_part("engine_block").mesh);
    const PinholeCamera one_ray{1, 1, 1.0, 1.0, 0.0, 0.0};
    const auto surface_z = [&](const Eigen::Vector3d& point) {
        Pose object_from_camera;
        object_from_camera.rotation = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);  // looks down
        object_from_camera.translation = Eigen::Vector3d(point.x(), point.y(), 1.0);
        const float depth = render_depth(scene, object_from_camera.inverse(), one_ray).depth_m[0];
        return depth == 0.0F ? -1.0 : 1.0 - depth;
    };
    ASSERT_EQ(part.targets_in_object_m.size(), 4u);
    for (const Eigen::Vector3d& bore : part.targets_in_object_m) {
        EXPECT_LT(surface_z(bore), part.deck_z_m - 0.1);
        EXPECT_NEAR(surface_z(bore + Eigen::Vector3d(0.041, 0.0, 0.0)), part.deck_z_m, 1e-5);
    }
}

TEST(Baseline, StandsStillAndHasTheWholePartInView) {
    const Part part = block();
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const std::vector<Pose> path = task_path(Scenario::kBaseline, part, kCamera, 3, seed).camera_from_object;
        ASSERT_EQ(path.size(), 3u);
        EXPECT_EQ(log(path[0].inverse() * path[2]).norm(), log(path[0].inverse() * path[0]).norm());
        const Eigen::Vector3d centre = path[0] * part.extent.centre_in_object();
        EXPECT_GE(centre.norm(), kBaselineDistance * part.extent.diameter_m() - 1e-9);
        EXPECT_LE(centre.norm(), 1.35 * part.extent.diameter_m());
        EXPECT_GT(path[0].inverse().translation.z(), part.extent.box_max_in_object.z() - 0.12);
        for (const Eigen::Vector3f& vertex : embedded_part("engine_block").mesh.vertices_in_object) {
            const Eigen::Vector3d point = path[0] * vertex.cast<double>().eval();
            ASSERT_GT(point.z(), 0.0);
            ASSERT_GE(kCamera.pixel_at(kCamera.project(point).x(), kCamera.project(point).y()), 0);
        }
    }
}

TEST(Piston, ComesDownToABoreAndTurnsUpright) {
    const Part part = block();
    const ApproachLimits limits;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const std::vector<Pose> path = task_path(Scenario::kPiston, part, kCamera, 60, seed).camera_from_object;
        ASSERT_EQ(path.size(), 60u);
        const Sight first = sight_of(path.front(), part), last = sight_of(path.back(), part);
        EXPECT_NEAR(first.height_m, 0.60, 1e-6);
        EXPECT_NEAR(last.height_m, 0.18, 1e-6);
        EXPECT_GE(first.tilt_rad, limits.min_far_tilt_rad - 1e-6);
        EXPECT_LE(last.tilt_rad, limits.max_near_tilt_rad + 1e-6);
        double nearest_bore_m = 1.0;
        for (const Eigen::Vector3d& bore : part.targets_in_object_m) {
            nearest_bore_m = std::min(nearest_bore_m, (last.foot - bore).lpNorm<Eigen::Infinity>());
        }
        EXPECT_LE(nearest_bore_m, limits.max_near_offset_m + 1e-6);
        double largest_step_m = 0.0;
        for (std::size_t i = 1; i < path.size(); ++i) {
            const Sight before = sight_of(path[i - 1], part), now = sight_of(path[i], part);
            EXPECT_LT(now.height_m, before.height_m);
            EXPECT_LT(now.tilt_rad, before.tilt_rad);
            const double step_m = (now.eye - before.eye).norm();
            largest_step_m = std::max(largest_step_m, step_m);
            EXPECT_LT(angle_between(path[i - 1].rotation, path[i].rotation), 0.06);
        }
        const double first_step_m = (sight_of(path[1], part).eye - first.eye).norm();
        EXPECT_LT(largest_step_m, 0.03);
        EXPECT_LT(first_step_m, 0.1 * largest_step_m);  // eases in
    }
}

TEST(Piston, SeedsDiffer) {
    const Pose a = task_path(Scenario::kPiston, block(), kCamera, 5, 1).camera_from_object.front();
    const Pose b = task_path(Scenario::kPiston, block(), kCamera, 5, 2).camera_from_object.front();
    EXPECT_GT((a.inverse().translation - b.inverse().translation).norm(), 0.01);
}

TEST(Piston, ScalesWithThePart) {
    const ModelExtent extent{Eigen::Vector3d(0.1, 0.2, 0.3), Eigen::Vector3d(0.2, 0.4, 0.5)};
    const Part part = box_part(extent);
    const double scale = extent.diameter_m() / kReferenceDiameter_m;
    const std::vector<Pose> path = task_path(Scenario::kPiston, part, kCamera, 2, 3).camera_from_object;
    EXPECT_NEAR(sight_of(path.front(), part).height_m, 0.60 * scale, 1e-9);
    EXPECT_NEAR(sight_of(path.back(), part).height_m, 0.18 * scale, 1e-9);
    const Eigen::Vector3d foot = sight_of(path.back(), part).foot;
    EXPECT_TRUE(Eigen::AlignedBox3d(extent.box_min_in_object, extent.box_max_in_object)
                    .contains(foot - Eigen::Vector3d(0.0, 0.0, 1e-9)));
}

TEST(Scenarios, RefuseWhatTheyCannotDo) {
    for (const std::string& name : scenario_names()) EXPECT_NO_THROW(scenario_of(name));
    EXPECT_THROW(scenario_of("pistn"), std::invalid_argument);
    EXPECT_THROW(task_path(Scenario::kPiston, block(), kCamera, 0, 1), std::invalid_argument);
    PinholeCamera squinting = kCamera;
    squinting.cx = 1e5;
    EXPECT_THROW(task_path(Scenario::kBaseline, block(), squinting, 1, 1), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::simulate
