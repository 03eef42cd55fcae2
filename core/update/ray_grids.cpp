#include "core/update/ray_grids.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace nearpose {
namespace {

PixelGrid grid_in(PixelBox box, double margin, const PinholeCamera& camera, int max_rays) {
    const int margin_u = static_cast<int>(margin * (box.last_u - box.first_u));
    const int margin_v = static_cast<int>(margin * (box.last_v - box.first_v));
    box = {std::max(0, box.first_u - margin_u), std::max(0, box.first_v - margin_v),
           std::min(camera.width, box.last_u + margin_u), std::min(camera.height, box.last_v + margin_v)};
    if (box.empty()) box = {0, 0, camera.width, camera.height};
    return grid_over(box, max_rays);
}

// The image of the model's box; none where a corner comes close to the camera's plane.
std::optional<PixelBox> box_of_model(const Pose& camera_from_object, const ModelExtent& extent,
                                     const PinholeCamera& camera) {
    constexpr double kNearDiameters = 0.1;
    Eigen::AlignedBox2d pixels;
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d upper((corner & 1) != 0, (corner & 2) != 0, (corner & 4) != 0);
        const Eigen::Vector3d point =
            camera_from_object *
            Eigen::Vector3d(extent.box_min_in_object +
                            upper.cwiseProduct(extent.box_max_in_object - extent.box_min_in_object));
        if (!(point.z() > kNearDiameters * extent.diameter_m())) return std::nullopt;
        pixels.extend(camera.project(point));
    }
    const Eigen::Vector2d size(camera.width, camera.height);
    const Eigen::Vector2d first = pixels.min().array().floor().max(0.0).min(size.array());
    const Eigen::Vector2d last = (pixels.max().array().floor() + 1.0).max(0.0).min(size.array());
    return PixelBox{static_cast<int>(first.x()), static_cast<int>(first.y()), static_cast<int>(last.x()),
                    static_cast<int>(last.y())};
}

// The image of the sphere around the model's box; all that was measured where the sphere comes close to the camera.
PixelBox box_around(const Frame& frame, const Pose& camera_from_object) {
    constexpr double kNearRadii = 1.2;
    constexpr double kFar = 1e6;  // pixels: an int must hold it
    const PinholeCamera& camera = frame.observation.camera();
    const Eigen::Vector3d centre = camera_from_object * frame.model.centre_in_object();
    const double radius_m = 0.5 * frame.model.diameter_m();
    if (!(centre.z() > kNearRadii * radius_m)) return frame.observation.candidate_box();
    const Eigen::Vector2d uv = camera.project(centre);
    const double radius = camera.fx * radius_m / (centre.z() - radius_m);
    const auto pixel = [&](double value) { return static_cast<int>(std::clamp(value, -kFar, kFar)); };
    return {pixel(uv.x() - radius), pixel(uv.y() - radius), pixel(uv.x() + radius), pixel(uv.y() + radius)};
}

}  // namespace

PixelGrid ray_grid(const Frame& frame, const std::optional<Pose>& around, int max_rays) {
    const Observation& observation = frame.observation;
    const bool everywhere = observation.segmented() || !around;
    const PixelBox box = everywhere ? observation.candidate_box() : box_around(frame, *around);
    return grid_in(box, frame.method().window_margin, observation.camera(), max_rays);
}

PixelGrid ray_grid_on_model(const Frame& frame, const Pose& camera_from_object, int max_rays) {
    return grid_in(box_around(frame, camera_from_object), 0.0, frame.observation.camera(), max_rays);
}

PixelGrid ray_grid_to_fit(const Frame& frame, const Pose& camera_from_object, int max_rays) {
    const PinholeCamera& camera = frame.observation.camera();
    PixelBox box = frame.observation.candidate_box();
    if (const auto model = box_of_model(camera_from_object, frame.model.extent(), camera)) {
        box = {std::max(box.first_u, model->first_u), std::max(box.first_v, model->first_v),
               std::min(box.last_u, model->last_u), std::min(box.last_v, model->last_v)};
    }
    return grid_in(box, 0.0, camera, max_rays);
}

}  // namespace nearpose
