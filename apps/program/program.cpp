#include "apps/program/program.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "apps/base/command.hpp"
#include "apps/base/console.hpp"
#include "apps/base/file_io.hpp"
#include "apps/base/nearest_word.hpp"
#include "apps/base/version.hpp"
#include "apps/calibrate/calibrate_command.hpp"
#include "apps/compare/compare_command.hpp"
#include "apps/estimate/estimate_command.hpp"
#include "apps/evaluate/evaluate_command.hpp"
#include "apps/experiment/experiment_command.hpp"
#include "apps/fit_sensor/fit_sensor_command.hpp"
#include "apps/import/import_command.hpp"
#include "apps/render/render_command.hpp"
#include "apps/report/report_command.hpp"
#include "apps/simulate/simulate_command.hpp"

namespace nearpose::program {
namespace {

constexpr const char* kFooter =
    "Every command also takes --config FILE (its options as key = value under [COMMAND]), --print-config and --quiet.\n"
    "Exit codes: 0 done, 1 failed, 2 bad use, 3 done but some frames could not be read, 130 interrupted.";

std::vector<std::string> command_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
    }
    return names;
}

// The first word that is neither an option nor the value of --config: where the command must stand.
std::string command_word(const std::vector<std::string>& words) {
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == "--config") {
            ++i;
        } else if (!words[i].empty() && words[i][0] != '-') {
            return words[i];
        }
    }
    return {};
}

const CLI::App* chosen_command(const CLI::App& app) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    return chosen.empty() ? nullptr : chosen.front();
}

std::string word_of_command(const CLI::App& app) {
    const CLI::App* command = chosen_command(app);
    return command == nullptr ? "" : command->get_name();
}

int bad_use(const std::string& problem, const CLI::App* command) {
    const std::string help = command == nullptr ? "nearpose --help" : "nearpose " + command->get_name() + " --help";
    print_error(problem + "; see `" + help + "`");
    return kBadUse;
}

// Empty where the file may be read. Reading a pipe would wait for ever.
std::string config_problem(const std::string& file) {
    constexpr std::uintmax_t kMaxConfigBytes = std::uintmax_t{1} << 20;
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return {};  // said by the reader
    if (!std::filesystem::is_regular_file(file, error)) return file + ": is not a regular file";
    if (std::filesystem::file_size(file, error) > kMaxConfigBytes || error) {
        return file + ": is too large for a file of options";
    }
    return {};
}

// What is known of an option that nobody knows.
std::string suggestion(const std::vector<std::string>& extras, const CLI::App* command) {
    if (extras.empty() || command == nullptr || extras.front().rfind("--", 0) != 0) return {};
    const std::string word = extras.front().substr(0, extras.front().find('='));
    std::vector<std::string> known = {"--config", "--print-config", "--quiet"};
    for (const CLI::Option* option : command->get_options()) known.push_back(option->get_name());
    return "; did you mean " + nearest_word(word, known) + "?";
}

// Keys and values of the chosen command as --config reads them. What is not set is left out: an empty text is no
// number.
void print_config(const CLI::App& app, const CLI::App* command) {
    if (command == nullptr) throw BadUse("--print-config needs a command");
    std::istringstream config(app.get_config_formatter()->to_config(command, true, false, command->get_name() + "."));
    for (std::string line; std::getline(config, line);) {
        if (!line.ends_with("=\"\"")) print(line + "\n");
    }
}

// `nearpose help` and `nearpose help COMMAND`.
int print_help(const CLI::App& app, const std::vector<std::string>& words) {
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (words.size() > 1 && command->get_name() == words[1]) {
            print(command->help("nearpose"));
            return kSuccess;
        }
    }
    print(app.help());
    return kSuccess;
}

struct Shell {
    CLI::App app{"nearpose: the 6-DoF pose of a known part from a depth camera that comes close.", "nearpose"};
    SharedOptions shared;
    bool wants_version = false;
    bool wants_config = false;
    Run run;

    Shell() {
        app.option_defaults()->always_capture_default();
        app.fallthrough();
        app.allow_config_extras(CLI::config_extras_mode::error);
        app.set_config("--config", "", "File with options: those of estimate under [estimate], and so on (INI, TOML)")
            ->check(config_problem, "", "config");
        app.add_flag("--print-config", wants_config, "Print the command's options as a file for --config, and end")
            ->configurable(false);
        app.add_flag("--quiet", shared.quiet, "No progress bar and no notices");
        app.add_flag("--version", wants_version, "Print versions and end")->configurable(false);
        add_estimate_command(app, shared, run);
        add_simulate_command(app, shared, run);
        add_render_command(app, shared, run);
        add_evaluate_command(app, shared, run);
        add_calibrate_command(app, shared, run);
        add_compare_command(app, shared, run);
        add_import_command(app, shared, run);
        add_report_command(app, shared, run);
        add_experiment_command(app, shared, run);
        add_fit_sensor_command(app, shared, run);
        app.require_subcommand(0, 1);
        for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
            command->fallthrough();
            command->footer(command->get_footer() + (command->get_footer().empty() ? "" : "\n\n") + kFooter);
        }
        app.footer(kFooter);  // last: commands inherit it where it is there before them
    }
};

// Reads the command line into `shell`; a value where that already ends the program.
int parse(Shell& shell, int argc, const char* const* argv) {
    constexpr int kGoOn = -1;
    try {
        shell.app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        const CLI::App* command = chosen_command(shell.app);
        print(command == nullptr ? shell.app.help() : command->help("nearpose"));
        return kSuccess;
    } catch (const CLI::RequiredError& error) {
        // A template of a configuration is wanted just where not everything is known yet.
        if (!shell.wants_config) return bad_use(error.what(), chosen_command(shell.app));
    } catch (const CLI::ExtrasError& error) {
        const CLI::App* command = chosen_command(shell.app);
        return bad_use(error.what() + suggestion(shell.app.remaining(true), command), command);
    } catch (const CLI::ParseError& error) {
        return bad_use(error.what(), chosen_command(shell.app));
    }
    if (shell.wants_version) {
        print(version_text());
        return kSuccess;
    }
    if (shell.wants_config) {
        print_config(shell.app, chosen_command(shell.app));
        return kSuccess;
    }
    return kGoOn;
}

int run_shell(Shell& shell, int argc, const char* const* argv) {
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    const std::string word = command_word(words);
    const std::vector<std::string> names = command_names(shell.app);
    if (words.empty()) {
        print(shell.app.help());
        return bad_use("no command given", nullptr);
    }
    if (word == "help") return print_help(shell.app, words);
    if (!word.empty() && std::find(names.begin(), names.end(), word) == names.end()) {
        return bad_use("unknown command '" + word + "'; did you mean '" + nearest_word(word, names) + "'?", nullptr);
    }
    const int ended = parse(shell, argc, argv);
    if (ended >= 0) return ended;
    if (!shell.run) return bad_use("no command given", nullptr);
    // These look at interrupted() between frames; the others just end at the first Ctrl-C.
    const std::string chosen = word_of_command(shell.app);
    const bool asks = chosen == "estimate" || chosen == "simulate" || chosen == "compare" || chosen == "experiment";
    if (asks) catch_interrupts();
    try {
        return shell.run();
    } catch (const BadUse& error) {
        return bad_use(error.what(), chosen_command(shell.app));
    }
}

}  // namespace

int run_program(int argc, const char* const* argv) {
    let_writes_fail();
    try {
        Shell shell;
        return run_shell(shell, argc, argv);
    } catch (const data_set::ClosedPipe&) {
        return kSuccess;  // whoever read our output has seen enough
    } catch (const BadUse& error) {
        return bad_use(error.what(), nullptr);
    } catch (const std::bad_alloc&) {
        print_error("out of memory: end other programs, or try --threads 1 or a model of fewer triangles");
    } catch (const std::exception& error) {
        print_error(error.what());
    }
    return kFailure;
}

}  // namespace nearpose::program
