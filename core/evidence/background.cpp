#include "core/evidence/background.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/check.hpp"

namespace nearpose {
namespace {

// A measured pixel of the grid.
struct Measured {
    Eigen::Vector3f point;  // in camera coordinates [m]
    float gate_m = 0.0F;    // a plane farther away does not explain it
    int index = 0;          // of the grid
    bool beyond = false;    // beside the model's silhouette
    bool border = false;    // of the grid
};

float gate_at(const ObservedGrid& observed, int index, const PixelCostOptions& options) {
    return static_cast<float>(options.truncation_sigmas * std::hypot(observed.sigma_m[index], options.extra_sigma_m));
}

Eigen::Vector3f point_at(const ObservedGrid& observed, int index) {
    const int width = observed.grid.width;
    return observed.camera.ray(index % width, index / width).cast<float>() * observed.depth_m[index];
}

// Where the model is, grown by so many pixels to each side: beside an edge the nearer surface is often measured.
std::vector<char> silhouette(const View& view, const PixelGrid& grid, int grown) {
    std::vector<char> covered(static_cast<std::size_t>(grid.size()), 0);
    for (const int pixel : view.pixels) covered[pixel] = 1;
    const auto grow_along = [&](int step, int count, int first) {
        int last = -grown - 1;  // covered pixel before this one
        std::vector<char> line(static_cast<std::size_t>(count), 0);
        for (int i = 0; i < count; ++i) {
            if (covered[first + i * step]) last = i;
            line[i] = i - last <= grown;
        }
        last = count + grown + 1;
        for (int i = count - 1; i >= 0; --i) {
            if (covered[first + i * step]) last = i;
            if (line[i] || last - i <= grown) covered[first + i * step] = 2;
        }
    };
    for (int v = 0; v < grid.height; ++v) grow_along(1, grid.width, v * grid.width);
    for (int u = 0; u < grid.width; ++u) grow_along(grid.width, grid.height, u);
    return covered;
}

std::vector<Measured> measured_pixels(const View& view, const ObservedGrid& observed, const PixelCostOptions& options,
                                      int max_pixels) {
    const PixelGrid& grid = observed.grid;
    const std::vector<char> covered = silhouette(view, grid, options.outline_steps);
    std::vector<Measured> pixels;
    const int every = std::max(1, grid.size() / max_pixels) | 1;  // odd: not the same columns in each row
    for (int index = 0; index < grid.size(); index += every) {
        if (observed.states[index] == PixelState::kNoDepth) continue;
        const int u = index % grid.width, v = index / grid.width;
        const bool border = u == 0 || v == 0 || u == grid.width - 1 || v == grid.height - 1;
        pixels.push_back(
            {point_at(observed, index), gate_at(observed, index, options), index, !covered[index], border});
    }
    return pixels;
}

// Distance of a point from a plane, as a share of the point's gate.
float residual(const PlaneCoefficients& plane, float plane_norm, const Eigen::Vector3f& point, float gate_m) {
    return (plane.dot(point) - 1.0F) / (plane_norm * gate_m);
}

// The cost of a pixel under a plane: 1 where the plane does not explain it.
float cost_under(const PlaneCoefficients& plane, const Eigen::Vector3f& point, float gate_m) {
    const float r = residual(plane, plane.norm(), point, gate_m);
    return std::min(1.0F, r * r);
}

// Least squares of coefficients . X = 1 over the points that `take` accepts; each point weighs by its inverse range, so
// that near and far ones count alike. Nothing where they do not span a plane.
template <typename Take>
std::optional<PlaneCoefficients> plane_through(const std::vector<Measured>& pixels, const Take& take) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    int count = 0;
    for (const Measured& pixel : pixels) {
        if (!take(pixel)) continue;
        const Eigen::Vector3d ray = pixel.point.cast<double>() / static_cast<double>(pixel.point.z());
        information += ray * ray.transpose();
        gradient += ray / static_cast<double>(pixel.point.z());
        ++count;
    }
    if (count < 6) return std::nullopt;  // three points span a plane, but through their noise
    const Eigen::LDLT<Eigen::Matrix3d> solver(information);
    const Eigen::Vector3d coefficients = solver.solve(gradient);
    if (!coefficients.allFinite() || !(coefficients.norm() > 0.0)) return std::nullopt;
    return coefficients.cast<float>();
}

// Planes through small patches on a lattice over the grid.
std::vector<PlaneCoefficients> patch_planes(const std::vector<Measured>& pixels, const PixelGrid& grid, int per_side) {
    std::vector<PlaneCoefficients> planes;
    const int half_u = std::max(2, grid.width / (2 * per_side)), half_v = std::max(2, grid.height / (2 * per_side));
    std::vector<std::vector<Measured>> patches(static_cast<std::size_t>(per_side * per_side));
    for (const Measured& pixel : pixels) {
        const int i = pixel.index % grid.width / (2 * half_u), j = pixel.index / grid.width / (2 * half_v);
        if (i < per_side && j < per_side) patches[j * per_side + i].push_back(pixel);
    }
    for (const std::vector<Measured>& patch : patches)
        if (const auto plane = plane_through(patch, [](const Measured&) { return true; })) planes.push_back(*plane);
    return planes;
}

// What a plane explains of the pixels: a sum of 1 - cost. Every `step`-th pixel is asked.
double explained_by(const PlaneCoefficients& plane, const std::vector<Measured>& pixels, std::size_t step) {
    const float norm = plane.norm();
    float sum = 0.0F;
    for (std::size_t k = 0; k < pixels.size(); k += step) {
        const float r = residual(plane, norm, pixels[k].point, pixels[k].gate_m);
        sum += std::max(0.0F, 1.0F - r * r);
    }
    return static_cast<double>(sum) * static_cast<double>(step);
}

// The plane after a few rounds of least squares over what it explains.
PlaneCoefficients settled(PlaneCoefficients plane, const std::vector<Measured>& pixels) {
    for (int round = 0; round < 4; ++round) {
        const float norm = plane.norm();
        const auto better = plane_through(pixels, [&](const Measured& pixel) {
            return std::abs(residual(plane, norm, pixel.point, pixel.gate_m)) < 1.0F;
        });
        if (!better) break;
        plane = *better;
    }
    return plane;
}

// Whether a plane goes on beyond the model, or out of the grid.
bool reaches_beyond(const PlaneCoefficients& plane, const std::vector<Measured>& pixels, double min_share) {
    int explained = 0, beyond = 0, border = 0, borders = 0;
    for (const Measured& pixel : pixels) {
        borders += pixel.border;
        if (cost_under(plane, pixel.point, pixel.gate_m) >= 1.0F) continue;
        ++explained;
        beyond += pixel.beyond;
        border += pixel.border;
    }
    return beyond >= min_share * explained || (borders > 0 && border >= min_share * borders);
}

}  // namespace

void validate(const BackgroundOptions& options) {
    check_option("background.max_planes", options.max_planes, 0, 20);
    check_option("background.min_share", options.min_share, 0.0, 1.0);
    check_option("background.min_share_beyond", options.min_share_beyond, 0.0, 1.0);
    check_option("background.max_pixels", options.max_pixels, 10, 1e8);
    check_option("background.patches_per_side", options.patches_per_side, 1, 100);
    check_option("background.step_cost", options.step_cost, 0.0, 100.0);
    check_option("background.occlusion_cost", options.occlusion_cost, 0.0, 100.0);
}

std::vector<PlaneCoefficients> fit_background(const View& view, const ObservedGrid& observed,
                                              const PixelCostOptions& pixel_cost, const BackgroundOptions& options) {
    constexpr std::size_t kAsked = 400;  // pixels that rank the patches' planes
    constexpr int kFacesAPlane = 2;      // of the object, that are found before a plane of the background at most
    const std::vector<Measured> all = measured_pixels(view, observed, pixel_cost, options.max_pixels);
    std::vector<Measured> left = all;
    const double least = std::max(1.0, options.min_share * static_cast<double>(all.size()));
    const std::vector<PlaneCoefficients> candidates = patch_planes(all, observed.grid, options.patches_per_side);
    std::vector<PlaneCoefficients> planes;
    for (int tried = 0; tried < kFacesAPlane * options.max_planes && !candidates.empty() && !left.empty(); ++tried) {
        if (static_cast<int>(planes.size()) == options.max_planes) break;
        const std::size_t step = std::max<std::size_t>(1, left.size() / kAsked);
        std::vector<double> explained;
        for (const PlaneCoefficients& plane : candidates) explained.push_back(explained_by(plane, left, step));
        const auto best = std::max_element(explained.begin(), explained.end()) - explained.begin();
        const PlaneCoefficients plane = settled(candidates[best], left);
        if (explained_by(plane, left, 1) < least) break;
        if (reaches_beyond(plane, all, options.min_share_beyond)) planes.push_back(plane);
        std::erase_if(left, [&](const Measured& pixel) { return cost_under(plane, pixel.point, pixel.gate_m) < 1.0F; });
    }
    return planes;
}

namespace {

// What the pose says of a pixel.
enum class Label : char { kBackground, kObject, kOccluded, kSeenThrough };

struct Pixel {
    Label label = Label::kBackground;
    bool with_depth = false;
    Eigen::Vector3f point = Eigen::Vector3f::Zero();  // measured, in camera coordinates [m]
    float gate_m = 0.0F;
    int plane = -1;               // that explains it best
    float cost_without = 1.0F;    // under the null hypothesis
    float cost_of_object = 0.0F;  // of the model's ray
};

std::vector<Pixel> pixels_under_planes(const ObservedGrid& observed, const std::vector<PlaneCoefficients>& planes,
                                       const PixelCostOptions& options) {
    std::vector<Pixel> pixels(static_cast<std::size_t>(observed.grid.size()));
    for (int index = 0; index < observed.grid.size(); ++index) {
        Pixel& pixel = pixels[index];
        pixel.with_depth = observed.states[index] != PixelState::kNoDepth;
        if (!pixel.with_depth) continue;
        pixel.point = point_at(observed, index);
        pixel.gate_m = gate_at(observed, index, options);
        for (std::size_t k = 0; k < planes.size(); ++k) {
            const float cost = cost_under(planes[k], pixel.point, pixel.gate_m);
            if (cost >= pixel.cost_without) continue;
            pixel.cost_without = cost;
            pixel.plane = static_cast<int>(k);
        }
    }
    return pixels;
}

void label_by_model(const View& view, const Pose& camera_from_object, std::vector<Pixel>& pixels) {
    const Eigen::Matrix3f rotation = camera_from_object.rotation_matrix().cast<float>();
    const Eigen::Vector3f translation = camera_from_object.translation.cast<float>();
    for (std::size_t k = 0; k < view.size(); ++k) {
        Pixel& pixel = pixels[view.pixels[k]];
        if (!pixel.with_depth) continue;
        const Eigen::Vector3f point = rotation * view.points_in_object[k] + translation;
        const Eigen::Vector3f normal = rotation * view.normals_in_object[k];
        const float cosine = std::abs(normal.dot(point)) / point.norm();
        const float r = (pixel.point.z() - point.z()) * cosine / pixel.gate_m;  // positive: the model is in front
        pixel.label = r > 1.0F ? Label::kSeenThrough : r < -1.0F ? Label::kOccluded : Label::kObject;
        pixel.cost_of_object = std::min(1.0F, r * r);
    }
}

// Whether the image shows a depth step between two pixels: planes explain both, but none explains both, nor do their
// planes cross between them.
enum class Between { kUnknown, kSmooth, kStep };

Between between(const Pixel& a, const Pixel& b, const std::vector<PlaneCoefficients>& planes) {
    if (a.plane == -1 || b.plane == -1) return Between::kUnknown;
    const PlaneCoefficients &p = planes[a.plane], &q = planes[b.plane];
    if (a.plane == b.plane || cost_under(p, b.point, b.gate_m) < 1.0F || cost_under(q, a.point, a.gate_m) < 1.0F)
        return Between::kSmooth;
    // Along a ray, the plane with the larger product is the nearer one.
    const Eigen::Vector3f difference = p - q;
    const bool cross = (difference.dot(a.point) > 0.0F) != (difference.dot(b.point) > 0.0F);
    return cross ? Between::kSmooth : Between::kStep;
}

void judge_pair(const Pixel& a, const Pixel& b, double step_cost, const std::vector<PlaneCoefficients>& planes,
                PositiveEvidence& evidence) {
    if (a.label != Label::kObject && b.label != Label::kObject) return;  // both hypotheses pay alike
    const Between image = between(a, b, planes);
    if (image == Between::kUnknown) return;
    if (image == Between::kStep) {
        evidence.steps += step_cost;
    } else if (a.label != b.label) {
        const Label other = a.label == Label::kObject ? b.label : a.label;
        (other == Label::kOccluded ? evidence.occlusion : evidence.coplanar) += step_cost;
    }
}

}  // namespace

PositiveEvidence positive_evidence(const View& view, const Pose& camera_from_object, const ObservedGrid& observed,
                                   const std::vector<PlaneCoefficients>& planes, const PixelCostOptions& pixel_cost,
                                   const BackgroundOptions& options) {
    std::vector<Pixel> pixels = pixels_under_planes(observed, planes, pixel_cost);
    label_by_model(view, camera_from_object, pixels);
    PositiveEvidence evidence;
    for (const Pixel& pixel : pixels) {
        const double without = pixel.cost_without;
        if (pixel.label == Label::kObject) evidence.relief += without - pixel.cost_of_object;
        if (pixel.label == Label::kOccluded) evidence.occlusion += options.occlusion_cost;
        if (pixel.label == Label::kSeenThrough) evidence.free_space += 1.0 - without;
    }
    // Pixels beside an edge are often mixed: pairs are so many apart, and each step is crossed by as many pairs.
    const int apart = pixel_cost.outline_steps, width = observed.grid.width, height = observed.grid.height;
    const double step_cost = options.step_cost / apart;
    for (int v = 0; v < height; ++v)
        for (int u = 0; u < width; ++u) {
            const Pixel& pixel = pixels[v * width + u];
            if (!pixel.with_depth) continue;
            if (u + apart < width && pixels[v * width + u + apart].with_depth)
                judge_pair(pixel, pixels[v * width + u + apart], step_cost, planes, evidence);
            if (v + apart < height && pixels[(v + apart) * width + u].with_depth)
                judge_pair(pixel, pixels[(v + apart) * width + u], step_cost, planes, evidence);
        }
    return evidence;
}

double log_odds_present(const PositiveEvidence& evidence, int stride, const PixelCostOptions& pixel_cost,
                        const SensorModel& sensor) {
    const double strides = sensor.fine_length_pixels() / stride;
    const double rays_per_evidence = std::max(1.0, strides * strides);
    return 0.5 * pixel_cost.truncation_sigmas * pixel_cost.truncation_sigmas * evidence.total() / rays_per_evidence;
}

}  // namespace nearpose
