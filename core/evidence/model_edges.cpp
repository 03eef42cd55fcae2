#include "core/evidence/model_edges.hpp"

#include <cmath>

namespace nearpose {

std::vector<int> rays_on_grid(const View& view, const PixelGrid& grid) {
    std::vector<int> ray_at(static_cast<std::size_t>(grid.size()), -1);
    for (std::size_t k = 0; k < view.size(); ++k) ray_at[view.pixels[k]] = static_cast<int>(k);
    return ray_at;
}

namespace {

bool is_at_model_step(std::size_t k, const View& view, const std::vector<int>& ray_at, const PixelGrid& grid, int reach,
                      float step_m) {
    const int u = view.pixels[k] % grid.width, v = view.pixels[k] / grid.width;
    for (int dv = -reach; dv <= reach; dv += reach) {
        for (int du = -reach; du <= reach; du += reach) {
            const int other_u = u + du, other_v = v + dv;
            if (other_u < 0 || other_v < 0 || other_u >= grid.width || other_v >= grid.height) continue;
            const int other = ray_at[other_v * grid.width + other_u];
            if (other < 0) return true;
            const Eigen::Vector3f between = view.points_in_object[other] - view.points_in_object[k];
            if (std::abs(view.normals_in_object[k].dot(between)) > step_m) return true;
        }
    }
    return false;
}

}  // namespace

std::vector<char> rays_at_steps(const View& view, const ObservedGrid& observed, int reach, double step_sigmas) {
    std::vector<char> at_step(view.size(), 0);
    if (reach == 0) return at_step;
    const std::vector<int> ray_at = rays_on_grid(view, observed.grid);
    for (std::size_t k = 0; k < view.size(); ++k) {
        const auto step_m = static_cast<float>(step_sigmas * observed.sigma_m[view.pixels[k]]);
        at_step[k] = is_at_model_step(k, view, ray_at, observed.grid, reach, step_m);
    }
    return at_step;
}

}  // namespace nearpose
