// What every command of the program shares: how it registers itself, how it ends.
//
// A command is a folder of its own, named like it, and in it one pair of files NAME_command with one function,
//     void add_NAME_command(CLI::App& app, const SharedOptions& shared, Run& run);
// which adds its subcommand and options to `app` and, in the subcommand's callback, sets `run` to what is to be done.
// `run` is called once the whole command line has been read and found good:
//
//     void add_render_command(CLI::App& app, const SharedOptions& shared, Run& run) {
//         auto options = std::make_shared<RenderOptions>();
//         CLI::App* command = app.add_subcommand("render", "Depth image of a model at a pose");
//         command->add_option("--out", options->out, "Depth image to write (16-bit PNG)")->required();
//         command->callback([options, &shared, &run] { run = [options, &shared] { return render(*options, shared); };
//         });
//     }
//
// Options show their defaults by themselves and share no names with SharedOptions. Errors are thrown: BadUse for a
// combination of options that makes no sense, any other std::exception for a failure; neither is printed by a command.
#pragma once

#include <functional>
#include <stdexcept>

namespace CLI {
class App;
}

namespace nearpose::program {

inline constexpr int kSuccess = 0;
inline constexpr int kFailure = 1;
inline constexpr int kBadUse = 2;
inline constexpr int kFramesUnread = 3;  // finished, but some frames could not be read
inline constexpr int kInterrupted = 130;

struct SharedOptions {
    bool quiet = false;  // no progress bar, no notices; errors are still told
};

using Run = std::function<int()>;  // returns the exit code

// The options do not fit together: one line that says what to do. Exit code 2.
class BadUse : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace nearpose::program
