// Which variant of each step the estimator uses, and with which numbers. Lengths are fractions of the model's diameter
// (of its box) where they scale with the part; nothing is tuned to one object.
#pragma once

#include "core/evidence/likelihood.hpp"
#include "core/shape/modes.hpp"

namespace nearpose {

enum class Association { kNearest, kProjective };
enum class Cost { kOverlapMse, kPixels };
enum class Start { kSphere, kSurface, kPairs };

// The gradient step of one particle: a few rounds of correspondence and least squares.
struct GradientStep {
    Association association = Association::kProjective;
    double max_distance_diameters = 0.1;  // of a pair
    double extra_sigma_diameters = 0.01;  // added to the sensor's noise: how far off the pose may still be
    double max_normal_angle_rad = 0.0;    // between a pair's normals; 0: not checked
    int consensus_draws = 0;              // of the sample-consensus rejection; 0: none
    double consensus_distance_diameters = 0.02;
    int rounds = 3;          // 0: the pose is weighed where it is
    double step_size = 1.0;  // gamma: the fraction of each solve that is taken, along the geodesic
    int max_rays = 768;      // of the view
};

// What the default method adds to the paper's filter. Each part is off at 0.
struct Refinement {
    int modes = 0;                               // best distinct modes of the swarm that are refined every frame
    int rounds = 5;                              // the view is cast anew every other round
    int max_rays = 6000;                         // of a refined view
    double first_extra_sigma_diameters = 0.006;  // halved every round
    double cost_sigma_diameters = 0.002;         // tolerance of the cost that decides between modes
    double rays_per_evidence = 10.0;             // neighbouring rays share errors: so many count as one
    double challenge_nats = 6.0;  // a mode for which the image speaks so much more replaces the tracked one
    bool outline = true;          // a face laid into a larger flat one is no object
    int rivals = 0;               // poses that the best modes may be mistaken for, tried as further modes
    int rival_period = 10;        // frames between such trials once one mode holds
    int rival_modes = 3;          // of them that are refined
    int shortlist = 24;  // of a search where nothing is segmented: so many of the swarm's modes and of the starts
                         // are looked at with few rays, and the best 8 are refined; 0: the first
    double min_support = 0.25;  // share of a mode's rays that agree with the depth; less shows nothing of the object
    bool confidence = true;     // what was accepted yields to as much evidence as it was accepted for, and not to less
    bool doubts = true;         // an estimate that does not convince is searched for anew, as one that is contradicted
    bool fusion = true;         // the chosen mode is fused with the track: arm's motion and sensor's errors
    int frames_to_search =
        1;  // frames in a row whose estimate does not convince, after which the object is searched for anew; 0: never
    int frames_to_hold = 5;  // frames without replacement after which one mode holds
};

// What is spared while one mode holds: the posterior is narrow then, and a few particles describe it (KLD sampling, Fox
// 2003). From the first estimate that convinces until then all particles and rivals stay, and less is cast for each. At
// the start, after a loss and while a rival is not ruled out everything is as without.
struct Economy {
    bool on = false;
    int min_particles = 8;              // for a swarm of one mode
    int min_particles_unmeasured = 32;  // the same, where the arm's motion was not measured
    double kld_error =
        0.15;             // bound on the Kullback-Leibler distance between swarm and posterior, with 99 % confidence
    int step_rays = 128;  // of a particle's view, and of a rival's
    int step_rounds = 1;  // of a particle, where the arm's motion foretold what is seen
    int rays = 800;       // of a refined view
    int rounds = 2;       // of refinement
    int confirming_rays = 2000;  // of a refined view, until one mode holds
    int confirming_rounds = 3;   // of refinement, until then
    int fit_rays = 2500;         // of the fine fit's view where the noise is the sensor's least; more where it is more
    int rivals = 32;
};

struct Method {
    Start start = Start::kSphere;
    int start_candidates = 0;  // random starts of which the best become the particles; 0: the particles themselves
    int start_draws = 10000;  // of kPairs, where the object is segmented: guesses drawn and screened, the best of which
                              // are candidates and refined; several times as many where it is not
    GradientStep start_step;  // taken by each of them
    GradientStep step;        // taken by each particle in each frame
    Cost cost = Cost::kPixels;
    bool scale_by_overlap = true;  // of kOverlapMse: times m / n; false: the plain mean squared error of the pairs
    PixelCostOptions pixel_cost;
    double deep_diameters = 0.05;  // of the pixel cost: its deep_m; 0: none is deep
    Refinement refinement;
    Economy economy;
    double diffusion_rotation_rad = 0.03;
    double diffusion_diameters = 0.008;
    double unmeasured_diffusion_diameters = 0.008;  // instead, in a frame for which the arm's motion was not measured
    double resample_below = 0.5;                    // effective sample size, as a fraction of the particles
};

// The paper to the letter: sphere start, nearest neighbours within 30 mm on a part of 0.43 m, sample consensus, three
// rounds, overlap-scaled mean squared error, MAP = smallest weight. Its least squares are point-to-point.
Method method_paper();

// Projective point-to-plane steps, a cost per pixel, many starts on the first frame, the best modes refined and
// challenged by their rivals.
Method method_default();

// Throws std::invalid_argument naming field, value and bound.
void validate(const Method& method);

}  // namespace nearpose
