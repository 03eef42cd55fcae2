// A mesh prepared for ray casting.
#pragma once

#include <memory>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "raycast/mesh.hpp"

namespace nearpose {

// First hits of the rays of a camera's pixels, in the order of the pixels; pixels without a hit have no entry.
struct RayHits {
    std::vector<int> pixels;                         // row-major index into the camera's image, ascending
    std::vector<Eigen::Vector3f> points_in_object;   // [m]
    std::vector<Eigen::Vector3f> normals_in_object;  // of the surface itself, unit, turned towards the camera
    std::vector<float> depth_m;                      // z in camera coordinates, > 0

    std::size_t size() const { return pixels.size(); }
    void reserve(std::size_t count);
};

// Immutable after construction; cast may be called from several threads at once. Repeated calls give the same bits, in
// any number of threads. The depth of what was hit is computed anew in double, so that instruction sets agree too:
// SSE2, AVX, AVX2 and AVX-512 give the same bits but where a ray runs through an edge, which may find either neighbour,
// or almost within its surface (then to about 1e-4 of the depth).
class EmbreeScene {
  public:
    // The mesh is cleaned first (see clean). A cloud with normals becomes oriented discs, one without becomes discs
    // that face the ray. Throws std::invalid_argument for a cloud without disc radius, std::runtime_error where the
    // mesh is empty or the device fails (no memory).
    explicit EmbreeScene(const Mesh& mesh);
    ~EmbreeScene();
    EmbreeScene(EmbreeScene&&) noexcept;
    EmbreeScene& operator=(EmbreeScene&&) noexcept;

    // Casts the ray of every pixel of `camera`. Back faces count as surface, so that meshes of any winding work. Throws
    // std::invalid_argument if the pose or the camera is not valid: the ray caster would end the process.
    RayHits cast(const Pose& camera_from_object, const PinholeCamera& camera) const;

    const ModelExtent& extent() const;

  private:
    struct Impl;
    std::unique_ptr<const Impl> impl_;
};

}  // namespace nearpose
