#include "raycast/embree_view_generator.hpp"

#include <utility>

namespace nearpose {

EmbreeViewGenerator::EmbreeViewGenerator(const Mesh& mesh) : scene_(mesh) {}

View EmbreeViewGenerator::generate(const Pose& camera_from_object, const PinholeCamera& camera) const {
    RayHits hits = scene_.cast(camera_from_object, camera);
    return {std::move(hits.points_in_object), std::move(hits.normals_in_object), std::move(hits.pixels)};
}

}  // namespace nearpose
