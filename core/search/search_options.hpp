// Options of global localisation: every number that decides where the object is looked for. Lengths in diameters are
// fractions of the model's diameter (of its box). Where a comment names no measurement, the number was only set.
#pragma once

#include <array>
#include <string>

#include "core/filter/gradient_step.hpp"

namespace nearpose {

// Where the particles come from at first, and after a loss.
enum class Initialisation {
    kSphere,   // the paper's: viewpoints on a sphere around the centroid of what is seen
    kSurface,  // also single points of the model on measured ones
    kPairs,    // also pairs of points
};

// Views of the model from all around, from which its surface is sampled. At two diameters the model's sphere covers 77
// % of the image's side.
struct SurfaceViewOptions {
    int directions = 32;
    int side_pixels = 64;             // the images are square
    double distance_diameters = 2.0;  // of the camera from the model's centre
    double focal_sides = 1.5;         // focal length, in sides of the image
};

// The model's oriented points: of the search, and of its pairs.
struct SurfacePointOptions {
    SurfaceViewOptions views;
    int count = 4000;  // about so many are kept of all that the views show
};

// The voxel grid that finds the nearest point of the model.
struct ClosestPointGridOptions {
    SurfaceViewOptions views{128, 64, 2.0, 1.5};
    double voxel_diameters = 1.0 / 80.0;
    int reach_voxels = 5;  // farther from the surface nothing is near
};

// The largest flat face of the model.
struct LargestFaceOptions {
    double tolerance_diameters = 0.02;  // how far the points of one face may lie off its plane
    int points = 600;                   // of the model, among which each plane is fitted
    int planes = 400;                   // tried, each through an oriented point
};

// Pairs of the model's oriented points.
struct PointPairTableOptions {
    double min_distance_diameters = 0.1;  // between the points of a pair; nearer ones turn with the noise
    double max_distance_diameters = 0.6;  // farther ones are seldom both in view
    int distance_cells = 10;
    int angle_cells = 18;   // of 10 degrees each
    int max_points = 1000;  // about so many form pairs; these are a million
    LargestFaceOptions face;
};

// The measured surface on a coarse grid of the image.
struct SurfelOptions {
    int count = 4000;  // about so many, on the box of what may be the object
    // A surfel's normal is that of a plane through samples of a window around its pixel, `reach` pixels to each side.
    double reach_min_distances = 0.25;  // of the shortest pair in the table: noise is small over that length
    int min_reach_pixels = 2;
    int max_reach_pixels = 20;
    int window_half = 2;                // (2 half + 1)^2 samples
    double window_depth_reaches = 2.0;  // samples farther in depth are of another surface
    int min_samples = 9;                // of the window, in the plane
    double plane_sigmas = 3.0;          // how far they may lie off the plane: of the sensor's noise,
    double plane_reaches = 0.1;         // and for the surface's curvature
    int normal_fits = 2;                // of the plane, each to what lies in the one before
    // Large planes of the image, found by sample consensus.
    int planes = 3;                // the largest
    double min_plane_share = 0.1;  // of the points in no plane yet; a smaller plane is left as it is
    int plane_points = 500;        // about so many points judge a plane
    int plane_draws = 100;         // of three points each
    int plane_fits = 2;            // of the best plane to its points
};

// Which measured points lie on the model, and which of the model's on what is measured.
struct InlierOptions {
    float min_normal_cosine = 0.7F;        // between the normals of what may be one surface
    float max_distance_tolerances = 2.0F;  // of a measured point to the model's sample; across it one tolerance
    float max_depth_tolerances = 4.0F;     // of a model's point to the surfel, whose plane holds no farther
};

// Point-to-plane steps that align measured points with the model's closest-point grid.
struct AlignmentOptions {
    float min_normal_cosine = 0.5F;  // of a pair; less than of an inlier, since the pose is still off
    double gate_tolerances = 0.5;    // distance of a pair, times (rounds left + 1): narrower from round to round
    double damping_points = 1.0;     // the prior that nothing moves weighs as many points as that
    double scale_reaches = 4.0;      // the length that weighs as a turn of 1 rad, in reaches of the grid
};

// One stage of the pruning cascade.
struct PruningStage {
    int kept;                 // hypotheses that enter it, the best of those before
    bool distinct;            // at most one from each cell of poses enters
    int alignment_rounds;     // of each
    int points;               // measured ones by which it is scored; 0: all
    double score_tolerances;  // distance of an inlier, in tolerances of the search
};

// From all hypotheses to the few that are wanted, before any view is cast: the fewer are left, the more each may cost.
struct PruningOptions {
    // Most hypotheses are wrong everywhere. One with which none of the first points agrees is scored no further: that
    // spares a fifth of a search's time.
    int first_points = 8;         // measured
    int first_model_points = 16;  // of the model
    int coarse_points = 32;
    int coarse_model_points = 64;
    // A hypothesis that was not aligned yet is off by more than the tolerance. With twice of it until the alignment,
    // all points in the last stage and the preselection after it, the right pose came through in 43 of 60 searches of
    // ten hard scenes. It was 12 before, in a seventh less time.
    double coarse_tolerances = 2.0;
    std::array<PruningStage, 3> stages{{{4000, false, 0, 128, 2.0}, {1500, true, 3, 128, 1.0}, {300, true, 4, 0, 0.5}}};
    // Poses of one cell lead to one optimum; the cells are coarse.
    double cell_diameters = 0.06;  // of the place of the model's centre
    double cell_cosine = 0.25;     // of the components of the axes
    InlierOptions inliers;
    AlignmentOptions alignment;
    // The model before the measured surface, where the sensor looked through it, costs 1 up to that depth and then
    // more, up to free_space_cost at twice the depth. As in the pixel cost, whose 4 is for poses that are refined.
    float free_space_depth_diameters = 0.05F;
    float free_space_cost = 3.0F;
};

// Hypotheses from pairs of oriented points (point pair features, Drost et al. 2010). Without them the part is found in
// 1 of 20 recordings that have no mask.
struct PairSearchOptions {
    // Model and depth agree within this as a start: of the shortest pair in the table, and of the sensor's noise.
    double tolerance_min_distances = 0.25;
    double tolerance_sigmas = 2.0;
    int second_points = 8;                // drawn for a first one; that with the fewest matches says most
    double max_radius_image_sides = 0.7;  // of a second point, in longer sides of the image; farther is out of it
    double min_sine = 0.2;                // between line and first normal; less leaves the turn about them open
    // Where all that is seen is one face, no pair is found there: one draw in so many takes a single point instead.
    int single_point_period = 4;
    // A plane that fills the view may be a face of the part, or a table or a gripper's palm that hides it. One draw in
    // so many takes it for a face: it draws surfels by draw_weight, the others by balanced_draw_weight.
    int unbalanced_period = 2;
    int measured_points = 256;  // by which hypotheses are scored
    int model_points = 256;     // the same of the model, where nothing is segmented
};

struct SearchOptions {
    Initialisation initialisation = Initialisation::kSphere;
    int candidates = 0;         // poses of which the best become the particles; 0: all of them do
    int least_candidates = 20;  // of a search that the time budget cuts short
    // Of kPairs, where the object is segmented: hypotheses drawn and pruned to the candidates. 300 candidates from
    // 10000 find what 1500 from 40000 did in more than twice the time.
    int draws = 10000;
    int draws_factor_unsegmented = 6;  // so many times as many where it is not: most of them miss the object
    // Candidates that come from pairs, in 0..1; a larger share where the object is not segmented.
    double pair_share_segmented = 0.5;
    double pair_share_unsegmented = 2.0 / 3.0;
    // Of the remaining candidates of a segmented object the share on the paper's sphere; the others lie on its surface.
    double sphere_share = 0.5;
    int sphere_shifts = 2;  // each lays the seen surface on the measured one; the first changes what is seen
    GradientStep step;      // taken by each candidate
    SurfacePointOptions surface_points;
    ClosestPointGridOptions closest_point_grid;
    PointPairTableOptions point_pair_table;
    SurfelOptions surfels;
    PairSearchOptions pairs;
    PruningOptions pruning;
};

// Each throws std::invalid_argument naming field, value and bound; `name` comes before the field.
void validate(const SurfaceViewOptions& options, const std::string& name);
void validate(const SurfacePointOptions& options, const std::string& name);
void validate(const ClosestPointGridOptions& options, const std::string& name);
void validate(const LargestFaceOptions& options, const std::string& name);
void validate(const PointPairTableOptions& options, const std::string& name);
void validate(const SurfelOptions& options, const std::string& name);
void validate(const InlierOptions& options, const std::string& name);
void validate(const AlignmentOptions& options, const std::string& name);
void validate(const PruningOptions& options, const std::string& name);
void validate(const PairSearchOptions& options, const std::string& name);
void validate(const SearchOptions& options);

}  // namespace nearpose
