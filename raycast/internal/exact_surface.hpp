// The part of ray casting that is computed in double precision, without Embree: where a ray meets the plane of the
// triangle or disc that was hit.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "raycast/embree_scene.hpp"
#include "raycast/mesh.hpp"

namespace nearpose {

// The rays of one camera in the object frame: origin + depth * direction, so that Embree's ray parameter is the depth.
struct RayBundle {
    RayBundle(const Pose& camera_from_object, const PinholeCamera& pinhole) : camera(pinhole) {
        const Pose object_from_camera = camera_from_object.inverse();
        object_from_camera_rotation = object_from_camera.rotation_matrix();
        origin_in_object = object_from_camera.translation;
        for (int u = 0; u < camera.width; ++u) x.push_back(camera.ray(u, 0).x());
        for (int v = 0; v < camera.height; ++v) y.push_back(camera.ray(0, v).y());
    }
    Eigen::Vector3d direction(int u, int v) const {
        return object_from_camera_rotation *
               Eigen::Vector3d(x[static_cast<std::size_t>(u)], y[static_cast<std::size_t>(v)], 1.0);
    }

    PinholeCamera camera;
    Eigen::Matrix3d object_from_camera_rotation;
    Eigen::Vector3d origin_in_object;
    std::vector<double> x, y;  // camera.ray's, of columns and rows
};

// Throws std::invalid_argument unless the rays can be cast: a valid pose, a valid camera, and no ray steeper than 1e6.
void require_castable(const Pose& camera_from_object, const PinholeCamera& camera);

// What a ray met. primitive is the index of a triangle, or of a cloud's disc; -1 without a hit.
struct PrimitiveHit {
    int primitive = -1;
    float depth = 0.0F;  // as Embree found it [m]
};

// A clean mesh with the planes of its triangles or discs.
class ExactSurface {
  public:
    explicit ExactSurface(Mesh mesh);

    const Mesh& mesh() const { return mesh_; }
    // Adds what the ray of pixel (u, v) met.
    void append(const RayBundle& bundle, int u, int v, const PrimitiveHit& hit, RayHits& hits) const;

  private:
    Eigen::Vector3d point_on(int primitive) const;  // [m], object frame

    Mesh mesh_;
    // Of every triangle, or of every disc of an oriented cloud: computing them for each ray takes as long as the ray.
    // Empty where a disc faces the ray.
    std::vector<Eigen::Vector3d> plane_normals_;  // of any length
    std::vector<Eigen::Vector3f> unit_normals_;
};

}  // namespace nearpose
