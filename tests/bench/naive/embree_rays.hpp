// Embree as it is: a scene of triangles and its two calls, without anything of nearpose's ray casting around them.
#pragma once

#if NEARPOSE_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <array>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/pose.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::bench::naive {

// Owns the device and the scene; triangles only.
class TriangleScene {
  public:
    explicit TriangleScene(const Mesh& mesh);
    ~TriangleScene();
    TriangleScene(const TriangleScene&) = delete;
    TriangleScene& operator=(const TriangleScene&) = delete;

    void intersect(RTCRayHit& ray) const;
    void intersect(const std::array<int, 16>& valid, RTCRayHit16& packet) const;

  private:
    RTCDevice device_;
    RTCScene scene_;
};

// The rays of 4 x 4 pixels, ready to be cast.
struct RayPacket {
    alignas(64) std::array<int, 16> valid{};
    alignas(64) RTCRayHit16 rays{};
};

// All rays of a camera's pixels at a pose, in the object frame; the ray parameter is the depth [m].
std::vector<RayPacket> prepare_packets(const Pose& camera_from_object, const PinholeCamera& camera);

}  // namespace nearpose::bench::naive
