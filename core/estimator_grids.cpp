// Part of PoseEstimator: the pixels through which rays are cast.
#include <Eigen/Geometry>
#include <algorithm>

#include "core/estimator.hpp"

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

constexpr double kMargin = 0.2;  // of the box: model beyond the seen object must be able to show

// The part of the image in which the model's box lies; none where a corner comes close to the camera's plane.
std::optional<PixelBox> box_of_model(const Pose& camera_from_object, const ModelExtent& extent,
                                     const PinholeCamera& camera) {
    Eigen::AlignedBox2d pixels;
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d upper((corner & 1) != 0, (corner & 2) != 0, (corner & 4) != 0);
        const Eigen::Vector3d point =
            camera_from_object *
            Eigen::Vector3d(extent.box_min_in_object +
                            upper.cwiseProduct(extent.box_max_in_object - extent.box_min_in_object));
        if (!(point.z() > 0.1 * extent.diameter_m())) return std::nullopt;
        pixels.extend(camera.project(point));
    }
    const Eigen::Vector2d size(camera.width, camera.height);
    const Eigen::Vector2d first = pixels.min().array().floor().max(0.0).min(size.array());
    const Eigen::Vector2d last = (pixels.max().array().floor() + 1.0).max(0.0).min(size.array());
    return PixelBox{static_cast<int>(first.x()), static_cast<int>(first.y()), static_cast<int>(last.x()),
                    static_cast<int>(last.y())};
}

}  // namespace

// The part of the image in which the model lies at a pose; the whole image where it comes close to the camera.
PixelBox PoseEstimator::box_around(const Pose& camera_from_object, const Observation& observation) const {
    const PinholeCamera& camera = observation.camera();
    const Eigen::Vector3d centre = camera_from_object * views_->extent().centre_in_object();
    const double radius_m = 0.5 * views_->extent().diameter_m();
    if (!(centre.z() > 1.2 * radius_m)) return observation.candidate_box();
    const Eigen::Vector2d uv = camera.project(centre);
    const double radius = camera.fx * radius_m / (centre.z() - radius_m);
    constexpr double kFar = 1e6;  // pixels: an int must hold it
    const auto pixel = [&](double value) { return static_cast<int>(std::clamp(value, -kFar, kFar)); };
    return {pixel(uv.x() - radius), pixel(uv.y() - radius), pixel(uv.x() + radius), pixel(uv.y() + radius)};
}

// The fine fit has use for rays only where the model meets what was measured.
PixelGrid PoseEstimator::grid_to_fit(const Pose& camera_from_object, const Observation& observation,
                                     int max_rays) const {
    PixelBox box = observation.candidate_box();
    if (const auto model = box_of_model(camera_from_object, views_->extent(), observation.camera())) {
        box = {std::max(box.first_u, model->first_u), std::max(box.first_v, model->first_v),
               std::min(box.last_u, model->last_u), std::min(box.last_v, model->last_v)};
    }
    return grid_in(box, 0.0, observation.camera(), max_rays);
}

PixelGrid PoseEstimator::grid_around(const Pose& camera_from_object, const Observation& observation,
                                     int max_rays) const {
    return grid_in(box_around(camera_from_object, observation), 0.0, observation.camera(), max_rays);
}

// Views are cast where the object may be: around the segmented pixels, or around the tracked pose, or everywhere.
PixelGrid PoseEstimator::grid_for(const Observation& observation, int max_rays) const {
    if (observation.segmented()) return grid_in(observation.candidate_box(), kMargin, observation.camera(), max_rays);
    PixelBox box = observation.candidate_box();
    if (close_up_)
        box = box_around(*close_up_, observation);
    else if (tracked_ && !searching_)
        box = box_around(tracked_->camera_from_object, observation);
    return grid_in(box, kMargin, observation.camera(), max_rays);
}

}  // namespace nearpose
