#include "apps/compare_command.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/compare/table_text.hpp"
#include "apps/compare/view_table.hpp"
#include "apps/console.hpp"
#include "apps/data_set/file_io.hpp"
#include "apps/experiment/results.hpp"
#include "apps/model_input.hpp"
#include "apps/simulate/parts.hpp"
#include "apps/simulate/recording.hpp"

namespace nearpose::program {
namespace {

struct CompareOptions {
    std::string part = "engine_block";
    ModelOptions model;
    std::filesystem::path out;
    compare::ViewTableOptions views;
    bool views_only = false;
};

simulate::EmbeddedPart part_of(const CompareOptions& options, bool part_given, const SharedOptions& shared) {
    if (options.model.model.empty()) {
        if (!options.model.unit.empty()) throw BadUse("--unit belongs to --model: a built-in part needs none");
        return simulate::embedded_part(options.part);
    }
    if (part_given) throw BadUse("--part and --model name two parts: leave one out");
    const Mesh mesh = load_model(options.model, shared);
    return {mesh, simulate::box_part(extent_of(mesh))};
}

experiment::Table compare_views(const CompareOptions& options, const simulate::EmbeddedPart& part, bool quiet) {
    const compare::ViewBench bench(part.mesh, part.part, simulate::default_camera());
    Progress progress("views", static_cast<int>(compare::rows_of(options.views).size()), quiet);
    return compare::view_table(bench, options.views, [&progress] {
        progress.step();
        return !interrupted();
    });
}

int compare_simulated(const CompareOptions& options, bool part_given, const SharedOptions& shared) {
    const simulate::EmbeddedPart part = part_of(options, part_given, shared);
    experiment::Results results;
    results.name = "compare";
    results.tables.push_back(compare_views(options, part, shared.quiet));
    if (interrupted()) return kInterrupted;
    print(compare::text_of(results.tables.back()));
    if (!options.out.empty()) {
        data_set::create_folder(options.out);
        experiment::write_results(options.out / "results.json", results);
    }
    return kSuccess;
}

void add_options(CLI::App& command, CompareOptions& options) {
    command.add_option("--part", options.part, "Built-in part")->check(CLI::IsMember(simulate::part_names()));
    add_model_file_options(command, options.model);
    command.get_option("--model")->description("Model file, instead of --part");
    command.add_option("--seeds", options.views.seeds, "Lines of sight and runs: seeds 1 to this")
        ->check(CLI::Range(1, 100000));
    command
        .add_option("--distances-mm", options.views.distances_mm, "Distances of the camera from the aimed point [mm]")
        ->delimiter(',')
        ->check(CLI::Range(20.0, 10000.0));
    command.add_option("--samples", options.views.samples, "Samples of the rasteriser; stored views as dense")
        ->delimiter(',')
        ->check(CLI::Range(1, 10'000'000));
    command.add_option("--rays", options.views.max_rays, "Rays or pixels of a view")->check(CLI::Range(1, 10'000'000));
    command.add_option("--threads", options.views.num_threads, "Threads; 0: all")->check(CLI::Range(0, 1024));
    command.add_option("--out", options.out, "Folder to write results.json into");
    command.add_flag("--views-only", options.views_only, "Views alone, not in the filter");
}

}  // namespace

void add_compare_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand("compare", "Ray casting, rasteriser and stored views, side by side");
    add_options(*command, *options);
    command->callback([options, command, &shared, &run] {
        const bool part_given = command->count("--part") > 0;
        run = [options, part_given, &shared] { return compare_simulated(*options, part_given, shared); };
    });
}

}  // namespace nearpose::program
