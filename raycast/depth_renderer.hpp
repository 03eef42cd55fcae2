// Depth images of models at poses, without noise.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/base/pose.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose {

// 0 where no surface is hit. Serial; may be called from several threads at once.
DepthImage render_depth(const EmbreeScene& scene, const Pose& camera_from_object, const PinholeCamera& camera);

struct SceneObject {
    const EmbreeScene* scene = nullptr;  // not owned
    Pose camera_from_object;
};

// All vectors are row-major, one entry a pixel.
struct RenderedImage {
    DepthImage depth;                                // 0 where nothing is hit
    std::vector<int> object;                         // index of the nearest object, -1 none
    std::vector<Eigen::Vector3f> normals_in_camera;  // unit, towards the camera; zero where nothing is hit
};

// The nearest surface of several objects in each pixel; of equally near ones the first. Serial.
RenderedImage render(std::span<const SceneObject> objects, const PinholeCamera& camera);

}  // namespace nearpose
