#include "apps/pictures/model_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "raycast/depth_renderer.hpp"

namespace nearpose::pictures {
namespace {

constexpr float kCreaseCosine = 0.82F;   // normals 35 degrees apart; the facets of a round surface are nearer
constexpr double kJumpDiameters = 0.01;  // a surface this far behind another's continuation is a new one
constexpr int kMargin = 2;               // around the model's box [pixels]

// The part of the image that the model's box covers; everything where the box reaches behind the camera.
PixelBox box_in_image(const ModelExtent& extent, const Pose& camera_from_object, const PinholeCamera& camera) {
    Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
    for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d corner((i & 1 ? extent.box_max_in_object : extent.box_min_in_object).x(),
                                     (i & 2 ? extent.box_max_in_object : extent.box_min_in_object).y(),
                                     (i & 4 ? extent.box_max_in_object : extent.box_min_in_object).z());
        const Eigen::Vector3d corner_in_camera = camera_from_object * corner;
        if (corner_in_camera.z() < 1e-3) return {0, 0, camera.width, camera.height};
        const Eigen::Vector2d uv = camera.project(corner_in_camera);
        low = low.cwiseMin(uv);
        high = high.cwiseMax(uv);
    }
    const auto bounded = [](double value, int limit) {
        return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
    };
    return {bounded(low.x() - kMargin, camera.width), bounded(low.y() - kMargin, camera.height),
            bounded(high.x() + kMargin + 1, camera.width), bounded(high.y() + kMargin + 1, camera.height)};
}

class EdgeFinder {
  public:
    EdgeFinder(const RenderedImage& image, const PinholeCamera& camera, double jump_m)
        : image_(image), camera_(camera), jump_m_(jump_m) {}

    Edge between(int a, int b) const {
        const bool hit_a = image_.depth.depth_m[a] > 0.0F, hit_b = image_.depth.depth_m[b] > 0.0F;
        if (hit_a != hit_b) return Edge::kOutline;
        if (!hit_a) return Edge::kNone;
        // A slanted surface changes its depth as well: only what leaves the planes of both pixels is a jump.
        if (std::min(gap_m(a, b), gap_m(b, a)) > jump_m_) return Edge::kOutline;
        return image_.normals_in_camera[a].dot(image_.normals_in_camera[b]) < kCreaseCosine ? Edge::kCrease
                                                                                            : Edge::kNone;
    }

  private:
    Eigen::Vector3d ray(int pixel) const { return camera_.ray(pixel % camera_.width, pixel / camera_.width); }

    // Distance along b's ray from the plane of a's surface to b's surface.
    double gap_m(int a, int b) const {
        const Eigen::Vector3d normal = image_.normals_in_camera[a].cast<double>();
        const double slope = normal.dot(ray(b));
        const double depth_a_m = image_.depth.depth_m[a], depth_b_m = image_.depth.depth_m[b];
        if (std::abs(slope) < 1e-6) return std::abs(depth_a_m - depth_b_m);
        return std::abs(depth_a_m * normal.dot(ray(a)) / slope - depth_b_m);
    }

    const RenderedImage& image_;
    const PinholeCamera& camera_;
    double jump_m_;
};

}  // namespace

OutlineImage find_outline(const EmbreeScene& model, const Pose& camera_from_object, const PinholeCamera& camera) {
    const PixelBox box = box_in_image(model.extent(), camera_from_object, camera);
    if (box.empty()) return {};
    PinholeCamera part = camera;
    part.width = box.last_u - box.first_u;
    part.height = box.last_v - box.first_v;
    part.cx -= box.first_u;
    part.cy -= box.first_v;
    const SceneObject object{&model, camera_from_object};
    const RenderedImage image = render({&object, 1}, part);
    const EdgeFinder finder(image, part, kJumpDiameters * model.extent().diameter_m());

    OutlineImage outline{box.first_u, box.first_v, part.width, part.height, {}};
    outline.edges.assign(image.depth.depth_m.size(), Edge::kNone);
    const auto mark = [&](int a, int b) {
        const Edge edge = finder.between(a, b);
        outline.edges[a] = std::max(outline.edges[a], edge);
        outline.edges[b] = std::max(outline.edges[b], edge);
    };
    for (int v = 0; v < part.height; ++v) {
        for (int u = 0; u < part.width; ++u) {
            const int pixel = v * part.width + u;
            if (u + 1 < part.width) mark(pixel, pixel + 1);
            if (v + 1 < part.height) mark(pixel, pixel + part.width);
        }
    }
    return outline;
}

}  // namespace nearpose::pictures
