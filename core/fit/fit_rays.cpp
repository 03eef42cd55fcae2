#include "core/fit/fit_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace nearpose {
namespace {

constexpr double kGateSigmas = 5.0;   // a pair farther off than that is not the same surface
constexpr double kHuberSigmas = 2.0;  // beyond it a residual pulls with constant force

// Neighbouring rays share the field's nodes: their rows are summed up as small matrices first.
class CellSum {
  public:
    // The pose, the nodes around and the depth's scale, the part's scale, the residual.
    static constexpr int kUsed = 6 + 5 + 1 + 1;
    static constexpr int kSize = 14;  // even, so that the compiler takes two numbers at a time
    using Row = Eigen::Matrix<double, kSize, 1>;

    void add(const SensorField::Row& place, const Row& row, double weight, FitEquations& equations) {
        if (place.unknowns != unknowns_) flush(equations);
        unknowns_ = place.unknowns;
        add_lower_half(row, weight * row);
    }
    void flush(FitEquations& equations) {
        std::array<Eigen::Index, kUsed> index{};
        for (int i = 0; i < kUsed; ++i)
            index[i] = i < 6 ? i : 6 + (i < 11 ? unknowns_[i - 6] : equations.unknowns + i - (kUsed - 1));
        for (int j = 0; j < kUsed; ++j)
            for (int i = 0; i < kUsed; ++i) equations.sums(index[i], index[j]) += sum_(std::max(i, j), std::min(i, j));
        sum_.setZero();
    }

  private:
    template <int kColumn = 0>
    void add_lower_half(const Row& row, const Row& weighted) {
        if constexpr (kColumn < kUsed) {
            constexpr int kLength = kSize - (kColumn - kColumn % 2);  // two numbers at a time
            sum_.col(kColumn).template tail<kLength>() += weighted[kColumn] * row.template tail<kLength>();
            add_lower_half<kColumn + 1>(row, weighted);
        }
    }

    Eigen::Matrix<double, kSize, kSize> sum_ = Eigen::Matrix<double, kSize, kSize>::Zero();
    decltype(SensorField::Row::unknowns) unknowns_{};
};

// So many rays share one of the errors that are finer than the field's nodes: each counts with that error, not with its
// mean.
double rays_per_fine_error(const SensorModel& sensor, int stride) {
    const double side = std::max(1.0, 0.25 * sensor.systematic_length_pixels / stride);
    return side * side;
}

// The surface measured around a ray: the mean over pixels of its part of the grid that lie on the ray's face.
struct MeasuredAround {
    double residual_m = 0.0;  // along the normal
    int count = 0;
};

// Whether the rays beside one meet the same face.
struct FaceGoesOn {
    bool left = false, right = false, up = false, down = false;
};

FaceGoesOn face_goes_on(const View& view, const std::vector<int>& hit_at, std::size_t k, const PixelGrid& grid) {
    const int index = view.pixels[k], u = index % grid.width, v = index / grid.width;
    const auto same = [&](int other) {
        const int hit = hit_at[other];
        if (hit < 0) return false;
        const Eigen::Vector3f between = view.points_in_object[hit] - view.points_in_object[k];
        constexpr float kSine = 0.05F;
        return std::abs(view.normals_in_object[k].dot(between)) < kSine * between.norm() &&
               std::abs(view.normals_in_object[hit].dot(between)) < kSine * between.norm();
    };
    return {u > 0 && same(index - 1), u + 1 < grid.width && same(index + 1), v > 0 && same(index - grid.width),
            v + 1 < grid.height && same(index + grid.width)};
}

// A plane's inverse depth is affine over the image, so that one cast ray speaks for the pixels around: the noise of
// many is averaged for the price of one. Where the face ends or bends the gate leaves pixels out.
struct FaceInImage {
    double inverse_depth, along_u, along_v;  // [1/m], and per pixel
    double slope_by_inverse;                 // normal . (point - camera): the slope of a ray is this times 1 / depth

    MeasuredAround compare(const Observation& observation, int u, int v, int reach, const FaceGoesOn& goes_on,
                           double expected_m, double gate_m) const {
        const PinholeCamera& camera = observation.camera();
        MeasuredAround sum;
        const int step = std::max(1, reach);
        for (int dv = goes_on.up ? -reach : 0; dv <= (goes_on.down ? reach : 0); dv += step) {
            for (int du = goes_on.left ? -reach : 0; du <= (goes_on.right ? reach : 0); du += step) {
                const int other_u = u + du, other_v = v + dv;
                if (other_u < 0 || other_v < 0 || other_u >= camera.width || other_v >= camera.height) continue;
                const int pixel = other_v * camera.width + other_u;
                if (observation.states()[pixel] != PixelState::kCandidate) continue;
                // (measured - model) * slope, with slope = slope_by_inverse / model
                const double inverse = inverse_depth + along_u * du + along_v * dv;
                const double residual_m = (observation.depth_m()[pixel] * inverse - 1.0) * slope_by_inverse;
                if (!(std::abs(residual_m - expected_m) <= gate_m)) continue;
                sum.residual_m += residual_m;
                ++sum.count;
            }
        }
        if (sum.count > 0) sum.residual_m /= sum.count;
        return sum;
    }
};

}  // namespace

FitEquations linearise(const Linearisation& at, const View& view, const SensorField& field,
                       const StepContext& context) {
    const ObservedGrid& observed = context.observed;
    const SensorModel& sensor = context.observation.sensor();
    const Eigen::Vector3d centre = context.views.extent().centre_in_object();
    const Eigen::Matrix3d rotation = at.camera_from_object.rotation_matrix();
    const Eigen::Matrix3d object_from_camera = rotation.transpose();
    const Eigen::Vector3d camera_in_object = -(object_from_camera * at.camera_from_object.translation);
    const double fine_m2 = sensor.systematic_fine_sigma_m * sensor.systematic_fine_sigma_m;
    const double shared = rays_per_fine_error(sensor, observed.grid.stride);
    const double field_m2 = sensor.systematic_sigma_m * sensor.systematic_sigma_m;
    const double extra_m2 = at.extra_sigma_m * at.extra_sigma_m;
    FitEquations equations(field.num_unknowns() + 1);
    equations.scaled_residuals.reserve(view.size());
    CellSum cell;
    const PinholeCamera& camera = context.observation.camera();
    const int reach = observed.grid.stride * 2 / 5;
    std::vector<int> hit_at(static_cast<std::size_t>(observed.grid.size()), -1);
    for (std::size_t k = 0; k < view.size(); ++k) hit_at[view.pixels[k]] = static_cast<int>(k);
    for (std::size_t k = 0; k < view.size(); ++k) {
        const int index = view.pixels[k];
        if (observed.states[index] != PixelState::kCandidate) continue;
        const Eigen::Vector3d normal = view.normals_in_object[k].cast<double>();
        const Eigen::Vector3d normal_in_camera = rotation * normal;
        const int u = observed.grid.image_u(index), v = observed.grid.image_v(index);
        const double slope = normal_in_camera.dot(camera.ray(u, v));  // metres along the normal per metre of depth
        const double offset_m = normal.dot(view.points_in_object[k].cast<double>() - camera_in_object);
        const double model_m = offset_m / slope;
        if (!(model_m > 0.0 && slope < 0.0)) continue;  // the face is seen from behind by now, or on edge
        const double measured_m = observed.depth_m[index];
        const SensorField::Row place = field.row_at(u, v, measured_m);
        double known_m = 0.0;
        for (int i = 0; i < 5; ++i) known_m += place.factors[i] * at.errors[place.unknowns[i]];
        const double squared_slope = slope * slope;
        const double noise_m2 =
            sensor.variance_along_normal_m2(observed.sigma_m[index], measured_m, normal_in_camera.z(), camera.fx);
        const double fine_along_normal_m2 = fine_m2 * squared_slope;
        const double gate_m =
            kGateSigmas * std::sqrt(noise_m2 + fine_along_normal_m2 + field_m2 * squared_slope + extra_m2);
        const FaceInImage face{1.0 / model_m, normal_in_camera.x() / (camera.fx * offset_m),
                               normal_in_camera.y() / (camera.fy * offset_m), offset_m};
        const MeasuredAround measured = face.compare(
            context.observation, u, v, reach, face_goes_on(view, hit_at, k, observed.grid), slope * known_m, gate_m);
        if (measured.count == 0) continue;
        const double sigma_m2 = noise_m2 / measured.count + fine_along_normal_m2;
        const double off_m = std::abs(measured.residual_m - slope * known_m);
        const double robust = std::min(1.0, kHuberSigmas * std::sqrt(sigma_m2 + extra_m2) / std::max(off_m, 1e-12));
        CellSum::Row row;
        row << (camera_in_object + model_m * (object_from_camera * camera.ray(u, v)) - centre).cross(normal), normal,
            slope * Eigen::Map<const Eigen::Matrix<double, 5, 1>>(place.factors.data()),
            normal.dot(view.points_in_object[k].cast<double>() - centre), measured.residual_m, 0.0;
        const double variance_m2 = sigma_m2 + (shared - 1.0) * fine_along_normal_m2;
        cell.add(place, row, robust / variance_m2, equations);
        equations.scaled_residuals.push_back(off_m / std::sqrt(sigma_m2));
    }
    cell.flush(equations);
    return equations;
}

}  // namespace nearpose
