#include "raycast/fitted_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "raycast/internal/projected_samples.hpp"

namespace nearpose {
namespace {

// Cells of the splats' buffer on a disc's radius: enough that a disc covers about its own area.
constexpr double kCellsPerRadius = 2.0;
// Of the radius: the depth behind a disc at which samples count as hidden.
constexpr double kDepthMargin = 0.2;

struct Projection {
    std::vector<ProjectedSample> samples;
    double nearest_m = std::numeric_limits<double>::infinity();  // depth of the nearest in the image
};

Projection project(const SurfaceSamples& samples, const Pose& camera_from_object, const PinholeCamera& camera,
                   double margin_m) {
    check_view(camera_from_object, camera);
    Projection projection;
    projection.samples.reserve(samples.points_in_object.size());
    project_samples(samples, camera_from_object, camera, margin_m, [&projection](const ProjectedSample& sample) {
        projection.samples.push_back(sample);
        if (sample.pixel >= 0) projection.nearest_m = std::min(projection.nearest_m, sample.point_in_camera.z());
    });
    return projection;
}

// The discs in the pixels of a camera of cells.
class SplatBuffer {
  public:
    SplatBuffer(const PinholeCamera& cells, double radius_m)
        : cells_(cells),
          radius_m_(radius_m),
          depth_m_(static_cast<std::size_t>(cells.width) * static_cast<std::size_t>(cells.height),
                   std::numeric_limits<double>::infinity()) {}

    int cell_of(const Eigen::Vector3d& point) const {
        const Eigen::Vector2d uv = cells_.project(point);
        return cells_.pixel_at(uv.x(), uv.y());
    }

    // A disc smaller than a cell still covers its own; -1 is no cell.
    void draw_centre(int cell, double depth_m) {
        if (cell >= 0) at(cell) = std::min(at(cell), depth_m);
    }

    void draw_disc(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
        const Eigen::Vector2d uv = cells_.project(point);
        const double reach_u = cells_.fx * radius_m_ / point.z(), reach_v = cells_.fy * radius_m_ / point.z();
        const int first_u = first(uv.x() - reach_u), last_u = last(uv.x() + reach_u, cells_.width);
        const int first_v = first(uv.y() - reach_v), last_v = last(uv.y() + reach_v, cells_.height);
        const double offset = normal.dot(point);
        for (int v = first_v; v <= last_v; ++v) {
            for (int u = first_u; u <= last_u; ++u) {
                // Where the ray through the cell's centre meets the disc's plane; NaN where the two are parallel.
                const Eigen::Vector3d ray = cells_.ray(u, v);
                const double depth = offset / normal.dot(ray);
                double& nearest = at(v * cells_.width + u);
                if (!(depth > 0.0 && depth < nearest)) continue;
                if ((depth * ray - point).squaredNorm() <= radius_m_ * radius_m_) nearest = depth;
            }
        }
    }

    bool hides(int cell, double depth_m) const {
        return cell >= 0 && depth_m > depth_m_[static_cast<std::size_t>(cell)] + kDepthMargin * radius_m_;
    }

  private:
    double& at(int cell) { return depth_m_[static_cast<std::size_t>(cell)]; }
    static int first(double from) { return static_cast<int>(std::ceil(std::max(from, 0.0))); }
    static int last(double to, int count) { return static_cast<int>(std::floor(std::min(to, count - 1.0))); }

    const PinholeCamera cells_;
    const double radius_m_;
    std::vector<double> depth_m_;
};

}  // namespace

Eigen::Array2d cell_size_px(double area_m2, double depth_m, const PinholeCamera& camera) {
    return (Eigen::Array2d(camera.fx, camera.fy) * std::sqrt(area_m2) / depth_m).max(1.0);
}

PinholeCamera camera_of_cells(const Eigen::Array2d& cell_px, const PinholeCamera& camera) {
    const double width = std::min(cell_px.x(), static_cast<double>(camera.width));
    const double height = std::min(cell_px.y(), static_cast<double>(camera.height));
    // Pixel 0 reaches from -0.5 to 0.5, in both images.
    return {static_cast<int>(std::ceil(camera.width / width)),
            static_cast<int>(std::ceil(camera.height / height)),
            camera.fx / width,
            camera.fy / height,
            (camera.cx + 0.5) / width - 0.5,
            (camera.cy + 0.5) / height - 0.5};
}

View nearest_of_cells(const SurfaceSamples& samples, double cell_area_m2, const Pose& camera_from_object,
                      const PinholeCamera& camera) {
    const Projection projection = project(samples, camera_from_object, camera, 0.0);
    NearestSamples pixels(camera);
    if (!projection.samples.empty()) {
        const PinholeCamera cells_camera =
            camera_of_cells(cell_size_px(cell_area_m2, projection.nearest_m, camera), camera);
        NearestSamples cells(cells_camera);
        for (std::size_t i = 0; i < projection.samples.size(); ++i) {
            const Eigen::Vector3d& point = projection.samples[i].point_in_camera;
            const Eigen::Vector2d uv = cells_camera.project(point);
            const int cell = cells_camera.pixel_at(uv.x(), uv.y());
            if (cell >= 0) cells.draw(cell, point.z(), static_cast<int>(i));
        }
        for (const int kept : cells.kept) {
            if (kept < 0) continue;
            const ProjectedSample& sample = projection.samples[static_cast<std::size_t>(kept)];
            pixels.draw(sample.pixel, sample.point_in_camera.z(), sample.sample);
        }
    }
    return view_of(samples, pixels.kept, camera_from_object);
}

namespace {

void draw_splats(const SurfaceSamples& samples, const Projection& projection, const Eigen::Matrix3d& rotation,
                 SplatBuffer& splats, NearestSamples& pixels) {
    std::vector<int> cells;
    cells.reserve(projection.samples.size());
    for (const ProjectedSample& sample : projection.samples) {
        cells.push_back(splats.cell_of(sample.point_in_camera));
        splats.draw_centre(cells.back(), sample.point_in_camera.z());
    }
    for (std::size_t k = 0; k < cells.size(); ++k) {
        const ProjectedSample& sample = projection.samples[k];
        // What is hidden hides nothing more: most of the surface need not be drawn.
        if (splats.hides(cells[k], sample.point_in_camera.z())) continue;
        const auto i = static_cast<std::size_t>(sample.sample);
        splats.draw_disc(sample.point_in_camera, rotation * samples.normals_in_object[i].cast<double>());
    }
    for (std::size_t k = 0; k < cells.size(); ++k) {
        const ProjectedSample& sample = projection.samples[k];
        if (sample.pixel < 0 || splats.hides(cells[k], sample.point_in_camera.z())) continue;
        pixels.draw(sample.pixel, sample.point_in_camera.z(), sample.sample);
    }
}

}  // namespace

View points_before_splats(const SurfaceSamples& samples, double splat_area_m2, const Pose& camera_from_object,
                          const PinholeCamera& camera) {
    const double radius_m = std::sqrt(splat_area_m2 / std::numbers::pi);
    // Discs reach into the image from beside it.
    const Projection projection = project(samples, camera_from_object, camera, radius_m);
    NearestSamples pixels(camera);
    if (std::isfinite(projection.nearest_m)) {
        const double cell_m = radius_m / kCellsPerRadius;
        SplatBuffer splats(camera_of_cells(cell_size_px(cell_m * cell_m, projection.nearest_m, camera), camera),
                           radius_m);
        draw_splats(samples, projection, camera_from_object.rotation_matrix(), splats, pixels);
    }
    return view_of(samples, pixels.kept, camera_from_object);
}

}  // namespace nearpose
