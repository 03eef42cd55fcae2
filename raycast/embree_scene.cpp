#include "raycast/embree_scene.hpp"

#if NEARPOSE_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "raycast/internal/exact_surface.hpp"

namespace nearpose {
namespace {

constexpr int kBlock = 4;  // a packet is a block of 4x4 pixels, whose rays meet the same part of the tree
constexpr int kPacket = kBlock * kBlock;
}  // namespace

// Named, since these types are members of EmbreeScene::Impl, which is not of this file alone.
namespace embree {

[[noreturn]] static void throw_device_error(RTCError code, const std::string& detail) {
    throw std::runtime_error("Embree error " + std::to_string(static_cast<int>(code)) +
                             " while the model was prepared" + (detail.empty() ? "" : ": " + detail) +
                             (code == RTC_ERROR_OUT_OF_MEMORY ? " (reduce the number of triangles)" : ""));
}

// Embree reports errors through a callback in the thread of the call; an exception may not cross its C frames, so the
// first is kept and thrown afterwards.
struct ErrorLog {
    RTCError code = RTC_ERROR_NONE;
    std::string detail;

    static void record(void* self, RTCError code, const char* text) {
        auto* log = static_cast<ErrorLog*>(self);
        if (log->code != RTC_ERROR_NONE) return;
        log->code = code;
        log->detail = text == nullptr ? "" : text;
    }
    void check() const {
        if (code != RTC_ERROR_NONE) throw_device_error(code, detail);
    }
};

struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using DeviceHandle = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;
using GeometryHandle = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, ReleaseGeometry>;

}  // namespace embree

namespace {

// As single rays of a packet: those of the filter's coarse grids part early in the tree, where Embree's traversal for
// coherent ones takes 1.4 times as long.
void intersect(const std::array<int, kPacket>& valid, RTCScene scene, RTCRayHit16& packet) {
#if NEARPOSE_EMBREE_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcIntersect16(valid.data(), scene, &packet, &arguments);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid.data(), scene, &context, &packet);
#endif
}

}  // namespace

struct EmbreeScene::Impl {
    explicit Impl(const Mesh& source);

    void attach_triangles();
    void attach_discs();
    void cast_block(const RayBundle& bundle, int first_u, int first_v, RTCRayHit16& packet, PrimitiveHit* band) const;

    // The handles stand after what their callbacks and buffers refer to, so that they go first.
    ExactSurface surface;
    ModelExtent extent;
    embree::ErrorLog errors;
    embree::DeviceHandle device;
    embree::SceneHandle scene;
};

EmbreeScene::Impl::Impl(const Mesh& source) : surface(clean(source, "mesh")), extent(extent_of(surface.mesh())) {
    // One thread builds and none is started: the callers' threads are the only ones, and the tree is always the same.
    device.reset(rtcNewDevice("threads=1,start_threads=0,set_affinity=0"));
    if (!device) embree::throw_device_error(rtcGetDeviceError(nullptr), "no device");
    rtcSetDeviceErrorFunction(device.get(), embree::ErrorLog::record, &errors);
    scene.reset(rtcNewScene(device.get()));
    errors.check();
    // Not RTC_SCENE_FLAG_ROBUST: it takes up to 1.8 times as long, for one ray in some ten million that runs
    // through an edge to the micrometre and may slip between its triangles. The better tree is worth a tenth of the
    // time; for a large mesh it takes seconds and half as much memory again.
    constexpr std::size_t kLargeMesh = 300'000;
    rtcSetSceneBuildQuality(
        scene.get(), surface.mesh().triangles.size() < kLargeMesh ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM);
    if (surface.mesh().is_cloud()) {
        attach_discs();
    } else {
        attach_triangles();
    }
    rtcCommitScene(scene.get());
    errors.check();
    RTCBounds bounds{};
    rtcGetSceneBounds(scene.get(), &bounds);
    if (!(std::isfinite(bounds.lower_x) && std::isfinite(bounds.upper_x))) {
        throw std::runtime_error("Embree took none of the model's triangles");
    }
}

void EmbreeScene::Impl::attach_triangles() {
    const Mesh& mesh = surface.mesh();
    const embree::GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    errors.check();
    auto* vertices =
        static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                    3 * sizeof(float), mesh.vertices_in_object.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
    errors.check();
    for (const Eigen::Vector3f& vertex : mesh.vertices_in_object) vertices = std::copy_n(vertex.data(), 3, vertices);
    for (const auto& triangle : mesh.triangles) indices = std::copy_n(triangle.data(), 3, indices);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometry(scene.get(), geometry.get());
    errors.check();
}

void EmbreeScene::Impl::attach_discs() {
    const Mesh& mesh = surface.mesh();
    if (!(mesh.disc_radius_m > 0.0F) || !std::isfinite(mesh.disc_radius_m)) {
        throw std::invalid_argument("a cloud needs a disc radius above 0 m to be seen, not " +
                                    std::to_string(mesh.disc_radius_m));
    }
    const bool oriented = !mesh.vertex_normals_in_object.empty();
    const std::size_t count = mesh.vertices_in_object.size();
    const embree::GeometryHandle geometry(
        rtcNewGeometry(device.get(), oriented ? RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT : RTC_GEOMETRY_TYPE_DISC_POINT));
    errors.check();
    auto* discs = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                              RTC_FORMAT_FLOAT4, 4 * sizeof(float), count));
    errors.check();
    for (const Eigen::Vector3f& point : mesh.vertices_in_object) {
        discs = std::copy_n(point.data(), 3, discs);
        *discs++ = mesh.disc_radius_m;
    }
    if (oriented) {
        auto* normals = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_NORMAL, 0,
                                                                    RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
        errors.check();
        for (const Eigen::Vector3f& normal : mesh.vertex_normals_in_object)
            normals = std::copy_n(normal.data(), 3, normals);
    }
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometry(scene.get(), geometry.get());
    errors.check();
}

void EmbreeScene::Impl::cast_block(const RayBundle& bundle, int first_u, int first_v, RTCRayHit16& packet,
                                   PrimitiveHit* band) const {
    alignas(64) std::array<int, kPacket> valid{};
    for (int k = 0; k < kPacket; ++k) {
        const int u = first_u + k % kBlock;
        const int v = first_v + k / kBlock;
        packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        packet.ray.tfar[k] = -1.0F;  // a ray that is not to be cast has no length either
        if (u >= bundle.camera.width || v >= bundle.camera.height) continue;
        const Eigen::Vector3d direction = bundle.direction(u, v);
        valid[static_cast<std::size_t>(k)] = -1;
        packet.ray.dir_x[k] = static_cast<float>(direction.x());
        packet.ray.dir_y[k] = static_cast<float>(direction.y());
        packet.ray.dir_z[k] = static_cast<float>(direction.z());
        packet.ray.tnear[k] = 0.0F;
        packet.ray.tfar[k] = std::numeric_limits<float>::infinity();
    }
    intersect(valid, scene.get(), packet);
    for (int k = 0; k < kPacket; ++k) {
        if (valid[static_cast<std::size_t>(k)] == 0 || packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
        PrimitiveHit& hit = band[(k / kBlock) * bundle.camera.width + first_u + k % kBlock];
        hit = {static_cast<int>(packet.hit.primID[k]), packet.ray.tfar[k]};
    }
}

EmbreeScene::EmbreeScene(const Mesh& mesh) : impl_(std::make_unique<const Impl>(mesh)) {}
EmbreeScene::~EmbreeScene() = default;
EmbreeScene::EmbreeScene(EmbreeScene&&) noexcept = default;
EmbreeScene& EmbreeScene::operator=(EmbreeScene&&) noexcept = default;

const ModelExtent& EmbreeScene::extent() const {
    return impl_->extent;
}

void RayHits::reserve(std::size_t count) {
    pixels.reserve(count);
    points_in_object.reserve(count);
    normals_in_object.reserve(count);
    depth_m.reserve(count);
}

RayHits EmbreeScene::cast(const Pose& camera_from_object, const PinholeCamera& camera) const {
    require_castable(camera_from_object, camera);
    const RayBundle bundle(camera_from_object, camera);
    alignas(64) RTCRayHit16 packet{};
    std::fill_n(packet.ray.org_x, kPacket, static_cast<float>(bundle.origin_in_object.x()));
    std::fill_n(packet.ray.org_y, kPacket, static_cast<float>(bundle.origin_in_object.y()));
    std::fill_n(packet.ray.org_z, kPacket, static_cast<float>(bundle.origin_in_object.z()));
    std::fill_n(packet.ray.mask, kPacket, ~0U);
    RayHits hits;
    hits.reserve(static_cast<std::size_t>(camera.width) * camera.height);
    std::vector<PrimitiveHit> band(static_cast<std::size_t>(kBlock * camera.width));
    for (int first_v = 0; first_v < camera.height; first_v += kBlock) {
        std::fill(band.begin(), band.end(), PrimitiveHit{});
        for (int first_u = 0; first_u < camera.width; first_u += kBlock) {
            impl_->cast_block(bundle, first_u, first_v, packet, band.data());
        }
        const int end_v = std::min(first_v + kBlock, camera.height);
        for (int v = first_v; v < end_v; ++v) {
            for (int u = 0; u < camera.width; ++u) {
                const PrimitiveHit& hit = band[static_cast<std::size_t>((v - first_v) * camera.width + u)];
                if (hit.primitive >= 0) impl_->surface.append(bundle, u, v, hit, hits);
            }
        }
    }
    return hits;
}

}  // namespace nearpose
