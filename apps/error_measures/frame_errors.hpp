// What is known of one frame of a run once the truth is known.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/error_measures/model_shape.hpp"
#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"
#include "core/base/pose.hpp"
#include "core/evidence/verdict.hpp"

namespace nearpose::evaluation {

// What the image tells of how much of the part is to be seen.
struct Visibility {
    double distance_m = 0.0;         // of the mean of the visible points from the camera (the paper's distance)
    double visible_volume_m3 = 0.0;  // of the ellipsoid of the visible points' principal axes (the paper's volume)
    std::optional<double> visible_fraction;  // of the silhouette on the enlarged canvas, in 0..1
};
// From the measured points on the part [m], camera frame. The ellipsoid's semi-axes are two standard deviations of the
// points along their principal axes: 4/3 pi 8 sqrt(l1 l2 l3) with the eigenvalues of their covariance.
Visibility visibility_of(const std::vector<Eigen::Vector3f>& visible_points_in_camera);
// From the depth measured in the mask of the visible part, both of `camera`'s size; nothing where none is.
std::optional<Visibility> visibility_of(const DepthImage& depth, const Mask& visible, const PinholeCamera& camera);

// What there is to be seen in a frame's image.
enum class Shown {
    kPart,
    kNothing,   // of the part: it is out of view, or not there
    kNonsense,  // what no camera would see there
};

struct TrueFrame {
    int frame_id = 0;
    Pose camera_from_object;  // but for kPart: where the part would be
    std::optional<Visibility> visibility;
    Shown shown = Shown::kPart;
    bool part_moved = false;   // the part was put down elsewhere since the frame before
    bool after_fault = false;  // the recording had a fault, and has none from here on
};

struct EstimatedFrame {
    Pose camera_from_object;
    double score = 0.0;
    double time_s = 0.0;                 // for the whole frame; < 0: not known
    bool predicted = false;              // the object was not seen; the pose is a prediction
    std::optional<Matrix6d> covariance;  // of camera_from_object * exp(twist), rotation first
    std::optional<Verdict> verdict = {};
};

// Errors of one pose. Of the poses in which a symmetric part looks the same, the one counts that is nearest.
struct PoseErrors {
    Eigen::Vector3d translation_in_camera_m = Eigen::Vector3d::Zero();  // estimate - truth, of the centre of the box
    Eigen::Vector3d rotation_in_camera_rad = Eigen::Vector3d::Zero();   // rotation vector of estimate * truth^-1
    double translation_m = 0.0;                                         // norms of both
    double rotation_rad = 0.0;
    double add_m = 0.0;    // mean distance of the model's vertices; knows no symmetries, as in bop_toolkit
    double add_s_m = 0.0;  // mean distance from each vertex in the true pose to the nearest in the estimated one
    double mssd_m = 0.0;   // maximum symmetry-aware surface distance
    double mspd_px = 0.0;  // maximum symmetry-aware projection distance
    // Squared Mahalanobis distance of the truth from the estimate under its covariance (6 degrees of freedom).
    std::optional<double> mahalanobis_squared;
    std::optional<double> mahalanobis_rotation_squared, mahalanobis_translation_squared;  // of either part, 3 degrees
};

// A symmetric part looks the same in several poses: of those of `truth` the one in which the corners of the model's box
// are nearest to where the estimate has them (their largest distance is least). Continuous symmetries are searched to
// the bottom, not only at samples.
Pose nearest_equivalent(const Pose& estimate, const Pose& truth, const data_set::ModelInfo& model);

// Errors of translation and rotation alone; the others are left 0.
PoseErrors pose_error(const Pose& estimate, const Pose& truth, const data_set::ModelInfo& model);

struct FrameErrors {
    int frame_id = 0;
    std::optional<Visibility> visibility;
    std::optional<PoseErrors> errors;  // none: no pose
    double score = 0.0;
    double time_s = -1.0;
    bool predicted = false;
    std::optional<Verdict> verdict;  // none: not known; a frame without a pose may have one
    Shown shown = Shown::kPart;      // where it is not the part, the errors are no errors
    bool part_moved = false;         // as in TrueFrame
    bool after_fault = false;        // as in TrueFrame; tables do not have it
};

// `camera` is for MSPD alone.
FrameErrors frame_errors(const TrueFrame& truth, const std::optional<EstimatedFrame>& estimate, const ModelShape& shape,
                         const PinholeCamera& camera);

// A CSV table, a row a frame, millimetres and degrees; what it does not know is left empty. With a tolerance a last
// column tells which verdicts are wrong by it: false_accept, missed (verdict_counts.hpp). Reading gives back what was
// written to the digits that were written, but for that column and for after_fault, and takes tables from before there
// were verdicts; throws std::runtime_error naming file, line and column.
std::string table_of(const std::vector<FrameErrors>& frames, const std::optional<Tolerance>& tolerance = std::nullopt);
std::vector<FrameErrors> read_table(const std::filesystem::path& csv);

}  // namespace nearpose::evaluation
