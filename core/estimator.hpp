// The estimator: the paper's particle filter over SE(3), one observation at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <vector>

#include "core/gradient_step.hpp"
#include "core/information.hpp"
#include "core/method.hpp"
#include "core/modes.hpp"
#include "core/observation.hpp"
#include "core/particles.hpp"
#include "core/pose_solver.hpp"
#include "core/start.hpp"
#include "core/start_pairs.hpp"
#include "core/symmetry.hpp"
#include "core/time_budget.hpp"
#include "core/track.hpp"
#include "core/verdict.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

struct EstimatorOptions {
    Method method = method_default();
    int num_particles = 200;
    int num_threads = 0;  // 0: as many as the machine has
    std::uint64_t seed = 1;
    int min_candidates = 50;   // pixels; fewer show nothing of the object
    Symmetries symmetries;     // of the part
    Tolerance tolerance;       // of the verdict
    MotionNoise motion_noise;  // of the arm
    double budget_s = 0.0;  // for an update, elapsed; particles, rivals, modes and starts are left out to keep within
                            // it, and results then depend on the machine's speed. 0: as long as it takes
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const EstimatorOptions& options);

enum class UpdateStatus {
    kEstimated,  // from this observation
    kPredicted,  // the observation shows nothing of the object; the pose before, moved by the control, stands in
    kNoPose,     // nothing was seen yet
};

const char* to_string(UpdateStatus status);

struct UpdateSeconds {
    StageSeconds stages;                                                 // summed over threads
    double start = 0.0, particles = 0.0, refinement = 0.0, total = 0.0;  // elapsed
};

// What an update was made with.
struct Effort {
    int starts = 0;  // candidates of a search; 0: none was made
    int particles = 0;
    int rivals = 0;
    int modes = 0;                    // refined
    bool reduced_for_budget = false;  // more would have been made with more time
};

struct UpdateResult {
    UpdateStatus status = UpdateStatus::kNoPose;
    Pose camera_from_object;                 // the MAP; meaningless where there is no pose
    Matrix6d covariance = Matrix6d::Zero();  // of the twist of camera_from_object * exp(twist), rotation first
    double cost = 0.0;                       // of the MAP: PixelCost::cost, or epsilon [m^2]
    double score = 0.0;                      // larger is better: 1 - pixel cost, or 1 / (1 + epsilon / sigma^2)
    Verdict verdict = Verdict::kContinue;    // may the pose be acted on?
    std::vector<Mode> modes;                 // refined, best first; the default method's
    Observability observability;             // of this frame alone; the tracked pose may be known better
    PixelCost pixels;                        // how the estimate's rays compare with the depth image
    Effort effort;
    double effective_sample_size = 0.0;  // 1..number of particles, after weighting
    bool resampled = false;              // before this update's propagation
    bool mode_replaced = false;          // another mode explains the observation better than the tracked one
    int points_observed = 0;             // candidate pixels
    StepCounts counts;
    UpdateSeconds seconds;
};

// One estimator belongs to one caller thread; several estimators may run at once. The same seed and observations give
// the same bits for any number of threads.
class PoseEstimator {
  public:
    // The constructor does all slow set-up. Throws std::invalid_argument for options out of bounds.
    PoseEstimator(std::shared_ptr<const ViewGenerator> views, std::shared_ptr<const PoseSolver> solver,
                  const EstimatorOptions& options);

    // Takes in one observation. `now_from_before` is the measured camera motion since the last update (it maps camera
    // coordinates of the frame before to those of this one); nothing where it was not measured, and a transform that is
    // not finite counts as that. Never throws for data.
    UpdateResult update(const Observation& observation, const std::optional<Pose>& now_from_before);

    // Starts over: without a pose, or around one with a spread (standard deviations about the model's centre). Throws
    // std::invalid_argument for a pose that is not valid.
    void reset();
    void reset(const Pose& camera_from_object, const Diffusion& spread);

    const ParticleSet& particles() const { return particles_; }

  private:
    // What an update spends: all, less on each pose while an estimate is confirmed, or less of all while one is kept.
    enum class Effort { kWhole, kConfirming, kKeeping };

    void predict(const std::optional<Pose>& now_from_before, UpdateResult& result);
    void start(const Observation& observation, UpdateResult& result);
    ParticleSet start_where_surfaces_meet(const Observation& observation, int count, int draws);
    void keep_best_starts(const Observation& observation, UpdateResult& result);
    void move_particles(const Observation& observation, UpdateResult& result);
    // Both choose the estimate; false: no pose shows the object in this observation.
    bool take_map(const Observation& observation, UpdateResult& result);
    bool take_refined_mode(const Observation& observation, UpdateResult& result);
    Mode look_closer(const Mode& chosen, const Observation& observation, UpdateResult& result);
    int affordable(Stage stage, int wanted, int least, UpdateResult& result) const;
    void remember(const Observation& observation, const UpdateResult& result);
    double evidence_of(const PixelCost& pixels) const;
    bool tells_as_much(const Pose& fitted, const StepContext& context) const;
    bool search_again() const;
    std::vector<Mode> near_modes(const std::vector<Mode>& modes) const;
    void bring_to_one_representative(std::vector<Mode>& modes) const;
    bool one_mode_holds() const;
    bool searching_everywhere(const Observation& observation) const;
    std::optional<MovedParticle> foretold_pose(const Observation& observation);
    bool rivals_due() const;
    Effort effort_needed() const;
    int particles_wanted(bool motion_measured) const;
    GradientStep step_now() const;
    Refinement refinement_now() const;
    void weigh_rivals(const UpdateResult& result, bool tried);
    std::vector<Mode> modes_to_refine(const Observation& observation, UpdateResult& result);
    std::vector<Mode> shortlisted(const std::vector<Mode>& swarm, const Observation& observation, UpdateResult& result);
    MovedParticle tracked_unmoved(const Observation& observation);
    std::vector<Mode> best_rivals(const std::vector<Mode>& leaders, const Observation& observation,
                                  UpdateResult& result);
    std::vector<MovedParticle> move_all(const std::vector<Pose>& poses, const Observation& observation,
                                        const GradientStep& step, RandomPurpose purpose, UpdateResult& result) const;
    std::vector<Mode> refine_all(const std::vector<Mode>& modes, const Observation& observation, UpdateResult& result);
    StepContext context_for(const Observation& observation, const ObservedGrid& observed,
                            const GradientStep& step) const;
    StepContext fine_context(const PixelGrid& grid, const Observation& observation);
    ObservedGrid observe_on(const PixelGrid& grid, const Observation& observation) const;
    PixelGrid grid_for(const Observation& observation, int max_rays) const;
    PixelGrid grid_around(const Pose& camera_from_object, const Observation& observation, int max_rays) const;
    PixelGrid grid_to_fit(const Pose& camera_from_object, const Observation& observation, int max_rays) const;
    PixelBox box_around(const Pose& camera_from_object, const Observation& observation) const;
    void weigh_against_image(int stride, const Observation& observation, MovedParticle& moved) const;
    ModeDistance mode_distance() const;
    void correct_tracked(const Mode& chosen, bool replaced, const Observation& observation);
    void describe_estimate(const Observation& observation, UpdateResult& result);

    std::shared_ptr<const ViewGenerator> views_;
    std::shared_ptr<const PoseSolver> solver_;
    EstimatorOptions options_;
    std::vector<SurfaceAnchor> anchors_;  // of the start on the surface; that on pairs has its own
    std::optional<AnchorPairs> pairs_;
    std::optional<PatchGrid> patches_;  // while searching
    std::vector<Pose> screened_;        // while searching: the best starts on pairs
    std::optional<Pose> before_loss_;   // from a search on until one mode holds: the lost pose, as the arm carries it
    std::optional<Pose> close_up_;      // while searching: where the modes are told apart
    std::optional<MovedParticle> foretold_;  // during an update: the prediction, where the image agrees with it
    std::list<ObservedGrid> fine_;           // during an update, the grids of refined views
    TimeBudget budget_;
    std::chrono::steady_clock::time_point update_began_;
    ParticleSet particles_;
    std::optional<Mode> tracked_;           // the estimate of the last update
    std::optional<Track> track_;            // the same with its spread; the default method's
    std::vector<double> last_costs_;        // of the particles
    std::uint64_t step_ = 0;                // updates so far; addresses the random streams
    Matrix6d observed_ = Matrix6d::Zero();  // covariance of the last observation's own fit, about the centre
    double rival_weight_ = 0.0;             // when rivals were last tried
    bool searching_ = false;                // in this update the object may be anywhere
    Effort effort_ = Effort::kWhole;        // of this update
    bool rivals_tried_ = false;             // since the tracked mode was last replaced
    int frames_lost_ = 0;                   // updates in a row whose estimate contradicts what is seen
    bool convinced_ = false;                // the last update's estimate is the right one, as far as can be told
    bool doubtful_ = false;                 // the last update's estimate did not convince
    int frames_doubtful_ = 0;               // updates for which that was so since one was accepted
    double confidence_ = 0.0;               // by how much the image spoke for what was accepted last, fading: nats
                                            // times pixels a ray; 0 where the arm's motion is not known
    int frames_held_ = 0;                   // updates since the tracked mode was last replaced
};

}  // namespace nearpose
