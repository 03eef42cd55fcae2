// Which variant of each step the estimator uses, and with which numbers: all that is tuning stands here, or in the
// options that a room declares beside its functions. What is physics stands in the sensor's model. Lengths are
// fractions of the model's diameter (of its box) where they scale with the part; nothing is tuned to one object.
#pragma once

#include "core/evidence/background.hpp"
#include "core/evidence/likelihood.hpp"
#include "core/evidence/verdict.hpp"
#include "core/filter/gradient_step.hpp"
#include "core/fit/joint_fit.hpp"
#include "core/fit/track.hpp"
#include "core/observation/image_sample.hpp"
#include "core/search/search_options.hpp"
#include "core/shape/modes.hpp"
#include "core/world/arm_check.hpp"

namespace nearpose {

// The particle filter.
struct FilterOptions {
    double diffusion_rotation_rad = 0.03;
    double diffusion_diameters = 0.008;
    // Instead, in a frame for which the arm's motion was not measured. The default method takes 0.03: with less a
    // hand-held sequence lagged by 12 to 20 mm in fast moves.
    double unmeasured_diffusion_diameters = 0.008;
    double resample_below = 0.5;  // effective sample size, as a fraction of the particles
};

// Which hypotheses are refined in a frame: modes of the particles, and alternatives that they may be mistaken for.
struct HypothesisOptions {
    int modes = 0;                 // best distinct modes of the particles that are refined; 0: the MAP is the estimate
    int alternatives = 0;          // poses that the best modes may be mistaken for, tried as further hypotheses
    int alternatives_period = 10;  // frames between such trials once the track is settled
    int alternatives_refined = 3;  // the best of them
    int leaders = 2;               // modes whose alternatives are tried
    AlternativeOptions changes;    // which turns and shifts
    // Poses closer than both are one mode.
    double mode_rotation_rad = 0.15;
    double mode_translation_diameters = 0.03;
};

// For a search where nothing is segmented: modes and hypotheses from pairs are refined a little on few rays, and the
// best of them in full. Without it the right pose came first in 19 instead of 20 of 20 cluttered scenes.
struct PreselectionOptions {
    int tried = 24;  // of the particles' modes, and of the hypotheses from pairs; 0: no preselection
    int rays = 800;
    int rounds = 3;
    int kept = 8;  // also of the hypotheses from pairs that are refined where there is no preselection
    // For the choice between modes all over the image, of the evidence against planes; 0: that does not count. Without
    // it a stereo camera's image of the block among other things shows the block in a wall.
    int presence_rays = 2000;
    int disambiguated = 4;  // modes near the chosen one that are compared with it on the object alone
};

// Which hypothesis becomes the estimate.
struct ChoiceOptions {
    double challenge_nats = 6.0;  // log-odds by which another mode replaces the tracked one
    double min_support = 0.25;    // share of a mode's rays that agree with the depth; less shows nothing of the object
    // While the arm's motion is known, an accepted pose is replaced only by as much evidence as it was accepted on;
    // from frame to frame this share of it is kept. Without it 5 instead of 19 of 20 approaches to the bracket held.
    bool accepted_evidence = true;
    double accepted_evidence_kept = 0.7;
    // Log-odds of alternatives add up over the frames, of which this share is kept from one to the next: what misleads
    // one image, such as a smooth error of the sensor, misleads the next one as well.
    double log_odds_kept = 0.8;             // where the camera's motion is measured
    double log_odds_kept_unmeasured = 0.5;  // where it is not
    // The likeliest alternatives are remembered: so many, down to these log-odds.
    int alternatives_remembered = 6;
    double least_log_odds = -12.0;
    double alternatives_within_diameters = 0.5;  // their centres, of that of the chosen pose
};

// How long the object is believed to be there. The log-odds are those of a Bayes filter that forgets: what the frames
// before showed counts on, and each frame's evidence is added. So a part that was seen is believed in while only a flat
// face of it is in view; the bound keeps a part that was taken away from being believed in.
struct PresenceOptions {
    double kept = 0.95;            // from frame to frame, where the camera's motion is measured
    double kept_unmeasured = 0.5;  // where it is not
    double max_log_odds = 20.0;    // either way [nats]
};

// When the object is searched for anew although there is a pose.
struct RelocalisationOptions {
    int frames_contradicted = 1;     // in a row; 0: never
    bool low_agreement = true;       // also while the agreement is too low to be verified:
    int low_agreement_at_first = 4;  // in so many frames,
    int low_agreement_period = 16;   // and later once in so many
    // After so many frames in a row that showed nothing of it, a search is spread over frames: each of them makes a
    // part of it with other draws. Where the part is not there, a frame takes a quarter of the time or less.
    int whole_searches = 4;
    int parts_of_search = 8;
};

// The most that a frame may spend in one phase.
struct PhaseEffort {
    int particle_rays;  // of a particle's view, and of an alternative's
    int mode_rays;      // of a refined view
    int mode_rounds;    // of refinement
    int alternatives;   // tried
};

// What is spared in the phases comparing, confirming and tracking. In searching and acquiring the method's own numbers
// hold: with fewer rays for particles there, 3 more of 45 cluttered runs went wrong. In tracking the posterior is
// narrow, and a few particles describe it (KLD sampling, Fox 2003).
struct AdaptiveEffort {
    bool on = false;
    int frames_to_confirm = 5;  // without replacement, after which the track is confirmed
    // With 2000 rays of refinement a flange's alternatives in clutter keep 20 to 70 % of the probability, with all 3
    // to 30 %.
    PhaseEffort comparing{.particle_rays = 128, .mode_rays = 100000, .mode_rounds = 3, .alternatives = 100000};
    // As many alternatives as the method says. With 800 rays of refinement a tenth fewer frames are accepted.
    PhaseEffort confirming{.particle_rays = 128, .mode_rays = 2000, .mode_rounds = 3, .alternatives = 100000};
    PhaseEffort tracking{.particle_rays = 128, .mode_rays = 800, .mode_rounds = 2, .alternatives = 32};
    int predicted_rounds = 1;  // of a particle, where the image agrees with the predicted pose
    // Of the joint fit while tracking, at the sensor's least noise; proportionally more where there is more of it. With
    // 1000 / 2000 / 3000 / 7000 rays everywhere the error is 0.18 / 0.15 / 0.13 / 0.11 mm, a frame 3.1 ... 6.9 ms.
    int fit_rays = 2500;
    int min_particles = 8;              // for a posterior of one mode
    int min_particles_unmeasured = 32;  // the same, where the arm's motion was not measured
    // Bound on the Kullback-Leibler distance between particles and posterior, with 99 % confidence. Particles that are
    // less likely than the best by more than `far_less_likely_nats` do not count.
    double kld_error = 0.15;
    double far_less_likely_nats = 7.0;
};

struct Method {
    SearchOptions search;
    FilterOptions filter;
    double window_margin = 0.2;  // of the image box in which the object may lie: model beyond what is seen must show
    GradientStep step;           // taken by each particle in each frame
    Cost cost = Cost::kPixels;
    bool scale_by_overlap = true;  // of kOverlapMse: times m / n; false: the plain mean squared error of the pairs
    PixelCostOptions pixel_cost;
    // The pixel cost's free_space_depth_m; 0: all depths cost alike. From 0.07 on the flange without a mask is held in
    // 16 instead of 20 of 20 runs.
    double free_space_depth_diameters = 0.05;
    HypothesisOptions hypotheses;
    PreselectionOptions preselection;
    RefinementOptions refinement;
    ChoiceOptions choice;
    bool fusion = true;  // the chosen mode is fitted jointly with the sensor's errors and fused with the track
    FitOptions fit;
    TrackOptions track;
    BackgroundOptions background;
    PresenceOptions presence;
    RepeatedImageOptions repeated_image;
    ArmCheckOptions arm_check;
    VerificationOptions verification;
    RelocalisationOptions relocalisation;
    AdaptiveEffort effort;
};

// The paper to the letter: sphere start, nearest neighbours within 30 mm on a part of 0.43 m, sample consensus, three
// rounds, overlap-scaled mean squared error, MAP = smallest weight. Its least squares are point-to-point.
Method method_paper();

// Projective point-to-plane steps, a cost per pixel, a search by point pairs, and the best modes refined and challenged
// by their alternatives.
Method method_default();

// Throws std::invalid_argument naming field, value and bound.
void validate(const Method& method);

}  // namespace nearpose
