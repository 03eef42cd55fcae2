#include "apps/compare/compare_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "apps/base/console.hpp"
#include "apps/base/file_io.hpp"
#include "apps/compare/filter_table.hpp"
#include "apps/compare/view_table.hpp"
#include "apps/data_set/bop_models.hpp"
#include "apps/part_model/model_input.hpp"
#include "apps/pictures/curve_plot.hpp"
#include "apps/runs/estimator_setup.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"
#include "apps/tables/results.hpp"
#include "apps/tables/table_text.hpp"

namespace nearpose::program {
namespace {

struct CompareOptions {
    std::string part = "engine_block";
    ModelOptions model;
    std::filesystem::path scene, out;
    compare::ViewTableOptions views;
    bool views_only = false;

    // In the filter.
    std::vector<std::string> methods = {"paper", "default"};
    int particles = 200;
    int frames = 60;
    int filter_samples = 20000;
};

void check(const CompareOptions& options, bool part_given) {
    if (options.scene.empty()) {
        if (!options.model.models.empty()) throw BadUse("--models belongs to --scene; a single file is --model");
        if (options.model.model.empty() && !options.model.unit.empty())
            throw BadUse("--unit belongs to --model: a built-in part needs none");
        if (part_given && !options.model.model.empty())
            throw BadUse("--part and --model name two parts: leave one out");
        return;
    }
    if (options.model.models.empty() || !options.model.model.empty() || part_given)
        throw BadUse("--scene takes its part from --models DIR --object N");
    if (options.views_only) throw BadUse("--views-only needs no --scene: leave one out");
}

simulate::EmbeddedPart part_of(const CompareOptions& options, const SharedOptions& shared) {
    if (options.scene.empty() && options.model.model.empty()) return simulate::embedded_part(options.part);
    const Mesh mesh = load_model(options.model, shared);
    return {mesh, simulate::box_part(extent_of(mesh))};
}

tables::Table compare_views(const CompareOptions& options, const compare::ViewBench& bench, bool quiet) {
    Progress progress("views", static_cast<int>(compare::rows_of(options.views).size()), quiet);
    return compare::view_table(bench, options.views, [&progress] {
        progress.step();
        return !interrupted();
    });
}

std::vector<compare::ComparedFilter> filters_of(const CompareOptions& options, const compare::ViewBench& bench) {
    std::vector<compare::ComparedFilter> filters;
    for (const std::string& method : options.methods) {
        for (const std::string& views : options.views.views) {
            compare::ViewCell cell;
            cell.views = views;
            cell.view_samples = options.filter_samples;
            filters.push_back({views, method, options.particles, bench.generator(cell)});
        }
    }
    return filters;
}

struct Reach {
    double near_m, far_m;
};

Reach reach_of(const CompareOptions& options) {
    const auto [least, most] =
        std::minmax_element(options.views.distances_mm.begin(), options.views.distances_mm.end());
    return {1e-3 * *least, 1e-3 * *most};
}

// Empty where the user stopped it.
std::vector<tables::Table> compare_in_filter(const CompareOptions& options, const simulate::EmbeddedPart& part,
                                             const compare::ViewBench& bench, bool quiet) {
    const std::vector<compare::ComparedFilter> filters = filters_of(options, bench);
    compare::FilterTableOptions table;
    table.distances_mm = options.views.distances_mm;
    table.seeds = options.views.seeds;
    table.num_threads = options.views.num_threads;

    const Reach reach = reach_of(options);
    std::function<compare::FilterRecording(std::uint64_t)> recording_of = [&](std::uint64_t seed) {
        const std::string name = options.model.model.empty() ? options.part : "";
        return compare::sweep_recording(part, name, reach.far_m, reach.near_m, options.frames, seed);
    };
    if (options.scene.empty()) {
        table.distance_name = "distance of the camera from the aimed point";
        table.distance_of = [&](const evaluation::FrameErrors& frame) -> std::optional<double> {
            return reach.far_m + (reach.near_m - reach.far_m) * frame.frame_id / (options.frames - 1);
        };
    } else {
        // Read once: what differs between the runs is the filter's own seed.
        const auto scene = compare::scene_recording(options.scene, options.model.models, options.model.object);
        recording_of = [scene](std::uint64_t) { return scene; };
    }
    Progress progress("filter", options.views.seeds, quiet);
    const compare::FilterResults results = compare::filter_results(
        filters, recording_of, table, [] { return !interrupted(); }, [&progress] { progress.step(); });
    if (results.empty()) return {};
    return compare::filter_tables(filters, results, table);
}

void write_plots(const std::filesystem::path& folder, const tables::Table& table) {
    std::vector<pictures::CurvePlot> plots;
    for (const tables::CurveSet& set : table.curve_sets) {
        const bool shows =
            std::any_of(set.curves.begin(), set.curves.end(), [](const auto& c) { return !c.bins.empty(); });
        if (shows) plots.push_back({set.title, set.x_title, set.y_title, set.x_logarithmic, set.curves});
    }
    if (!plots.empty()) pictures::write_curve_plots(folder / (table.name + ".png"), plots);
}

void write_all(const std::filesystem::path& folder, const tables::Results& results) {
    data_set::create_folder(folder);
    tables::write_results(folder / "results.json", results);
    for (const tables::Table& table : results.tables) write_plots(folder, table);
}

int run_compare(const CompareOptions& options, bool part_given, const SharedOptions& shared) {
    check(options, part_given);
    const simulate::EmbeddedPart part = part_of(options, shared);
    const compare::ViewBench bench(part.mesh, part.part, simulate::default_camera());
    tables::Results results;
    results.name = "compare";
    results.command = "nearpose compare";
    if (options.scene.empty()) {
        results.tables.push_back(compare_views(options, bench, shared.quiet));
        if (interrupted()) return kInterrupted;
        print(tables::text_of(results.tables.back()));
    }
    if (!options.views_only) {
        const auto tables = compare_in_filter(options, part, bench, shared.quiet);
        if (tables.empty()) return kInterrupted;
        for (const tables::Table& table : tables) {
            print((results.tables.empty() ? "" : "\n") + tables::text_of(table));
            results.tables.push_back(table);
        }
    }
    if (!options.out.empty()) write_all(options.out, results);
    return kSuccess;
}

void add_filter_options(CLI::App& command, CompareOptions& options) {
    command.add_flag("--views-only", options.views_only, "Views alone, not in the filter");
    command.add_option("--scene", options.scene,
                       "BOP scene with true poses: in the filter on these frames, not a sweep");
    add_bop_model_options(command, options.model);
    command.add_option("--methods", options.methods, "Methods of the filter")
        ->delimiter(',')
        ->check(CLI::IsMember(method_names()));
    command.add_option("--particles", options.particles, "Number of particles")->check(CLI::Range(1, 1'000'000));
    command.add_option("--frames", options.frames, "Frames of a sweep, from the farthest distance to the nearest")
        ->check(CLI::Range(2, 100'000));
    command.add_option("--filter-samples", options.filter_samples, "Samples in the filter; stored views as dense")
        ->check(CLI::Range(1, 10'000'000));
}

void add_options(CLI::App& command, CompareOptions& options) {
    command.add_option("--part", options.part, "Built-in part")->check(CLI::IsMember(simulate::part_names()));
    add_model_file_options(command, options.model);
    command.get_option("--model")->description("Model file, instead of --part");
    command.add_option("--views", options.views.views, "View generators; spheres: stored views of several radii")
        ->delimiter(',')
        ->check(CLI::IsMember(program::view_names()));
    command.add_option("--seeds", options.views.seeds, "Lines of sight and runs: seeds 1 to this")
        ->check(CLI::Range(1, 100'000));
    command
        .add_option("--distances-mm", options.views.distances_mm, "Distances of the camera from the aimed point [mm]")
        ->delimiter(',')
        ->check(CLI::Range(20.0, 10000.0));
    command.add_option("--samples", options.views.samples, "Samples of the rasteriser; stored views as dense")
        ->delimiter(',')
        ->check(CLI::Range(1, 10'000'000));
    command.add_option("--rays", options.views.max_rays, "Rays or pixels of a view, alone")
        ->check(CLI::Range(1, 10'000'000));
    command.add_option("--threads", options.views.num_threads, "Threads; 0: all")->check(CLI::Range(0, 1024));
    command.add_option("--out", options.out, "Folder for results.json and plots");
}

}  // namespace

void add_compare_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand("compare", "Ray casting, rasteriser and stored views, side by side");
    add_options(*command, *options);
    add_filter_options(*command, *options);
    command->footer(
        "For grids of hours, which go on where they ended and spread over machines, describe the same for\n"
        "nearpose experiment: its tables of the kind views, and the setting views of its runs.");
    command->callback([options, command, &shared, &run] {
        const bool part_given = command->count("--part") > 0;
        run = [options, part_given, &shared] { return run_compare(*options, part_given, shared); };
    });
}

}  // namespace nearpose::program
