#include "tests/bench/naive/embree_rays.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace nearpose::bench::naive {

TriangleScene::TriangleScene(const Mesh& mesh)
    : device_(rtcNewDevice("threads=1,start_threads=0")), scene_(rtcNewScene(device_)) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices_in_object.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), mesh.triangles.size()));
    for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) vertices = std::copy_n(vertex.data(), 3, vertices);
    for (const auto& triangle : mesh.triangles) indices = std::copy_n(triangle.data(), 3, indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    // As ours, so that the ratio is of what is done around the calls.
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) throw std::runtime_error("Embree does not take the mesh");
}

TriangleScene::~TriangleScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

void TriangleScene::intersect(RTCRayHit& ray) const {
#if NEARPOSE_EMBREE_MAJOR >= 4
    rtcIntersect1(scene_, &ray);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &ray);
#endif
}

void TriangleScene::intersect(const std::array<int, 16>& valid, RTCRayHit16& packet) const {
#if NEARPOSE_EMBREE_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcIntersect16(valid.data(), scene_, &packet, &arguments);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid.data(), scene_, &context, &packet);
#endif
}

std::vector<RayPacket> prepare_packets(const Pose& camera_from_object, const PinholeCamera& camera) {
    constexpr int kBlock = 4;
    const Pose object_from_camera = camera_from_object.inverse();
    const Eigen::Matrix3d rotation = object_from_camera.rotation_matrix();
    const Eigen::Vector3f origin = object_from_camera.translation.cast<float>();
    std::vector<RayPacket> packets;
    for (int first_v = 0; first_v < camera.height; first_v += kBlock) {
        for (int first_u = 0; first_u < camera.width; first_u += kBlock) {
            RayPacket& packet = packets.emplace_back();
            for (int k = 0; k < kBlock * kBlock; ++k) {
                const int u = first_u + k % kBlock, v = first_v + k / kBlock;
                packet.rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
                if (u >= camera.width || v >= camera.height) continue;
                const Eigen::Vector3f direction = (rotation * camera.ray(u, v)).cast<float>();
                packet.valid[static_cast<std::size_t>(k)] = -1;
                RTCRay16& ray = packet.rays.ray;
                ray.org_x[k] = origin.x(), ray.org_y[k] = origin.y(), ray.org_z[k] = origin.z();
                ray.dir_x[k] = direction.x(), ray.dir_y[k] = direction.y(), ray.dir_z[k] = direction.z();
                ray.tfar[k] = std::numeric_limits<float>::infinity();
                ray.mask[k] = ~0U;
            }
        }
    }
    return packets;
}

}  // namespace nearpose::bench::naive
