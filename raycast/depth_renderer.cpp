#include "raycast/depth_renderer.hpp"

#include <stdexcept>

namespace nearpose {
namespace {

DepthImage empty_image(const PinholeCamera& camera) {
    validate(camera);
    const std::size_t num_pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
    return {camera.width, camera.height, std::vector<float>(num_pixels, 0.0F)};
}

}  // namespace

DepthImage render_depth(const EmbreeScene& scene, const Pose& camera_from_object, const PinholeCamera& camera) {
    DepthImage image = empty_image(camera);
    const RayHits hits = scene.cast(camera_from_object, camera);
    for (std::size_t i = 0; i < hits.size(); ++i) {
        image.depth_m[static_cast<std::size_t>(hits.pixels[i])] = hits.depth_m[i];
    }
    return image;
}

RenderedImage render(std::span<const SceneObject> objects, const PinholeCamera& camera) {
    RenderedImage image;
    image.depth = empty_image(camera);
    image.object.assign(image.depth.depth_m.size(), -1);
    image.normals_in_camera.assign(image.depth.depth_m.size(), Eigen::Vector3f::Zero());
    for (std::size_t k = 0; k < objects.size(); ++k) {
        if (objects[k].scene == nullptr) throw std::invalid_argument("render: an object has no scene");
        const RayHits hits = objects[k].scene->cast(objects[k].camera_from_object, camera);
        const Eigen::Matrix3f rotation = objects[k].camera_from_object.rotation_matrix().cast<float>();
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const auto pixel = static_cast<std::size_t>(hits.pixels[i]);
            float& depth = image.depth.depth_m[pixel];
            if (depth > 0.0F && !(hits.depth_m[i] < depth)) continue;
            depth = hits.depth_m[i];
            image.object[pixel] = static_cast<int>(k);
            image.normals_in_camera[pixel] = rotation * hits.normals_in_object[i];
        }
    }
    return image;
}

}  // namespace nearpose
