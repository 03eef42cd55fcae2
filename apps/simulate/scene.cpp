#include "apps/simulate/scene.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose::simulate {
namespace {

constexpr int kMaxCanvasSide = 16384;  // of any camera [pixels]

Mesh table_under(const ModelExtent& part) {
    // Far enough for a whole view of the part to show the table around it.
    const double half_m = 1.5 * part.diameter_m();
    const Eigen::Vector3d centre = part.centre_in_object();
    Mesh table;
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        table.vertices_in_object.emplace_back(
            Eigen::Vector3d(centre.x() + x * half_m, centre.y() + y * half_m, part.box_min_in_object.z())
                .cast<float>());
    }
    table.triangles = {{0, 1, 2}, {0, 2, 3}};
    return table;
}

PixelBox widened(PixelBox box, const Eigen::Vector2d& pixel) {
    // Silhouettes are told by pixel centres, which lie at integers.
    box.first_u = std::min(box.first_u, static_cast<int>(std::floor(pixel.x())));
    box.first_v = std::min(box.first_v, static_cast<int>(std::floor(pixel.y())));
    box.last_u = std::max(box.last_u, static_cast<int>(std::ceil(pixel.x())) + 1);
    box.last_v = std::max(box.last_v, static_cast<int>(std::ceil(pixel.y())) + 1);
    return box;
}

// A rendered frame of nothing.
RenderedFrame empty_frame(const PinholeCamera& camera) {
    const std::size_t num_pixels = static_cast<std::size_t>(camera.width) * camera.height;
    RenderedFrame frame;
    frame.image.depth = {camera.width, camera.height, std::vector<float>(num_pixels, 0.0F)};
    frame.image.object.assign(num_pixels, -1);
    frame.image.normals_in_camera.assign(num_pixels, Eigen::Vector3f::Zero());
    frame.silhouette = {camera.width, camera.height, std::vector<std::uint8_t>(num_pixels, 0)};
    frame.visible = frame.silhouette;
    return frame;
}

// Enters hit `i` at `pixel` where nothing nearer stands.
void enter(const RayHits& hits, std::size_t i, std::size_t pixel, int object, const Eigen::Matrix3f& rotation,
           RenderedImage& image) {
    float& depth = image.depth.depth_m[pixel];
    if (depth > 0.0F && hits.depth_m[i] >= depth) return;
    depth = hits.depth_m[i];
    image.object[pixel] = object;
    image.normals_in_camera[pixel] = rotation * hits.normals_in_object[i];
}

}  // namespace

PixelBox silhouette_canvas(const ModelExtent& extent, const Pose& camera_from_object, const PinholeCamera& camera) {
    const int w = camera.width, h = camera.height;
    const int margin_u = std::min(2 * w, (kMaxCanvasSide - w) / 2),
              margin_v = std::min(2 * h, (kMaxCanvasSide - h) / 2);
    const PixelBox widest{-margin_u, -margin_v, w + margin_u, h + margin_v};
    PixelBox box{0, 0, w, h};
    for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3d point;
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = (corner >> axis & 1) != 0 ? extent.box_max_in_object[axis] : extent.box_min_in_object[axis];
        }
        point = camera_from_object * point;
        if (!(point.z() > 1e-6)) return widest;
        const Eigen::Vector2d pixel = camera.project(point);
        box = widened(box, {std::clamp<double>(pixel.x(), widest.first_u, widest.last_u - 1),
                            std::clamp<double>(pixel.y(), widest.first_v, widest.last_v - 1)});
    }
    return box;
}

Scene::Scene(const Mesh& part, bool with_table) : part_(part) {
    if (with_table) table_.emplace(table_under(part_.extent()));
}

RenderedFrame Scene::render(const Pose& camera_from_object, const PinholeCamera& camera) const {
    RenderedFrame frame = empty_frame(camera);
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    // The part is cast over the whole canvas: pixels outside the image count for the visible fraction alone.
    const PixelBox box = silhouette_canvas(extent(), camera_from_object, camera);
    const PixelGrid grid{box.first_u, box.first_v, 1, box.last_u - box.first_u, box.last_v - box.first_v};
    const RayHits part = part_.cast(camera_from_object, camera_of(grid, camera));
    PixelBox silhouette{box.last_u, box.last_v, box.first_u, box.first_v};
    for (std::size_t i = 0; i < part.size(); ++i) {
        const int u = grid.image_u(part.pixels[i]), v = grid.image_v(part.pixels[i]);
        silhouette = widened(silhouette, Eigen::Vector2d(u, v));
        if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
        const std::size_t pixel = static_cast<std::size_t>(v) * camera.width + u;
        frame.silhouette.value[pixel] = 255;
        enter(part, i, pixel, kPartIndex, rotation, frame.image);
    }
    if (table_) {
        const RayHits table = table_->cast(camera_from_object, camera);
        for (std::size_t i = 0; i < table.size(); ++i) {
            enter(table, i, static_cast<std::size_t>(table.pixels[i]), kTableIndex, rotation, frame.image);
        }
    }
    for (std::size_t pixel = 0; pixel < frame.visible.value.size(); ++pixel) {
        if (frame.image.object[pixel] == kPartIndex) frame.visible.value[pixel] = 255;
    }
    frame.truth.camera_from_object = camera_from_object;
    frame.truth.silhouette_pixels = static_cast<int>(part.size());
    if (part.size() > 0) {
        frame.truth.silhouette_box = {silhouette.first_u, silhouette.first_v, silhouette.last_u - silhouette.first_u,
                                      silhouette.last_v - silhouette.first_v};
    }
    frame.truth.visible_pixels =
        static_cast<int>(std::count(frame.visible.value.begin(), frame.visible.value.end(), std::uint8_t{255}));
    frame.truth.visible_box = data_set::box_of(frame.visible);
    return frame;
}

}  // namespace nearpose::simulate
