// What decides in the search for symmetries. Lengths are shares of the model's diameter (the diagonal of its box),
// which every part has; the one length in metres, the sensor's resolution, is an argument of the search.
#pragma once

namespace nearpose {

// Views of the model from directions spread evenly around it, whole in each square image.
struct SurroundingViewOptions {
    int coarse_directions = 16;  // for everything but the last word on an exact symmetry
    int coarse_pixels_across = 48;
    int fine_directions = 20;  // for the last word: a detail of 1/50 of the diameter meets several rays
    int fine_pixels_across = 112;
};

// Which axes are tried.
struct CandidateAxisOptions {
    double same_direction = 0.999;           // cosine: 2.5 degrees, which the refinement makes up for
    double equal_moments = 0.06;             // relative difference of two principal moments; sampling makes 0.02 of it
    double distinct_axes_diameters = 0.015;  // between parallel axes; the refinement makes up for less
    double same_face = 0.996;                // cosine between normals: 5 degrees
    double min_face_share = 0.02;            // of the surface that is seen
    int max_faces = 8;                       // the largest; their pairs suggest the axes of a polyhedron
};

// The alignment of the turned surface with the surface, point to plane.
struct AxisRefinementOptions {
    int steps = 5;
    double first_gate_diameters = 0.05;  // pairs farther apart do not count
    double gate_factor = 0.4;            // of each step to the next; the gate never falls below twice the resolution
    double min_normal_cosine = 0.7;      // between the normals of a pair; 45 degrees
};

// When a turn is no exact symmetry: the surface differs somewhere by more than the resolution.
struct DifferenceOptions {
    int detail_rays = 3;  // that differ side by side are a detail of the part; fewer are seams of its triangles
    double max_seam_share = 0.002;  // of all rays; more that differ, wherever they are, are a difference
};

// The self-agreement of a turn is the share of rays on which the surface before and after it coincide.
struct SelfAgreementOptions {
    double coarse_tolerance_diameters = 0.02;  // beside the resolution, for an axis that is not refined yet
    double min_coarse_agreement = 0.7;         // below it a turn is not looked at further
    int coarse_stride = 3;                     // every third ray in u and v
    double near_tolerance_diameters = 0.005;   // beside the resolution, for a refined axis
    double min_near_agreement = 0.88;          // of a near-symmetry
    int near_stride = 2;                       // where a turn is compared with others
    double aside_rad = 0.12;                   // a near-symmetry stands out from the turns this far to both sides:
    double min_contrast = 1.4;                 // by this factor more of their rays differ
};

struct SymmetrySearchOptions {
    SurroundingViewOptions views;
    CandidateAxisOptions axes;
    AxisRefinementOptions refinement;
    DifferenceOptions difference;
    SelfAgreementOptions agreement;
    int max_fold = 12;         // turns by 1/2 .. 1/max_fold of a full one are tried about each axis
    int half_turn_steps = 60;  // directions of half-turn axes across a dihedral axis, over 180 degrees
};

// Throws std::invalid_argument that names the field.
void validate(const SymmetrySearchOptions& options);

}  // namespace nearpose
