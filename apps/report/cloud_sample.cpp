#include "apps/report/cloud_sample.hpp"

#include <algorithm>
#include <cmath>

namespace nearpose::report {
namespace {

std::size_t image_pixel(const PixelGrid& grid, int index, const PinholeCamera& camera) {
    return static_cast<std::size_t>(grid.image_v(index)) * camera.width + grid.image_u(index);
}

// The finest grid that holds at most `max_points` pixels of `state`.
PixelGrid grid_of(const Observation& observation, const PixelBox& box, PixelState state, int max_points) {
    const PinholeCamera& camera = observation.camera();
    for (int stride = 1;; ++stride) {
        const PixelGrid grid{box.first_u, box.first_v, stride, (box.last_u - box.first_u + stride - 1) / stride,
                             (box.last_v - box.first_v + stride - 1) / stride};
        int count = 0;
        for (int i = 0; i < grid.size(); ++i) {
            if (observation.states()[image_pixel(grid, i, camera)] == state) ++count;
        }
        if (count <= max_points) return grid;
    }
}

std::int16_t residual_of(double measured_m, double model_m) {
    if (!(model_m > 0.0)) return kNoResidual;
    return static_cast<std::int16_t>(std::lround(std::clamp((measured_m - model_m) / kResidualUnitM, -3e4, 3e4)));
}

}  // namespace

CloudSample sample_cloud(const Observation& observation, const EmbreeScene& model,
                         const std::optional<Pose>& camera_from_object, int max_points, double max_depth_m) {
    const PinholeCamera& camera = observation.camera();
    CloudSample sample;
    if (!observation.candidate_box().empty()) {
        const PixelGrid grid = grid_of(observation, observation.candidate_box(), PixelState::kCandidate, max_points);
        std::vector<float> model_depth_m(static_cast<std::size_t>(grid.size()), 0.0F);
        if (camera_from_object && is_valid(*camera_from_object)) {
            const RayHits hits = model.cast(*camera_from_object, camera_of(grid, camera));
            for (std::size_t i = 0; i < hits.size(); ++i) model_depth_m[hits.pixels[i]] = hits.depth_m[i];
        }
        for (int i = 0; i < grid.size(); ++i) {
            const std::size_t pixel = image_pixel(grid, i, camera);
            const float depth_m = observation.depth_m()[pixel];
            if (observation.states()[pixel] != PixelState::kCandidate || depth_m > max_depth_m) continue;
            sample.points_in_camera.push_back(observation.point_at(static_cast<int>(pixel)).cast<float>());
            sample.residuals.push_back(residual_of(depth_m, model_depth_m[i]));
        }
    }
    sample.on_part = sample.points_in_camera.size();
    const PixelGrid grid =
        grid_of(observation, {0, 0, camera.width, camera.height}, PixelState::kBackground, max_points / 2);
    for (int i = 0; i < grid.size(); ++i) {
        const std::size_t pixel = image_pixel(grid, i, camera);
        if (observation.states()[pixel] != PixelState::kBackground || observation.depth_m()[pixel] > max_depth_m)
            continue;
        sample.points_in_camera.push_back(observation.point_at(static_cast<int>(pixel)).cast<float>());
    }
    return sample;
}

}  // namespace nearpose::report
