// One measurement of the scene, prepared once and read by every particle.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/base/point_index.hpp"
#include "core/observation/sensor_model.hpp"

namespace nearpose {

// What a pixel says about the object. Missing depth is not background: sensors lose pixels on the object too.
enum class PixelState : std::uint8_t {
    kNoDepth,     // nothing measured
    kCandidate,   // measured, and the object where a mask says so; anything where there is no mask
    kBackground,  // measured, and not the object, says the mask
};

struct ObservationOptions {
    SensorModel sensor;
    int max_points = 3000;  // of the cloud that nearest neighbours are searched in
};

// Immutable; may be read by several threads at once. Built by make_observation.
class Observation {
  public:
    const PinholeCamera& camera() const { return camera_; }
    const SensorModel& sensor() const { return sensor_; }
    // True where a mask or a segmentation says which pixels are the object: then a candidate pixel without model, or
    // model over background, is evidence against a pose.
    bool segmented() const { return segmented_; }

    // Row-major over camera()'s image. Depth is 0 where the state is kNoDepth.
    const std::vector<float>& depth_m() const { return depth_m_; }
    const std::vector<PixelState>& states() const { return states_; }

    // The box of the candidate pixels, and their number.
    const PixelBox& candidate_box() const { return candidate_box_; }
    int num_candidates() const { return num_candidates_; }

    // How many times the sensor model's noise this image shows on smooth surfaces: the model is of a sensor, and rain,
    // light and dark surfaces are of the day. 1 where too little is seen to tell.
    double noise_factor() const { return noise_factor_; }
    // Standard deviation of a pixel's depth in this image [m].
    double sigma_m(double depth_m) const { return noise_factor_ * sensor_.sigma_m(depth_m); }

    // An even subset of the candidates as a cloud, with unit normals towards the camera (zero where the neighbourhood
    // gives none).
    const std::vector<Eigen::Vector3f>& points_in_camera() const { return points_in_camera_; }
    const std::vector<Eigen::Vector3f>& normals_in_camera() const { return normals_in_camera_; }
    // Over that cloud. Built when first asked for: projective association needs none.
    const PointIndex& index() const;

    Eigen::Vector3d centroid_in_camera() const { return centroid_in_camera_; }  // of that cloud [m]
    double mean_distance_m() const { return mean_distance_m_; }  // of that cloud from the camera [m]; 0 if empty

    // The measured point of a pixel that has depth [m].
    Eigen::Vector3d point_at(int pixel) const {
        const int u = pixel % camera_.width, v = pixel / camera_.width;
        return static_cast<double>(depth_m_[pixel]) * camera_.ray(u, v);
    }
    // Unit normal of the surface around a pixel, towards the camera, from its neighbours at `reach` pixels; zero where
    // they have no depth or lie across a depth edge.
    Eigen::Vector3f normal_at(int pixel, int reach) const;

  private:
    friend Observation make_observation(DepthImage, const PinholeCamera&, const std::optional<Mask>&,
                                        const ObservationOptions&);
    friend Observation make_observation(const std::vector<Eigen::Vector3f>&, const PinholeCamera&,
                                        const ObservationOptions&);
    Observation() = default;
    void take_pixels(std::vector<float> depth_m, const std::optional<Mask>& mask);
    void find_candidates();
    void sample_cloud(int max_points);
    void measure_cloud();
    void measure_noise();

    PinholeCamera camera_;
    SensorModel sensor_;
    bool segmented_ = false;
    std::vector<float> depth_m_;
    std::vector<PixelState> states_;
    PixelBox candidate_box_;
    int num_candidates_ = 0;
    double noise_factor_ = 1.0;
    std::vector<Eigen::Vector3f> points_in_camera_;
    std::vector<Eigen::Vector3f> normals_in_camera_;
    Eigen::Vector3d centroid_in_camera_ = Eigen::Vector3d::Zero();
    double mean_distance_m_ = 0.0;
    struct LazyIndex {
        std::once_flag once;
        std::optional<PointIndex> index;
    };
    std::shared_ptr<LazyIndex> index_ = std::make_shared<LazyIndex>();
};

// The measurements at the pixels of a grid, gathered once for all particles.
struct ObservedGrid {
    PixelGrid grid;
    PinholeCamera camera;    // camera_of(grid, observation.camera())
    bool segmented = false;  // as Observation::segmented
    int num_candidates = 0;
    std::vector<PixelState> states;  // row-major over the grid
    std::vector<float> depth_m;      // 0 where kNoDepth
    std::vector<float> sigma_m;      // of this image at that depth
    std::vector<float> weights;      // what agreement there says, in 0..1 (see start_pairs.hpp); empty: 1 everywhere

    double weight(int index) const { return weights.empty() ? 1.0 : static_cast<double>(weights[index]); }
};

ObservedGrid observe(const Observation& observation, const PixelGrid& grid);

// From an organised depth image. Pixels that are not finite or out of the sensor's range count as not measured. Throws
// std::invalid_argument where the sizes of image, mask and camera differ. An image that is handed over is not copied.
Observation make_observation(DepthImage depth, const PinholeCamera& camera, const std::optional<Mask>& mask,
                             const ObservationOptions& options = {});

// From a segmented, unorganised cloud of the object in camera coordinates [m], the paper's input. It is projected once
// through the camera, at a resolution that the cloud can fill.
Observation make_observation(const std::vector<Eigen::Vector3f>& points_in_camera, const PinholeCamera& camera,
                             const ObservationOptions& options = {});

}  // namespace nearpose
