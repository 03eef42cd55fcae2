#include "core/fit/fit_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/evidence/model_edges.hpp"

namespace nearpose {
namespace {

// Neighbouring rays share the field's nodes, so their rows are first summed in a small matrix.
class CellSum {
  public:
    // The pose, the four nodes around and the depth's scale, the constant errors, the residual.
    static constexpr int kBeforeConstants = 6 + 5;
    static constexpr int kUsed = kBeforeConstants + kConstantErrors + 1;
    static constexpr int kSize = 16;  // even, so that the compiler takes two numbers at a time
    static_assert(kUsed <= kSize && kSize % 2 == 0);
    using Row = Eigen::Matrix<double, kSize, 1>;

    void add(const SensorField::Row& place, const Row& row, double weight, FitEquations& equations) {
        if (place.unknowns != unknowns_) flush(equations);
        unknowns_ = place.unknowns;
        add_lower_half(row, weight * row);
    }
    void flush(FitEquations& equations) {
        std::array<Eigen::Index, kUsed> index{};
        for (int i = 0; i < kUsed; ++i)
            index[i] =
                i < 6 ? i : 6 + (i < kBeforeConstants ? unknowns_[i - 6] : equations.unknowns + i - kBeforeConstants);
        for (int j = 0; j < kUsed; ++j)
            for (int i = 0; i < kUsed; ++i) equations.sums(index[i], index[j]) += sum_(std::max(i, j), std::min(i, j));
        sum_.setZero();
    }

  private:
    template <int kColumn = 0>
    void add_lower_half(const Row& row, const Row& weighted) {
        if constexpr (kColumn < kUsed) {
            constexpr int kLength = kSize - (kColumn - kColumn % 2);  // even as well
            sum_.col(kColumn).template tail<kLength>() += weighted[kColumn] * row.template tail<kLength>();
            add_lower_half<kColumn + 1>(row, weighted);
        }
    }

    Eigen::Matrix<double, kSize, kSize> sum_ = Eigen::Matrix<double, kSize, kSize>::Zero();
    decltype(SensorField::Row::unknowns) unknowns_{};
};

// How many rays share one of the errors that are finer than the field's nodes. Their mean does not average that error
// out, so each ray's variance is made larger by this factor.
double rays_per_fine_error(const SensorModel& sensor, int stride) {
    const double side = std::max(1.0, sensor.fine_length_pixels() / stride);
    return side * side;
}

// The mean residual over the pixels around a ray that lie on the ray's face.
struct MeasuredAround {
    double residual_m = 0.0;  // along the normal
    int count = 0;            // of those pixels
};

// Whether the neighbouring rays meet the same face.
struct SameFace {
    bool left = false, right = false, up = false, down = false;
};

// The plane of the face that a ray meets, at the pose of the linearisation.
struct RayFace {
    int u, v;                          // the ray's pixel in the image
    Eigen::Vector3d normal;            // in object axes
    Eigen::Vector3d normal_in_camera;  // the same in camera axes
    double slope;                      // metres along the normal per metre of depth
    double offset_m;                   // normal . (point on the face - camera)
    double model_m;                    // depth of the plane along the ray

    // Whether the camera still looks at the face's front.
    bool visible() const { return model_m > 0.0 && slope < 0.0; }
};

// The inverse depth of a plane is affine over the image. One cast ray can therefore be compared with all pixels around
// it, which averages the noise of many pixels for the price of one ray.
struct PlaneInImage {
    double inverse_depth, along_u, along_v;  // [1/m], and per pixel
    double slope_by_inverse;                 // normal . (point - camera): the slope of a ray is this times 1 / depth

    PlaneInImage(const RayFace& face, const PinholeCamera& camera)
        : inverse_depth(1.0 / face.model_m),
          along_u(face.normal_in_camera.x() / (camera.fx * face.offset_m)),
          along_v(face.normal_in_camera.y() / (camera.fy * face.offset_m)),
          slope_by_inverse(face.offset_m) {}

    // Pixels up to `reach` away on those sides where the face goes on. Where it ends or bends between rays, the gate
    // leaves pixels out.
    MeasuredAround compare(const Observation& observation, const RayFace& face, int reach, const SameFace& same,
                           double expected_m, double gate_m) const {
        const PinholeCamera& camera = observation.camera();
        MeasuredAround sum;
        const int step = std::max(1, reach);
        for (int dv = same.up ? -reach : 0; dv <= (same.down ? reach : 0); dv += step) {
            for (int du = same.left ? -reach : 0; du <= (same.right ? reach : 0); du += step) {
                const int other_u = face.u + du, other_v = face.v + dv;
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

// All that the rays of one linearisation share.
class RayLineariser {
  public:
    RayLineariser(const Linearisation& at, const View& view, const SensorField& field, const StepContext& context,
                  const FitRayOptions& options)
        : at_(at),
          view_(view),
          field_(field),
          observation_(context.observation),
          observed_(context.observed),
          options_(options),
          centre_in_object_(context.views.extent().centre_in_object()),
          rotation_(at.camera_from_object.rotation_matrix()),
          object_from_camera_(rotation_.transpose()),
          camera_in_object_(-(object_from_camera_ * at.camera_from_object.translation)),
          hit_at_(rays_on_grid(view, observed_.grid)),
          fine_m2_(sensor().systematic_fine_sigma_m * sensor().systematic_fine_sigma_m),
          field_m2_(sensor().systematic_sigma_m * sensor().systematic_sigma_m),
          extra_m2_(at.extra_sigma_m * at.extra_sigma_m),
          rays_per_fine_error_(rays_per_fine_error(sensor(), observed_.grid.stride)),
          reach_pixels_(static_cast<int>(observed_.grid.stride * options.reach_spacings)),
          edge_sigma_factor_(1.0 + observation_.shared_noise() * (sensor().edge_sigma_factor - 1.0)),
          at_step_(rays_at_steps(
              view, observed_,
              edge_sigma_factor_ > 1.0 ? static_cast<int>(std::ceil(sensor().edge_pixels / observed_.grid.stride)) : 0,
              sensor().edge_step_sigmas)) {}

    RayFace face_of(std::size_t k) const;
    // Adds the k-th ray's row; nothing where no pixel around it lies on its face.
    void add(std::size_t k, const RayFace& face, CellSum& cell, FitEquations& equations) const;

  private:
    const SensorModel& sensor() const { return observation_.sensor(); }
    SameFace same_face(std::size_t k) const;

    const Linearisation& at_;
    const View& view_;
    const SensorField& field_;
    const Observation& observation_;
    const ObservedGrid& observed_;
    const FitRayOptions& options_;
    const Eigen::Vector3d centre_in_object_;
    const Eigen::Matrix3d rotation_, object_from_camera_;  // of camera from object, and its inverse
    const Eigen::Vector3d camera_in_object_;
    const std::vector<int> hit_at_;
    const double fine_m2_, field_m2_, extra_m2_;  // variances: the first two in depth, the last along the normal
    const double rays_per_fine_error_;
    const int reach_pixels_;
    const double edge_sigma_factor_;
    const std::vector<char> at_step_;
};

RayFace RayLineariser::face_of(std::size_t k) const {
    RayFace face;
    face.u = observed_.grid.image_u(view_.pixels[k]);
    face.v = observed_.grid.image_v(view_.pixels[k]);
    face.normal = view_.normals_in_object[k].cast<double>();
    face.normal_in_camera = rotation_ * face.normal;
    face.slope = face.normal_in_camera.dot(observation_.camera().ray(face.u, face.v));
    face.offset_m = face.normal.dot(view_.points_in_object[k].cast<double>() - camera_in_object_);
    face.model_m = face.offset_m / face.slope;
    return face;
}

SameFace RayLineariser::same_face(std::size_t k) const {
    const PixelGrid& grid = observed_.grid;
    const int index = view_.pixels[k], u = index % grid.width, v = index / grid.width;
    const auto same = [&](int other) {
        const int hit = hit_at_[other];
        if (hit < 0) return false;
        const Eigen::Vector3f between = view_.points_in_object[hit] - view_.points_in_object[k];
        return std::abs(view_.normals_in_object[k].dot(between)) < options_.coplanar_sine * between.norm() &&
               std::abs(view_.normals_in_object[hit].dot(between)) < options_.coplanar_sine * between.norm();
    };
    return {u > 0 && same(index - 1), u + 1 < grid.width && same(index + 1), v > 0 && same(index - grid.width),
            v + 1 < grid.height && same(index + grid.width)};
}

void RayLineariser::add(std::size_t k, const RayFace& face, CellSum& cell, FitEquations& equations) const {
    const PinholeCamera& camera = observation_.camera();
    const int index = view_.pixels[k];
    const double slope = face.slope, measured_m = observed_.depth_m[index];
    const SensorField::Row place = field_.row_at(face.u, face.v, measured_m);
    double known_m = 0.0;  // the sensor's error here, as far as it is known
    for (int i = 0; i < 5; ++i) known_m += place.factors[i] * at_.errors[place.unknowns[i]];
    const double squared_slope = slope * slope;
    const double noise_m2 =
        sensor().variance_along_normal_m2(observed_.sigma_m[index], measured_m, face.normal_in_camera.z(), camera.fx);
    const double fine_along_normal_m2 = fine_m2_ * squared_slope;
    const double gate_m =
        options_.gate_sigmas * std::sqrt(noise_m2 + fine_along_normal_m2 + field_m2_ * squared_slope + extra_m2_);
    const MeasuredAround measured =
        PlaneInImage(face, camera).compare(observation_, face, reach_pixels_, same_face(k), slope * known_m, gate_m);
    if (measured.count == 0) return;
    const double sigma_m2 = noise_m2 / measured.count + fine_along_normal_m2;
    const double off_m = std::abs(measured.residual_m - slope * known_m);
    const double robust =
        std::min(1.0, options_.huber_sigmas * std::sqrt(sigma_m2 + extra_m2_) / std::max(off_m, 1e-12));
    const Eigen::Vector3d ray = camera.ray(face.u, face.v);
    const Eigen::Vector3d& normal = face.normal_in_camera;
    CellSum::Row row = CellSum::Row::Zero();
    row.head<CellSum::kUsed>()
        << (camera_in_object_ + face.model_m * (object_from_camera_ * ray) - centre_in_object_).cross(face.normal),
        face.normal, slope * Eigen::Map<const Eigen::Matrix<double, 5, 1>>(place.factors.data()),
        // The part is larger; the focal length and the principal point are larger, so the measured point lies nearer to
        // the axis, further to the left, higher up.
        face.normal.dot(view_.points_in_object[k].cast<double>() - centre_in_object_),
        -measured_m * (normal.x() * ray.x() + normal.y() * ray.y()), -measured_m * normal.x() / camera.fx,
        -measured_m * normal.y() / camera.fy, measured.residual_m;
    const bool mixed = at_step_[k] != 0;
    const double edge_variance_factor = mixed ? edge_sigma_factor_ * edge_sigma_factor_ : 1.0;
    const double variance_m2 = edge_variance_factor * (sigma_m2 + (rays_per_fine_error_ - 1.0) * fine_along_normal_m2);
    cell.add(place, row, robust / variance_m2, equations);
    ++equations.rays;
    if (!mixed) equations.scaled_residuals.push_back(off_m / std::sqrt(sigma_m2));
}

}  // namespace

FitEquations linearise(const Linearisation& at, const View& view, const SensorField& field, const StepContext& context,
                       const FitRayOptions& options) {
    const RayLineariser rays(at, view, field, context, options);
    FitEquations equations(field.num_unknowns());
    equations.scaled_residuals.reserve(view.size());
    CellSum cell;
    for (std::size_t k = 0; k < view.size(); ++k) {
        if (context.observed.states[view.pixels[k]] != PixelState::kCandidate) continue;
        const RayFace face = rays.face_of(k);
        if (face.visible()) rays.add(k, face, cell, equations);
    }
    cell.flush(equations);
    return equations;
}

}  // namespace nearpose
