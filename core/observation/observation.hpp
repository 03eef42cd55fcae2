// One measurement of the scene, prepared once and read by every particle.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/base/point_index.hpp"
#include "core/observation/image_noise.hpp"
#include "core/observation/organised_image.hpp"
#include "core/observation/sensor_model.hpp"

namespace nearpose {

struct ObservationOptions {
    SensorModel sensor;
    int max_points = 3000;  // of the cloud that nearest neighbours are searched in
    NoiseOptions noise;     // of an organised image
    // An unorganised cloud is projected at the finest resolution at which this share of its pixels, in 0..1, has a
    // filled neighbour to the right.
    double min_filled_share = 0.8;
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
    const std::vector<float>& depth_m() const { return image_.depth_m; }
    const std::vector<PixelState>& states() const { return image_.states; }

    // The box of the candidate pixels, and their number.
    const PixelBox& candidate_box() const { return candidates_.box; }
    int num_candidates() const { return candidates_.count; }

    // How many times the sensor model's noise this image shows on smooth surfaces. The model is of the sensor, while
    // rain, light and dark surfaces change from image to image. 1 where too little is seen to measure it.
    double noise_factor() const { return noise_.factor; }
    // Whether pixels that are some pixels apart share their noise, 0..1, as where a sensor gives one value for a
    // window. 1 where it was not measured.
    double shared_noise() const { return noise_.shared; }
    // Standard deviation of a pixel's depth in this image [m].
    double sigma_m(double depth_m) const { return noise_.factor * sensor_.sigma_m(depth_m); }

    // An even subset of the candidates as a cloud, with unit normals towards the camera (zero where the neighbourhood
    // gives none).
    const std::vector<Eigen::Vector3f>& points_in_camera() const { return cloud_.points_in_camera; }
    const std::vector<Eigen::Vector3f>& normals_in_camera() const { return cloud_.normals_in_camera; }
    // Over that cloud. Built when first asked for: projective association needs none.
    const PointIndex& index() const;

    Eigen::Vector3d centroid_in_camera() const { return cloud_.centroid_in_camera; }  // of that cloud [m]
    double mean_distance_m() const { return cloud_.mean_distance_m; }  // of that cloud from the camera [m]; 0 if empty

    // The measured point of a pixel that has depth [m].
    Eigen::Vector3d point_at(int pixel) const { return nearpose::point_at(image_, camera_, pixel); }
    // Unit normal of the surface around a pixel, towards the camera, from its neighbours at `reach` pixels; zero where
    // they have no depth or lie across a depth edge.
    Eigen::Vector3f normal_at(int pixel, int reach) const { return nearpose::normal_at(image_, camera_, pixel, reach); }

  private:
    friend Observation make_observation(DepthImage, const PinholeCamera&, const std::optional<Mask>&,
                                        const ObservationOptions&);
    friend Observation make_observation(const std::vector<Eigen::Vector3f>&, const PinholeCamera&,
                                        const ObservationOptions&);
    Observation() = default;

    PinholeCamera camera_;
    SensorModel sensor_;
    bool segmented_ = false;
    OrganisedImage image_;
    CandidateExtent candidates_;
    CandidateCloud cloud_;
    ImageNoise noise_;
    struct LazyIndex {
        std::once_flag once;
        std::optional<PointIndex> index;
    };
    std::shared_ptr<LazyIndex> index_ = std::make_shared<LazyIndex>();
};

// From an organised depth image. Pixels that are not finite or out of the sensor's range count as not measured. Throws
// std::invalid_argument where the sizes of image, mask and camera differ. An image that is handed over is not copied.
Observation make_observation(DepthImage depth, const PinholeCamera& camera, const std::optional<Mask>& mask,
                             const ObservationOptions& options = {});

// From a segmented, unorganised cloud of the object in camera coordinates [m], the paper's input. It is projected once
// through the camera, at a resolution that the cloud can fill.
Observation make_observation(const std::vector<Eigen::Vector3f>& points_in_camera, const PinholeCamera& camera,
                             const ObservationOptions& options = {});

}  // namespace nearpose
