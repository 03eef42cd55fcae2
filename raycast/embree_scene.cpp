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
    void cast_block(const RayBundle& bundle, int first_u, int first_v, RTCRayHit16& packet, Hit* band) const;
    void append(const RayBundle& bundle, int u, int v, const Hit& hit, RayHits& hits) const;
    void set_normals();
    Eigen::Vector3d point_on(int primitive) const;  // [m], object frame

    // The handles stand after what their callbacks and buffers refer to, so that they go first.
    Mesh mesh;
    // Of every triangle, or of every disc of an oriented cloud: computing them for each ray takes as long as the ray.
    // Empty where a disc faces the ray.
    std::vector<Eigen::Vector3d> plane_normals;  // of any length
    std::vector<Eigen::Vector3f> unit_normals;
    ModelExtent extent;
    ErrorLog errors;
    DeviceHandle device;
    SceneHandle scene;
};

EmbreeScene::Impl::Impl(const Mesh& source) : mesh(clean(source, "mesh")), extent(extent_of(mesh)) {
    set_normals();
    // One thread builds and none is started: the callers' threads are the only ones, and the tree is always the same.
    device.reset(rtcNewDevice("threads=1,start_threads=0,set_affinity=0"));
    if (!device) throw_device_error(rtcGetDeviceError(nullptr), "no device");
    rtcSetDeviceErrorFunction(device.get(), ErrorLog::record, &errors);
    scene.reset(rtcNewScene(device.get()));
    errors.check();
    // Not RTC_SCENE_FLAG_ROBUST: it takes up to 1.8 times as long, for one ray in some ten million that runs
    // through an edge to the micrometre and may slip between its triangles. The better tree is worth a tenth of the
    // time; for a large mesh it takes seconds and half as much memory again.
    constexpr std::size_t kLargeMesh = 300'000;
    rtcSetSceneBuildQuality(scene.get(),
                            mesh.triangles.size() < kLargeMesh ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM);
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

void EmbreeScene::Impl::set_normals() {
    for (const Eigen::Vector3f& normal : mesh.vertex_normals_in_object)
        if (mesh.is_cloud()) plane_normals.push_back(normal.cast<double>());
    for (const auto& triangle : mesh.triangles) {
        const auto vertex = [&](int k) {
            return Eigen::Vector3d(mesh.vertices_in_object[static_cast<std::size_t>(triangle[k])].cast<double>());
        };
        plane_normals.push_back((vertex(1) - vertex(0)).cross(vertex(2) - vertex(0)));
    }
    for (const Eigen::Vector3d& normal : plane_normals) unit_normals.push_back(normal.normalized().cast<float>());
}

Eigen::Vector3d EmbreeScene::Impl::point_on(int primitive) const {
    const auto index = static_cast<std::size_t>(primitive);
    const std::size_t vertex = mesh.is_cloud() ? index : static_cast<std::size_t>(mesh.triangles[index][0]);
    return mesh.vertices_in_object[vertex].cast<double>();
}

void EmbreeScene::Impl::cast_block(const RayBundle& bundle, int first_u, int first_v, RTCRayHit16& packet,
                                   Hit* band) const {
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
        Hit& hit = band[(k / kBlock) * bundle.camera.width + first_u + k % kBlock];
        hit = {static_cast<int>(packet.hit.primID[k]), packet.ray.tfar[k]};
    }
}

// Embree's depth is a float whose last bits depend on the instruction set. The depth of the plane that was hit is
// computed again in double; where it does not agree (a ray within the plane) Embree's stays.
void EmbreeScene::Impl::append(const RayBundle& bundle, int u, int v, const Hit& hit, RayHits& hits) const {
    const Eigen::Vector3d direction = bundle.direction(u, v);
    const bool faces_ray = plane_normals.empty();
    const Eigen::Vector3d normal = faces_ray ? Eigen::Vector3d(-direction) : plane_normals[hit.primitive];
    const double slope = normal.dot(direction);
    const double plane_depth = normal.dot(point_on(hit.primitive) - bundle.origin_in_object) / slope;
    const bool agrees = std::abs(plane_depth - hit.depth) <= 1e-4 * hit.depth;  // false for NaN
    const double depth = agrees ? plane_depth : static_cast<double>(hit.depth);
    if (!std::isfinite(depth) || !(depth > 0.0)) return;

    hits.pixels.push_back(v * bundle.camera.width + u);
    hits.points_in_object.emplace_back((bundle.origin_in_object + depth * direction).cast<float>());
    const Eigen::Vector3f unit =
        faces_ray ? Eigen::Vector3f(normal.normalized().cast<float>()) : unit_normals[hit.primitive];
    hits.normals_in_object.emplace_back(slope > 0.0 ? Eigen::Vector3f(-unit) : unit);
    hits.depth_m.push_back(static_cast<float>(depth));
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
    std::vector<Hit> band(static_cast<std::size_t>(kBlock * camera.width));
    for (int first_v = 0; first_v < camera.height; first_v += kBlock) {
        std::fill(band.begin(), band.end(), Hit{});
        for (int first_u = 0; first_u < camera.width; first_u += kBlock) {
            impl_->cast_block(bundle, first_u, first_v, packet, band.data());
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
