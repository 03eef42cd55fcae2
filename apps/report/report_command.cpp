#include "apps/report/report_command.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/base/console.hpp"
#include "apps/base/file_io.hpp"
#include "apps/report/experiment_report.hpp"
#include "apps/report/page.hpp"
#include "apps/report/run_report.hpp"
#include "apps/runs/run_folder.hpp"

namespace nearpose::program {
namespace {

constexpr const char* kResultsFile = "results.json";

struct ReportOptions {
    std::filesystem::path folder, out;
    report::RunReportOptions run;
};

report::Report make_report(const ReportOptions& options, const SharedOptions& shared) {
    const auto notice = [&](const std::string& text) { print_notice(text, shared.quiet); };
    if (std::filesystem::exists(options.folder / kRunFile))
        return report::run_report(options.folder, options.run, notice);
    if (std::filesystem::exists(options.folder / kResultsFile)) {
        return report::experiment_report(options.folder / kResultsFile);
    }
    const std::string found = std::filesystem::is_directory(options.folder) ? "has neither " : "is no folder with ";
    throw std::runtime_error(options.folder.string() + ": " + found + kRunFile +
                             " (of nearpose estimate --run DIR) nor " + kResultsFile + " (of nearpose experiment)");
}

int report_folder(const ReportOptions& options, const SharedOptions& shared) {
    if (!report::viewer_available()) report::page("", "");  // throws and says what is missing, before the work
    const report::Report made = make_report(options, shared);
    const std::filesystem::path out = options.out.empty() ? options.folder / "report.html" : options.out;
    const std::string html = report::page(made.title, made.json);
    if (out == "-") {
        print(html);
        return kSuccess;
    }
    if (out.has_parent_path()) data_set::create_folder(out.parent_path());
    data_set::write_file_atomically(out, html);
    print_notice("wrote " + out.string() + " (" + std::to_string((html.size() + 50000) / 100000 / 10) + "." +
                     std::to_string((html.size() + 50000) / 100000 % 10) + " MB)",
                 shared.quiet);
    return kSuccess;
}

}  // namespace

void add_report_command(CLI::App& app, const SharedOptions& shared, Run& run) {
    auto options = std::make_shared<ReportOptions>();
    CLI::App* command =
        app.add_subcommand("report", "One HTML file about a run or an experiment, to look at and hand on");
    command->footer("The file needs no network and nothing beside it.");
    command->add_option("folder", options->folder, "Folder of nearpose estimate --run, or of nearpose experiment")
        ->required();
    command->add_option("--out", options->out, "File to write; - is the standard output [report.html in the folder]");
    command->add_option("--scene", options->run.scene, "Where the run's scene (or clouds) is now, if it has moved");
    command->add_option("--models", options->run.models, "Where its models (or model) are now, if they have moved");
    command->add_option("--max-points", options->run.max_points, "Points of a frame on the part")
        ->check(CLI::Range(10, 100000));
    command->add_option("--burn-in", options->run.burn_in, "Frames at the beginning that the statistics leave out")
        ->check(CLI::NonNegativeNumber);
    command->add_option("--threads", options->run.threads, "Threads; 0: all")->check(CLI::Range(0, 4096));
    command->callback(
        [options, &shared, &run] { run = [options, &shared] { return report_folder(*options, shared); }; });
}

}  // namespace nearpose::program
