#include "apps/scenes/scene.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose::simulate {
namespace {

constexpr int kMaxCanvasSide = 16384;  // of any camera [pixels]

PixelBox widened(PixelBox box, const Eigen::Vector2d& pixel) {
    // Silhouettes are told by pixel centres, which lie at integers.
    box.first_u = std::min(box.first_u, static_cast<int>(std::floor(pixel.x())));
    box.first_v = std::min(box.first_v, static_cast<int>(std::floor(pixel.y())));
    box.last_u = std::max(box.last_u, static_cast<int>(std::ceil(pixel.x())) + 1);
    box.last_v = std::max(box.last_v, static_cast<int>(std::ceil(pixel.y())) + 1);
    return box;
}

RenderedImage empty_image(const PinholeCamera& camera) {
    const std::size_t num_pixels = static_cast<std::size_t>(camera.width) * camera.height;
    RenderedImage image;
    image.depth = {camera.width, camera.height, std::vector<float>(num_pixels, 0.0F)};
    image.object.assign(num_pixels, -1);
    image.normals_in_camera.assign(num_pixels, Eigen::Vector3f::Zero());
    return image;
}

Mask empty_mask(const PinholeCamera& camera) {
    return {camera.width, camera.height,
            std::vector<std::uint8_t>(static_cast<std::size_t>(camera.width) * camera.height, 0)};
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

// Enters a part that the truth speaks of: it is cast over the whole canvas, for the pixels outside the image count for
// the visible fraction.
InstanceView enter_instance(const EmbreeScene& part, const Pose& camera_from_object, const PinholeCamera& camera,
                            int object, RenderedImage& image) {
    InstanceView instance;
    instance.silhouette = empty_mask(camera);
    instance.truth.camera_from_object = camera_from_object;
    const PixelBox box = silhouette_canvas(part.extent(), camera_from_object, camera);
    if (box.empty()) return instance;
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const PixelGrid grid{box.first_u, box.first_v, 1, box.last_u - box.first_u, box.last_v - box.first_v};
    const RayHits hits = part.cast(camera_from_object, camera_of(grid, camera));
    PixelBox silhouette{box.last_u, box.last_v, box.first_u, box.first_v};  // its last pixels are inside
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const int u = grid.image_u(hits.pixels[i]), v = grid.image_v(hits.pixels[i]);
        silhouette = {std::min(silhouette.first_u, u), std::min(silhouette.first_v, v), std::max(silhouette.last_u, u),
                      std::max(silhouette.last_v, v)};
        if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
        const std::size_t pixel = static_cast<std::size_t>(v) * camera.width + u;
        instance.silhouette.value[pixel] = 255;
        enter(hits, i, pixel, object, rotation, image);
    }
    instance.truth.silhouette_pixels = static_cast<int>(hits.size());
    if (hits.size() > 0) {
        instance.truth.silhouette_box = {silhouette.first_u, silhouette.first_v, silhouette.last_u - silhouette.first_u,
                                         silhouette.last_v - silhouette.first_v};
    }
    return instance;
}

InstanceView absent_instance(const Pose& camera_from_object, const PinholeCamera& camera) {
    InstanceView instance;
    instance.silhouette = empty_mask(camera);
    instance.truth.camera_from_object = camera_from_object;
    return instance;
}

// A plane needs no tree: in closed form it takes a tenth of the time, and the table is in every pixel.
void enter_table(const Table& table, const Pose& camera_from_ground, const PinholeCamera& camera, int object,
                 RenderedImage& image) {
    const Pose ground_from_camera = camera_from_ground.inverse();
    const Eigen::Matrix3d rotation = ground_from_camera.rotation_matrix();
    const Eigen::Vector3d eye = ground_from_camera.translation;
    const Eigen::Vector3f up_in_camera = rotation.row(2).transpose().cast<float>();
    const Eigen::Vector3f normal = eye.z() < 0.0 ? Eigen::Vector3f(-up_in_camera) : up_in_camera;
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            const std::size_t pixel = static_cast<std::size_t>(v) * camera.width + u;
            const Eigen::Vector3d direction = rotation * camera.ray(u, v);
            const double depth = -eye.z() / direction.z();
            if (!(depth > 0.0) || !std::isfinite(depth)) continue;
            const float nearest = image.depth.depth_m[pixel];
            if (nearest > 0.0F && static_cast<float>(depth) >= nearest) continue;
            const Eigen::Vector2d place = (eye + depth * direction).head<2>();
            if (place.cwiseAbs().maxCoeff() > table.half_side_m) continue;
            image.depth.depth_m[pixel] = static_cast<float>(depth);
            image.object[pixel] = object;
            image.normals_in_camera[pixel] = normal;
        }
    }
}

void enter_thing(const EmbreeScene& thing, const Pose& camera_from_thing, const PinholeCamera& camera, int object,
                 RenderedImage& image) {
    const RayHits hits = thing.cast(camera_from_thing, camera);
    const Eigen::Matrix3f rotation = camera_from_thing.rotation_matrix().cast<float>();
    for (std::size_t i = 0; i < hits.size(); ++i) {
        enter(hits, i, static_cast<std::size_t>(hits.pixels[i]), object, rotation, image);
    }
}

void count_visible(const RenderedImage& image, int object, const PinholeCamera& camera, InstanceView& instance) {
    instance.visible = empty_mask(camera);
    for (std::size_t pixel = 0; pixel < image.object.size(); ++pixel) {
        if (image.object[pixel] != object) continue;
        instance.visible.value[pixel] = 255;
        ++instance.truth.visible_pixels;
    }
    instance.truth.visible_box = data_set::box_of(instance.visible);
}

}  // namespace

PixelBox silhouette_canvas(const ModelExtent& extent, const Pose& camera_from_object, const PinholeCamera& camera) {
    const int w = camera.width, h = camera.height;
    const int margin_u = std::min(2 * w, (kMaxCanvasSide - w) / 2),
              margin_v = std::min(2 * h, (kMaxCanvasSide - h) / 2);
    const PixelBox widest{-margin_u, -margin_v, w + margin_u, h + margin_v};
    PixelBox box{widest.last_u, widest.last_v, widest.first_u, widest.first_v};
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

Scene::Scene(const Mesh& part, const World& world)
    : part_(part), scene_from_copies_(world.copies), table_(world.table) {
    if (world.other) {
        other_.emplace(world.other->mesh);
        scene_from_other_ = world.other->scene_from_object;
    }
    if (!world.surroundings_in_scene.triangles.empty()) surroundings_.emplace(world.surroundings_in_scene);
    if (!world.gripper_in_camera.triangles.empty()) gripper_.emplace(world.gripper_in_camera);
}

RenderedFrame Scene::render(const Pose& camera_from_object, const Pose& camera_from_scene, const PinholeCamera& camera,
                            bool with_part) const {
    RenderedFrame frame;
    frame.image = empty_image(camera);
    int object = kPartIndex;
    const auto add = [&](const EmbreeScene& part, const Pose& pose) {
        frame.instances.push_back(enter_instance(part, pose, camera, object++, frame.image));
    };
    if (with_part) {
        add(part_, camera_from_object);
    } else {
        frame.instances.push_back(absent_instance(camera_from_object, camera));
        ++object;
    }
    for (const Pose& scene_from_copy : scene_from_copies_) add(part_, camera_from_scene * scene_from_copy);
    if (other_) add(*other_, camera_from_scene * scene_from_other_);
    if (table_) enter_table(*table_, camera_from_scene * table_->scene_from_ground, camera, object++, frame.image);
    if (surroundings_) enter_thing(*surroundings_, camera_from_scene, camera, object++, frame.image);
    if (gripper_) enter_thing(*gripper_, Pose::identity(), camera, object++, frame.image);
    for (std::size_t i = 0; i < frame.instances.size(); ++i) {
        count_visible(frame.image, static_cast<int>(i), camera, frame.instances[i]);
    }
    return frame;
}

RenderedImage Scene::render_from(const Pose& viewpoint_from_camera, const Pose& camera_from_object,
                                 const Pose& camera_from_scene, const PinholeCamera& lens, bool with_part) const {
    const Pose viewpoint_from_scene = viewpoint_from_camera * camera_from_scene;
    RenderedImage image = empty_image(lens);
    int object = kPartIndex;
    if (with_part) enter_thing(part_, viewpoint_from_camera * camera_from_object, lens, object, image);
    ++object;
    for (const Pose& scene_from_copy : scene_from_copies_)
        enter_thing(part_, viewpoint_from_scene * scene_from_copy, lens, object++, image);
    if (other_) enter_thing(*other_, viewpoint_from_scene * scene_from_other_, lens, object++, image);
    if (table_) enter_table(*table_, viewpoint_from_scene * table_->scene_from_ground, lens, object++, image);
    if (surroundings_) enter_thing(*surroundings_, viewpoint_from_scene, lens, object++, image);
    if (gripper_) enter_thing(*gripper_, viewpoint_from_camera, lens, object++, image);
    return image;
}

}  // namespace nearpose::simulate
