// nearpose and the plain fit on the same recording, frame by frame: their errors side by side.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/data_set/bop_models.hpp"
#include "apps/scenes/recording.hpp"
#include "core/options.hpp"
#include "core/view_generator.hpp"
#include "tests/bench/naive/point_to_plane.hpp"

namespace nearpose::bench {

struct PeerCase {
    std::string scenario, part, sensor;
    double min_range_m = 0.0;  // of a sensor that matches images; 0: its own
    int frames = 16;
    std::uint64_t seed = 1;
    double far_m = 0.0, near_m = 0.0;  // first and last distance of an approach; 0: the scenario's own
};

// A recording with its part, in memory.
struct PeerScene {
    explicit PeerScene(const PeerCase& of);

    PinholeCamera camera;
    data_set::ModelInfo info;  // with the part's exact symmetries
    Symmetries symmetries;
    std::shared_ptr<const ViewGenerator> views;
    std::unique_ptr<naive::SingleRayViews> single_rays;
    std::vector<simulate::SimulatedFrame> frames;
};

struct FitErrors {
    int frames = 0;                                   // with a pose
    double translation_mm = 0.0, rotation_deg = 0.0;  // means
    double depth_mm = 0.0;                            // mean of estimate - truth along the optical axis
    double explained = 0.0;                           // mean of naive::explained_share within kExplained_m
};
inline constexpr double kExplained_m = 0.001;

// What an estimator may be changed in before it runs.
using Change = std::function<void(Method&, SensorModel&)>;
inline void unchanged(Method&, SensorModel&) {}

// From nothing through the whole recording. Means are over the frames from `first` on.
FitErrors tracked(const PeerScene& scene, bool with_mask, int first, const Change& change = unchanged);
// From the same start in each frame: a pose drawn about the truth, half a degree and a millimetre off (one sigma). At
// the truth itself a fit that hardly moves would look exact.
FitErrors started_near(const PeerScene& scene, bool with_mask, int first, const Change& change = unchanged);
FitErrors plainly_fitted(const PeerScene& scene, bool with_mask, int first, const naive::PlaneFitOptions& options = {});
// The truth itself explains no more than the sensor's errors let it.
double explained_by_truth(const PeerScene& scene, int first);

}  // namespace nearpose::bench
