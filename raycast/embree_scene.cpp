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

namespace nearpose {
namespace {

constexpr int kBlock = 4;  // a packet is a block of 4x4 pixels, whose rays meet the same part of the tree
constexpr int kPacket = kBlock * kBlock;
// Steeper rays and farther cameras are refused; Embree stops the process for numbers above 1e18.
constexpr double kMaxRaySlope = 1e6;

[[noreturn]] void throw_device_error(RTCError code, const std::string& detail) {
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

void intersect(const std::array<int, kPacket>& valid, RTCScene scene, RTCRayHit16& packet) {
#if NEARPOSE_EMBREE_MAJOR >= 4
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect16(valid.data(), scene, &packet, &arguments);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid.data(), scene, &context, &packet);
#endif
}

// The rays of one camera in the object frame: origin + depth * direction, so that Embree's ray parameter is the depth.
struct RayBundle {
    RayBundle(const Pose& camera_from_object, const PinholeCamera& pinhole) : camera(pinhole) {
        const Pose object_from_camera = camera_from_object.inverse();
        object_from_camera_rotation = object_from_camera.rotation_matrix();
        origin_in_object = object_from_camera.translation;
    }
    Eigen::Vector3d direction(int u, int v) const { return object_from_camera_rotation * camera.ray(u, v); }

    PinholeCamera camera;
    Eigen::Matrix3d object_from_camera_rotation;
    Eigen::Vector3d origin_in_object;
};

void require_castable(const Pose& camera_from_object, const PinholeCamera& camera) {
    if (!is_valid(camera_from_object)) {
        throw std::invalid_argument(
            "cast: the pose is not valid (a number is not finite, the quaternion not of unit "
            "length, or the translation beyond 1e6 m)");
    }
    validate(camera);
    for (const Eigen::Vector3d& ray : {camera.ray(0, 0), camera.ray(camera.width, camera.height)}) {
        if (!(ray.cwiseAbs().maxCoeff() < kMaxRaySlope)) {
            throw std::invalid_argument("cast: rays of this camera are steeper than 1e6: check fx, fy, cx, cy");
        }
    }
}

// What a ray met. primitive is -1 without a hit.
struct Hit {
    int primitive = -1;
    float depth = 0.0F;  // as Embree found it [m]
};

}  // namespace

struct EmbreeScene::Impl {
    explicit Impl(const Mesh& source);

    void attach_triangles();
    void attach_discs();
    void cast_block(const RayBundle& bundle, int first_u, int first_v, Hit* band) const;
    void append(const RayBundle& bundle, int u, int v, const Hit& hit, RayHits& hits) const;
    // Of the surface that `primitive` is part of: a point [m] and a vector along the normal, object frame.
    void plane_of(int primitive, const Eigen::Vector3d& direction, Eigen::Vector3d& point,
                  Eigen::Vector3d& normal) const;

    // The handles stand after what their callbacks and buffers refer to, so that they go first.
    Mesh mesh;
    ModelExtent extent;
    ErrorLog errors;
    DeviceHandle device;
    SceneHandle scene;
};

EmbreeScene::Impl::Impl(const Mesh& source) : mesh(clean(source, "mesh")), extent(extent_of(mesh)) {
    // One thread builds and none is started: the callers' threads are the only ones, and the tree is always the same.
    device.reset(rtcNewDevice("threads=1,start_threads=0,set_affinity=0"));
    if (!device) throw_device_error(rtcGetDeviceError(nullptr), "no device");
    rtcSetDeviceErrorFunction(device.get(), ErrorLog::record, &errors);
    scene.reset(rtcNewScene(device.get()));
    errors.check();
    // Robust: rays do not slip between triangles that share an edge.
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_MEDIUM);
    if (mesh.is_cloud()) {
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
    const GeometryHandle geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
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
    if (!(mesh.disc_radius_m > 0.0F) || !std::isfinite(mesh.disc_radius_m)) {
        throw std::invalid_argument("a cloud needs a disc radius above 0 m to be seen, not " +
                                    std::to_string(mesh.disc_radius_m));
    }
    const bool oriented = !mesh.vertex_normals_in_object.empty();
    const std::size_t count = mesh.vertices_in_object.size();
    const GeometryHandle geometry(
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

void EmbreeScene::Impl::cast_block(const RayBundle& bundle, int first_u, int first_v, Hit* band) const {
    alignas(64) std::array<int, kPacket> valid{};
    alignas(64) RTCRayHit16 packet{};
    for (int k = 0; k < kPacket; ++k) {
        const int u = first_u + k % kBlock;
        const int v = first_v + k / kBlock;
        packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        if (u >= bundle.camera.width || v >= bundle.camera.height) continue;
        const Eigen::Vector3d direction = bundle.direction(u, v);
        valid[static_cast<std::size_t>(k)] = -1;
        packet.ray.org_x[k] = static_cast<float>(bundle.origin_in_object.x());
        packet.ray.org_y[k] = static_cast<float>(bundle.origin_in_object.y());
        packet.ray.org_z[k] = static_cast<float>(bundle.origin_in_object.z());
        packet.ray.dir_x[k] = static_cast<float>(direction.x());
        packet.ray.dir_y[k] = static_cast<float>(direction.y());
        packet.ray.dir_z[k] = static_cast<float>(direction.z());
        packet.ray.tnear[k] = 0.0F;
        packet.ray.tfar[k] = std::numeric_limits<float>::infinity();
        packet.ray.mask[k] = ~0U;
    }
    intersect(valid, scene.get(), packet);
    for (int k = 0; k < kPacket; ++k) {
        if (packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
        Hit& hit = band[(k / kBlock) * bundle.camera.width + first_u + k % kBlock];
        hit = {static_cast<int>(packet.hit.primID[k]), packet.ray.tfar[k]};
    }
}

void EmbreeScene::Impl::plane_of(int primitive, const Eigen::Vector3d& direction, Eigen::Vector3d& point,
                                 Eigen::Vector3d& normal) const {
    const auto index = static_cast<std::size_t>(primitive);
    if (mesh.is_cloud()) {
        point = mesh.vertices_in_object[index].cast<double>();
        if (mesh.vertex_normals_in_object.empty()) {
            normal = -direction;  // a plain disc faces the ray
        } else {
            normal = mesh.vertex_normals_in_object[index].cast<double>();
        }
        return;
    }
    const auto& triangle = mesh.triangles[index];
    point = mesh.vertices_in_object[static_cast<std::size_t>(triangle[0])].cast<double>();
    const Eigen::Vector3d b = mesh.vertices_in_object[static_cast<std::size_t>(triangle[1])].cast<double>();
    const Eigen::Vector3d c = mesh.vertices_in_object[static_cast<std::size_t>(triangle[2])].cast<double>();
    normal = (b - point).cross(c - point);
}

// Embree's depth is a float whose last bits depend on the instruction set. The depth of the plane that was hit is
// computed again in double; where it does not agree (a ray within the plane) Embree's stays.
void EmbreeScene::Impl::append(const RayBundle& bundle, int u, int v, const Hit& hit, RayHits& hits) const {
    const Eigen::Vector3d direction = bundle.direction(u, v);
    Eigen::Vector3d on_plane, normal;
    plane_of(hit.primitive, direction, on_plane, normal);
    const double slope = normal.dot(direction);
    const double plane_depth = normal.dot(on_plane - bundle.origin_in_object) / slope;
    const bool agrees = std::abs(plane_depth - hit.depth) <= 1e-4 * hit.depth;  // false for NaN
    const double depth = agrees ? plane_depth : static_cast<double>(hit.depth);
    if (!std::isfinite(depth) || !(depth > 0.0)) return;

    hits.pixels.push_back(v * bundle.camera.width + u);
    hits.points_in_object.emplace_back((bundle.origin_in_object + depth * direction).cast<float>());
    hits.normals_in_object.emplace_back(((slope > 0.0 ? -1.0 : 1.0) * normal.normalized()).cast<float>());
    hits.depth_m.push_back(static_cast<float>(depth));
}

EmbreeScene::EmbreeScene(const Mesh& mesh) : impl_(std::make_unique<const Impl>(mesh)) {}
EmbreeScene::~EmbreeScene() = default;
EmbreeScene::EmbreeScene(EmbreeScene&&) noexcept = default;
EmbreeScene& EmbreeScene::operator=(EmbreeScene&&) noexcept = default;

const ModelExtent& EmbreeScene::extent() const {
    return impl_->extent;
}

RayHits EmbreeScene::cast(const Pose& camera_from_object, const PinholeCamera& camera) const {
    require_castable(camera_from_object, camera);
    const RayBundle bundle(camera_from_object, camera);
    RayHits hits;
    std::vector<Hit> band(static_cast<std::size_t>(kBlock * camera.width));
    for (int first_v = 0; first_v < camera.height; first_v += kBlock) {
        std::fill(band.begin(), band.end(), Hit{});
        for (int first_u = 0; first_u < camera.width; first_u += kBlock) {
            impl_->cast_block(bundle, first_u, first_v, band.data());
        }
        const int end_v = std::min(first_v + kBlock, camera.height);
        for (int v = first_v; v < end_v; ++v) {
            for (int u = 0; u < camera.width; ++u) {
                const Hit& hit = band[static_cast<std::size_t>((v - first_v) * camera.width + u)];
                if (hit.primitive >= 0) impl_->append(bundle, u, v, hit, hits);
            }
        }
    }
    return hits;
}

}  // namespace nearpose
