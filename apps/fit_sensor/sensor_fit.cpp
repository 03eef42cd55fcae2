#include "apps/fit_sensor/sensor_fit.hpp"

#include <algorithm>
#include <cmath>

#include "apps/base/number_text.hpp"
#include "apps/fit_sensor/noise_figures.hpp"
#include "apps/fit_sensor/wall_scatter.hpp"

namespace nearpose::simulate {
namespace {

using data_set::format_fixed;

constexpr double kLeastEffective = 30.0;  // pixels of a cell
constexpr double kLeastDepthRatio = 1.2;  // of the cells, to tell the growth with depth from the floor
constexpr double kLeastAngleTerm = 0.15;  // between the cells: 0 and 25 degrees

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

// From the mean autocorrelation and half of its 95 % interval.
FittedFigure correlation_figure(double mean, double error) {
    FittedFigure figure{correlation_for(mean), correlation_for(mean - error), correlation_for(mean + error), true};
    if (mean < error) figure.value = figure.low = 0.0;  // not told from independent pixels
    return figure;
}

// The correlation, and from it how many independent pixels each cell has.
void count_independent(Measured& measured, SensorFit& fit) {
    double rows = 0.0, columns = 0.0, freedom = 0.0;
    for (int i = 0; i < kLags && measured.squares > 0.0; ++i) {
        rows += measured.row_products[static_cast<std::size_t>(i)] / measured.squares / kLags;
        columns += measured.column_products[static_cast<std::size_t>(i)] / measured.squares / kLags;
    }
    for (const NoiseCell& cell : measured.cells) freedom += cell.freedom;
    const double mean = 0.5 * (rows + columns), growth = variance_growth(correlation_for(mean));
    const double error = 1.96 / std::sqrt(std::max(1.0, freedom / growth));
    fit.correlation_pixels = correlation_figure(mean, error);
    fit.row_correlation_pixels = correlation_figure(rows, error);
    fit.column_correlation_pixels = correlation_figure(columns, error);
    for (FittedFigure* figure : {&fit.correlation_pixels, &fit.row_correlation_pixels, &fit.column_correlation_pixels})
        figure->fitted = measured.squares > 0.0;
    for (NoiseCell& cell : measured.cells) cell.effective = cell.freedom / growth;
    std::erase_if(measured.cells, [](const NoiseCell& cell) { return cell.effective < kLeastEffective; });
    if (measured.cells.empty()) {
        throw std::runtime_error("no range and angle of the wall has " + format_fixed(kLeastEffective, 0) +
                                 " independent pixels with depth; use more frames or a larger --region");
    }
}

// The field of fixed error is smooth: nodes joined by a bicubic B-spline, whose autocorrelation is nearly a Gaussian of
// variance 2/3 in nodes. So every pi * 2/3 nodes count as one independent value, and a plane's three smooth shapes have
// taken 3 * 2 pi * 2/3 nodes' worth of its variance with them, which is given back here.
FittedFigure bias_figure(const Wall& wall, const Measured& measured, const SensorNoise& base) {
    if (!wall.separated) return {};
    const double nodes = wall.size() / (base.bias_length_pixels * base.bias_length_pixels);
    const double left = std::max(0.5, 1.0 - 4.0 * M_PI / nodes);
    const double value_m = std::sqrt(std::max(0.0, measured.bias_square_sum / measured.bias_pixels / left));
    const double independent = std::max(1.0, nodes / (M_PI * 2.0 / 3.0) - 3.0);
    const double share = std::min(1.0, 1.96 / std::sqrt(2.0 * independent));
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
        count_independent(measured, fit);
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
