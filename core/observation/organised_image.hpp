// A depth image with the state of each pixel, and what is read off it once for all particles.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/observation/sensor_model.hpp"

namespace nearpose {

// What a pixel says about the object. Missing depth is not background: sensors lose pixels on the object too.
enum class PixelState : std::uint8_t {
    kNoDepth,     // nothing measured
    kCandidate,   // measured, and the object where a mask says so; anything where there is no mask
    kBackground,  // measured, and not the object, says the mask
};

// Row-major over the image of a camera. The camera is a parameter of every function below.
struct OrganisedImage {
    std::vector<float> depth_m;      // along the optical axis; 0 where the state is kNoDepth
    std::vector<PixelState> states;  // as many as depths
};

// Where the candidate pixels are.
struct CandidateExtent {
    PixelBox box;   // the smallest that holds them all; empty if there are none
    int count = 0;  // of candidate pixels
};

// An even subset of the candidates.
struct CandidateCloud {
    std::vector<Eigen::Vector3f> points_in_camera;                 // [m]
    std::vector<Eigen::Vector3f> normals_in_camera;                // unit, towards the camera; zero where unknown
    Eigen::Vector3d centroid_in_camera = Eigen::Vector3d::Zero();  // [m]
    double mean_distance_m = 0.0;                                  // from the camera; 0 if empty
};

// Takes over `depth_m`; depths that are not finite or out of the sensor's range become 0. Without a mask all measured
// pixels are candidates.
OrganisedImage organise(std::vector<float> depth_m, const std::optional<Mask>& mask, const SensorModel& sensor);

// The image of a cloud [m]. Each pixel takes the nearest point that projects into it and becomes a candidate.
OrganisedImage project_cloud(const std::vector<Eigen::Vector3f>& points_in_camera, const PinholeCamera& camera);

CandidateExtent find_candidates(const OrganisedImage& image, const PinholeCamera& camera);

// The measured point of a pixel that has depth [m].
inline Eigen::Vector3d point_at(const OrganisedImage& image, const PinholeCamera& camera, int pixel) {
    const int u = pixel % camera.width, v = pixel / camera.width;
    return static_cast<double>(image.depth_m[pixel]) * camera.ray(u, v);
}

// Unit normal of the surface around a pixel, towards the camera, from its neighbours at `reach` pixels. Zero where they
// have no depth or lie across a depth edge.
Eigen::Vector3f normal_at(const OrganisedImage& image, const PinholeCamera& camera, int pixel, int reach);

// At most about `max_points` candidates, on a grid of equal spacing in u and v.
CandidateCloud sample_candidates(const OrganisedImage& image, const PinholeCamera& camera,
                                 const CandidateExtent& candidates, int max_points);

}  // namespace nearpose
