// From settings to what is simulated and what tracks it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "apps/error_measures/frame_errors.hpp"
#include "apps/error_measures/run_summary.hpp"
#include "apps/experiment/description.hpp"
#include "apps/runs/estimator_setup.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"
#include "apps/view_quality/view_cell.hpp"

namespace nearpose::experiment {

// Paths are relative to `folder`. All throw std::runtime_error or std::invalid_argument for what does not go together.
simulate::RecordingOptions recording_options(const Settings& settings, std::uint64_t seed,
                                             const std::filesystem::path& folder);
program::EstimatorSetup estimator_setup(const Settings& settings, std::uint64_t seed);
// Whether the tracker is started at the true pose before every frame.
bool starts_at_truth(const Settings& settings);
evaluation::SummaryOptions summary_options(const Settings& settings);
compare::ViewCell view_cell(const Settings& settings, std::uint64_t seed);

// Throws std::runtime_error naming file, table, row and cause, before hours are spent.
void check(const Description& description);

struct PartAssets {
    simulate::EmbeddedPart part;
    evaluation::ModelShape shape;
    Symmetries symmetries;  // found from the mesh; errors count up to the exact ones
};

// Parts and generators, made when they are first asked for and kept. May be used from several threads at once.
class Workshop {
  public:
    explicit Workshop(std::filesystem::path folder) : folder_(std::move(folder)) {}

    const std::filesystem::path& folder() const { return folder_; }
    // By the settings part, model and unit.
    const PartAssets& part(const Settings& settings);
    // And by views, view_samples and cad; what is drawn of the last is of the seed, and not kept.
    std::shared_ptr<const ViewGenerator> views(const Settings& settings, std::uint64_t seed);
    const compare::ViewBench& view_bench(const Settings& settings);

  private:
    const PartAssets& part_unlocked(const Settings& settings);

    std::filesystem::path folder_;
    std::mutex mutex_;
    std::map<std::string, std::unique_ptr<PartAssets>> parts_;
    std::map<std::string, std::shared_ptr<const ViewGenerator>> views_;
    std::map<std::string, std::unique_ptr<compare::ViewBench>> benches_;
};

}  // namespace nearpose::experiment
