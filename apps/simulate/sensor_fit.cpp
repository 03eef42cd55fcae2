#include "apps/simulate/sensor_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/data_set/number_text.hpp"
#include "apps/simulate/noise_figures.hpp"

namespace nearpose::simulate {
namespace {

using data_set::format_fixed;

constexpr int kDepthBins = 160, kAngleBins = 36;  // of 10 % and of 2.5 degrees
constexpr double kLeastEffective = 30.0;          // pixels of a cell
constexpr double kLeastDepthRatio = 1.2;          // of the cells, to tell the growth with depth from the floor
constexpr double kLeastAngleTerm = 0.15;          // between the cells: 0 and 25 degrees

// Frames that show the wall from one pose.
struct WallPose {
    std::vector<std::size_t> frames;
    WallPlane plane;  // of the first of them
};

struct Wall {
    std::span<const WallFrame> frames;
    PixelBox region;
    std::vector<WallPlane> planes;  // one a frame
    std::vector<WallPose> poses;
    bool separated = false;

    int width() const { return region.last_u - region.first_u; }
    int size() const { return width() * (region.last_v - region.first_v); }
    const PinholeCamera& camera(const WallPose& pose) const { return frames[pose.frames.front()].camera; }
    Eigen::Vector3d ray(const PinholeCamera& camera, int pixel) const {
        return camera.ray(region.first_u + pixel % width(), region.first_v + pixel / width());
    }
    double depth_m(const WallFrame& frame, int pixel) const {
        const int u = region.first_u + pixel % width(), v = region.first_v + pixel / width();
        return frame.depth.depth_m[static_cast<std::size_t>(v) * frame.camera.width + u];
    }
};

// Sums over the pixels of all poses.
struct Measured {
    std::vector<NoiseCell> cells;
    std::vector<WallGroup> groups;
    std::array<double, kLags> products{};  // of neighbours' deviations
    double squares = 0.0;                  // of as many deviations
    double bias_square_sum = 0.0;
    double bias_pixels = 0.0;
};

// What a pose's pixels have in common for all its frames.
struct PixelGeometry {
    std::vector<float> expected_m, step_m;
};

struct PixelSums {
    int count = 0;
    double sum = 0.0, squares = 0.0;

    void add(double value) {
        ++count;
        sum += value;
        squares += value * value;
    }
    double mean() const { return count == 0 ? 0.0 : sum / count; }
};

std::string not_flat(const WallFrame& frame, const WallFit& fit) {
    return "the frames do not show a flat wall: frame " + std::to_string(frame.id) + " departs from its plane by RMS " +
           format_fixed(1e3 * fit.rms_m, 2) + " mm (expected " + format_fixed(1e3 * fit.expected_m, 2) + " mm), " +
           format_fixed(100.0 * fit.outlier_share, 0) + " % of its pixels are outliers and " +
           format_fixed(100.0 * fit.structured_share, 0) +
           " % of the rest's variance is shared by neighbours; use --region to leave out what is not wall";
}

bool is_flat(const WallFit& fit, const SensorFitOptions& options) {
    if (fit.outlier_share > options.max_outlier_share) return false;
    // A sensor that is merely noisier than its base shows no structure.
    return fit.rms_m <= options.max_rms_ratio * fit.expected_m || fit.structured_share < 0.5;
}

bool same_pose(const WallPlane& a, const WallPlane& b, const PinholeCamera& camera, const PixelBox& region,
               double tolerance_m) {
    const double middle_m =
        a.depth_m(camera.ray(0.5 * (region.first_u + region.last_u), 0.5 * (region.first_v + region.last_v)));
    for (const int u : {region.first_u, region.last_u - 1}) {
        for (const int v : {region.first_v, region.last_v - 1}) {
            // dz = z^2 d(1/z), z being the middle's: a steep wall's far corner, which noise moves most, may be metres
            // away or behind the camera.
            const double difference_m = (a.inverse_m - b.inverse_m).dot(camera.ray(u, v)) * middle_m * middle_m;
            if (!(std::abs(difference_m) <= tolerance_m)) return false;
        }
    }
    return true;
}

void add_to_pose(Wall& wall, std::size_t frame, const WallPlane& plane, double tolerance_m) {
    for (WallPose& pose : wall.poses) {
        if (!same_pose(pose.plane, plane, wall.camera(pose), wall.region, tolerance_m)) continue;
        pose.frames.push_back(frame);
        return;
    }
    wall.poses.push_back({{frame}, plane});
}

void check_sizes(std::span<const WallFrame> frames) {
    if (frames.empty()) throw std::runtime_error("no frames of a wall were given");
    for (const WallFrame& frame : frames) {
        const PinholeCamera& first = frames.front().camera;
        if (frame.camera.width != first.width || frame.camera.height != first.height ||
            frame.depth.width != first.width || frame.depth.height != first.height) {
            throw std::invalid_argument("frame " + std::to_string(frame.id) + " is not of the first frame's size");
        }
    }
}

// The frames' planes, by pose. Poses of one frame are left out where others have several.
Wall wall_of(std::span<const WallFrame> frames, const WallSensor& sensor, const SensorFitOptions& options,
             std::vector<std::string>& notes) {
    check_sizes(frames);
    Wall wall{frames, region_of(frames.front().camera, options.region), {}, {}, false};
    int sparse = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const std::optional<WallFit> fit = fit_wall_plane(frames[i], wall.region, sensor, options.min_pixels);
        wall.planes.push_back(fit ? fit->plane : WallPlane{});
        if (!fit) {
            ++sparse;
            continue;
        }
        if (!is_flat(*fit, options)) throw std::runtime_error(not_flat(frames[i], *fit));
        add_to_pose(wall, i, fit->plane, options.same_pose_m);
    }
    const std::string few = " frames have fewer than " + std::to_string(options.min_pixels) +
                            " pixels with depth in the region of " + std::to_string(wall.size());
    if (wall.poses.empty()) {
        throw std::runtime_error("all " + std::to_string(sparse) + few + "; use a larger --region or a nearer wall");
    }
    if (sparse > 0) notes.push_back(std::to_string(sparse) + few + " and are left out");
    const auto alone = [](const WallPose& pose) { return pose.frames.size() == 1; };
    const auto singles = std::count_if(wall.poses.begin(), wall.poses.end(), alone);
    wall.separated = singles < static_cast<std::ptrdiff_t>(wall.poses.size());
    if (wall.separated && singles > 0) {
        std::erase_if(wall.poses, alone);
        notes.push_back(std::to_string(singles) +
                        " frames are alone in their pose and left out: only frames of one pose tell noise from fixed "
                        "error");
    }
    return wall;
}

PixelGeometry geometry_of(const Wall& wall, const WallPose& pose, const WallSensor& sensor) {
    const PinholeCamera& camera = wall.camera(pose);
    PixelGeometry geometry;
    for (int pixel = 0; pixel < wall.size(); ++pixel) {
        const Eigen::Vector3d ray = wall.ray(camera, pixel);
        const bool seen = pose.plane.inverse_m.dot(ray) > 1e-3;  // nearer than a kilometre
        geometry.expected_m.push_back(seen ? static_cast<float>(expected_sigma_m(sensor, camera, pose.plane, ray))
                                           : 0.0F);
        geometry.step_m.push_back(seen ? static_cast<float>(depth_step_m(sensor, camera, pose.plane.depth_m(ray)))
                                       : 0.0F);
    }
    return geometry;
}

// Depth less the plane's, by pixel of the region [m]; NaN where there is none or an outlier.
std::vector<double> residuals_of(const Wall& wall, std::size_t frame_index, const PixelGeometry& geometry,
                                 double spread) {
    const WallFrame& frame = wall.frames[frame_index];
    const WallPlane& plane = wall.planes[frame_index];
    std::vector<double> residuals(static_cast<std::size_t>(wall.size()), std::numeric_limits<double>::quiet_NaN());
    for (int pixel = 0; pixel < wall.size(); ++pixel) {
        const auto index = static_cast<std::size_t>(pixel);
        const double depth_m = wall.depth_m(frame, pixel);
        if (!(depth_m > 0.0) || geometry.expected_m[index] == 0.0F) continue;
        const double residual_m = depth_m - plane.depth_m(wall.ray(frame.camera, pixel));
        if (is_outlier(residual_m, geometry.expected_m[index], spread, geometry.step_m[index])) continue;
        residuals[index] = residual_m;
    }
    return residuals;
}

// Products of neighbouring deviations along rows and columns, in expected standard deviations.
void add_autocorrelation(const Wall& wall, const std::vector<double>& deviations, Measured& measured) {
    const int width = wall.width(), height = wall.size() / width;
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            const auto here = static_cast<std::size_t>(v * width + u);
            if (u + kLags >= width || v + kLags >= height) continue;
            bool all = true;  // the same pixels for every lag
            for (int lag = 0; lag <= kLags; ++lag) {
                all = all && std::isfinite(deviations[here + lag]) && std::isfinite(deviations[here + lag * width]);
            }
            if (!all) continue;
            measured.squares += deviations[here] * deviations[here];
            for (int lag = 1; lag <= kLags; ++lag) {
                measured.products[static_cast<std::size_t>(lag - 1)] +=
                    0.5 * deviations[here] * (deviations[here + lag] + deviations[here + lag * width]);
            }
        }
    }
}

// Adds a pixel to the mean of its cell; divided by the cell's freedom at the end.
void add_pixel(NoiseCell& cell, const SensorNoise& noise, double depth_m, double angle_rad, double other_variance,
               double freedom, double square_sum) {
    const double far_m = depth_m - noise.sigma_least_at_m;
    const double ratio = std::min(angle_rad, 1.5) / (M_PI / 2 - std::min(angle_rad, 1.5));
    cell.freedom += freedom;
    cell.depth_m += freedom * depth_m;
    cell.angle_rad += freedom * angle_rad;
    cell.depth_term += freedom * far_m * far_m;
    cell.angle_term += freedom * ratio * ratio;
    cell.other_variance += freedom * other_variance;
    cell.sigma_m += square_sum;
}

void finish_cell(NoiseCell& cell) {
    for (double* sum :
         {&cell.depth_m, &cell.angle_rad, &cell.depth_term, &cell.angle_term, &cell.other_variance, &cell.sigma_m}) {
        *sum /= cell.freedom;
    }
    cell.sigma_m = std::sqrt(cell.sigma_m);
}

// The scatter of each pixel of a pose, put into cells; fixed error beside it.
void add_cells(const Wall& wall, const WallPose& pose, const WallSensor& sensor, const std::vector<PixelSums>& pixels,
               Measured& measured) {
    WallGroup group{.frames = static_cast<int>(pose.frames.size()), .min_depth_m = 1e9, .min_angle_rad = 1e9};
    std::vector<NoiseCell> cells(static_cast<std::size_t>(kDepthBins) * kAngleBins);
    double bias_square_sum = 0.0;
    for (int pixel = 0; pixel < wall.size(); ++pixel) {
        const PixelSums& sums = pixels[static_cast<std::size_t>(pixel)];
        if (sums.count < (wall.separated ? 2 : 1)) continue;
        const PinholeCamera& camera = wall.camera(pose);
        const Eigen::Vector3d ray = wall.ray(camera, pixel);
        const double depth_m = pose.plane.depth_m(ray), angle_rad = pose.plane.angle_rad(ray);
        const double freedom = wall.separated ? sums.count - 1 : sums.count;
        const double about_m = wall.separated ? sums.mean() : 0.0;
        const double square_sum = std::max(0.0, sums.squares - sums.count * about_m * about_m);
        const int depth_bin = std::clamp(static_cast<int>(std::floor(std::log(depth_m) / 0.1)) + 70, 0, kDepthBins - 1);
        const int angle_bin = std::min(static_cast<int>(angle_rad / (M_PI / 72)), kAngleBins - 1);
        add_pixel(cells[static_cast<std::size_t>(depth_bin * kAngleBins + angle_bin)], sensor.noise, depth_m, angle_rad,
                  other_variance(sensor, camera, pose.plane, depth_m), freedom, square_sum);
        // The mean holds a part of the noise, too.
        bias_square_sum += about_m * about_m - square_sum / freedom / sums.count;
        ++group.pixels;
        group.min_depth_m = std::min(group.min_depth_m, depth_m);
        group.max_depth_m = std::max(group.max_depth_m, depth_m);
        group.min_angle_rad = std::min(group.min_angle_rad, angle_rad);
        group.max_angle_rad = std::max(group.max_angle_rad, angle_rad);
    }
    for (NoiseCell& cell : cells) {
        if (cell.freedom == 0.0) continue;
        finish_cell(cell);
        cell.group = static_cast<int>(measured.groups.size());
        measured.cells.push_back(cell);
    }
    if (wall.separated && group.pixels > 0) {
        group.bias_m = std::sqrt(std::max(0.0, bias_square_sum / group.pixels));
        measured.bias_square_sum += bias_square_sum;
        measured.bias_pixels += group.pixels;
    }
    measured.groups.push_back(group);
}

Measured measure(const Wall& wall, const WallSensor& sensor) {
    Measured measured;
    for (const WallPose& pose : wall.poses) {
        const PixelGeometry geometry = geometry_of(wall, pose, sensor);
        std::vector<PixelSums> pixels(static_cast<std::size_t>(wall.size()));
        std::vector<double> spreads;
        for (const std::size_t frame : pose.frames) {
            spreads.push_back(robust_spread(wall.frames[frame], wall.region, wall.planes[frame], sensor));
            const std::vector<double> residuals = residuals_of(wall, frame, geometry, spreads.back());
            for (std::size_t i = 0; i < residuals.size(); ++i) {
                if (std::isfinite(residuals[i])) pixels[i].add(residuals[i]);
            }
        }
        // Again instead of kept: recordings are long.
        for (std::size_t k = 0; k < pose.frames.size(); ++k) {
            std::vector<double> deviations = residuals_of(wall, pose.frames[k], geometry, spreads[k]);
            for (std::size_t i = 0; i < deviations.size(); ++i) {
                if (wall.separated) deviations[i] -= pixels[i].count < 2 ? NAN : pixels[i].mean();
                deviations[i] /= geometry.expected_m[i];
            }
            add_autocorrelation(wall, deviations, measured);
        }
        add_cells(wall, pose, sensor, pixels, measured);
    }
    return measured;
}

// The correlation, and from it how many independent pixels each cell has.
FittedFigure count_independent(Measured& measured) {
    double mean = 0.0, freedom = 0.0;
    for (const double product : measured.products) {
        if (measured.squares > 0.0) mean += product / measured.squares / kLags;
    }
    for (const NoiseCell& cell : measured.cells) freedom += cell.freedom;
    FittedFigure correlation{.value = correlation_for(mean), .fitted = measured.squares > 0.0};
    const double growth = variance_growth(correlation.value);
    const double error = 1.96 / std::sqrt(std::max(1.0, freedom / growth));
    correlation.low = correlation_for(mean - error);
    correlation.high = correlation_for(mean + error);
    for (NoiseCell& cell : measured.cells) cell.effective = cell.freedom / growth;
    std::erase_if(measured.cells, [](const NoiseCell& cell) { return cell.effective < kLeastEffective; });
    if (measured.cells.empty()) {
        throw std::runtime_error("no range and angle of the wall has " + format_fixed(kLeastEffective, 0) +
                                 " independent pixels with depth; use more frames or a larger --region");
    }
    return correlation;
}

// The field of fixed error is smooth: it has about as many independent values as nodes, less the plane that was taken
// off.
FittedFigure bias_figure(const Wall& wall, const Measured& measured, const SensorNoise& base) {
    if (!wall.separated) return {};
    const double value_m = std::sqrt(std::max(0.0, measured.bias_square_sum / measured.bias_pixels));
    const double nodes = wall.size() / (base.bias_length_pixels * base.bias_length_pixels);
    const double share = std::min(1.0, 1.96 / std::sqrt(2.0 * std::max(1.0, nodes - 3.0)));
    return {value_m, value_m * (1.0 - share), value_m * (1.0 + share), true};
}

FreeFigures determined(const std::vector<NoiseCell>& cells) {
    double near_m = 1e9, far_m = 0.0, least_term = 1e9, most_term = 0.0;
    for (const NoiseCell& cell : cells) {
        near_m = std::min(near_m, cell.depth_m);
        far_m = std::max(far_m, cell.depth_m);
        least_term = std::min(least_term, cell.angle_term);
        most_term = std::max(most_term, cell.angle_term);
    }
    return {true, far_m >= kLeastDepthRatio * near_m, most_term - least_term >= kLeastAngleTerm};
}

void summarise_groups(SensorFit& fit) {
    std::vector<double> freedom(fit.groups.size(), 0.0);
    for (const NoiseCell& cell : fit.cells) {
        const auto index = static_cast<std::size_t>(cell.group);
        WallGroup& group = fit.groups[index];
        const double model_m =
            cell_sigma_m(cell, fit.sigma_floor_m.value, fit.sigma_per_square_metre.value, fit.angle_factor.value);
        freedom[index] += cell.freedom;
        group.depth_m += cell.freedom * cell.depth_m;
        group.angle_rad += cell.freedom * cell.angle_rad;
        group.sigma_m += cell.freedom * cell.sigma_m * cell.sigma_m;
        group.fitted_sigma_m += cell.freedom * model_m * model_m;
    }
    for (std::size_t i = 0; i < fit.groups.size(); ++i) {
        if (freedom[i] == 0.0) continue;
        WallGroup& group = fit.groups[i];
        group.depth_m /= freedom[i];
        group.angle_rad /= freedom[i];
        group.sigma_m = std::sqrt(group.sigma_m / freedom[i]);
        group.fitted_sigma_m = std::sqrt(group.fitted_sigma_m / freedom[i]);
    }
}

void add_notes(SensorFit& fit) {
    if (!fit.separated) {
        fit.notes.emplace_back(
            "one frame a pose: noise and fixed error cannot be told apart; the fitted sigma holds both, and "
            "bias_sigma_m is 0");
    }
    if (!fit.sigma_per_square_metre.fitted) {
        fit.notes.emplace_back(
            "the wall is at one distance: the growth with depth cannot be told from the floor; the base's "
            "sigma_per_square_metre is kept and the floor fitted given it");
    }
    if (!fit.angle_factor.fitted) {
        fit.notes.emplace_back("the wall is seen at too few angles: the base's angle_factor is kept");
    }
    double all = 0.0, other = 0.0;
    for (const NoiseCell& cell : fit.cells) {
        all += cell.effective;
        other += cell.effective * std::min(1.0, cell.other_variance / std::max(1e-18, cell.sigma_m * cell.sigma_m));
    }
    if (other > 0.5 * all) {
        fit.notes.push_back(format_fixed(100.0 * other / all, 0) +
                            " % of the scatter is laid to the base's jitter, steps of depth and frame_bias_sigma_m: "
                            "use a --base whose figures are your camera's");
    }
}

}  // namespace

SensorFit fit_sensor(std::span<const WallFrame> frames, const SensorNoise& base, double count_m,
                     const SensorFitOptions& options) {
    SensorFit fit;
    WallSensor sensor{base, count_m};
    const Wall wall = wall_of(frames, sensor, options, fit.notes);
    fit.separated = wall.separated;
    for (const WallPose& pose : wall.poses) fit.frames += static_cast<int>(pose.frames.size());
    // Again with the figures found: they tell better what is an outlier.
    for (int round = 0; round < 2; ++round) {
        Measured measured = measure(wall, sensor);
        fit.correlation_pixels = count_independent(measured);
        fit.bias_sigma_m = bias_figure(wall, measured, base);
        const AxialFigures figures = fit_axial_figures(measured.cells, base, determined(measured.cells));
        fit.sigma_floor_m = figures.floor_m;
        fit.sigma_per_square_metre = figures.per_square_metre;
        fit.angle_factor = figures.angle_factor;
        fit.misfit = figures.misfit;
        fit.cells = std::move(measured.cells);
        fit.groups = std::move(measured.groups);
        sensor.noise.sigma_floor_m = fit.sigma_floor_m.value;
        sensor.noise.sigma_per_square_metre = fit.sigma_per_square_metre.value;
        sensor.noise.angle_factor = fit.angle_factor.value;
        sensor.noise.correlation_pixels = fit.correlation_pixels.value;
        sensor.noise.bias_sigma_m = fit.bias_sigma_m.value;
    }
    fit.noise = sensor.noise;
    summarise_groups(fit);
    add_notes(fit);
    return fit;
}

}  // namespace nearpose::simulate
