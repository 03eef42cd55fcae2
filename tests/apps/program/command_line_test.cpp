// How the program answers before it does anything.
#include <gtest/gtest.h>

#include "tests/apps/support/contains.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

// One line on the error stream.
void expect_one_error(const Outcome& outcome, int exit_code, const std::string& part) {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_EQ(lines_of(outcome.err).size(), 1U) << outcome.err;
    EXPECT_EQ(outcome.err.rfind("nearpose: error: ", 0), 0U) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, part)) << outcome.err;
}

TEST(CommandLine, HelpListsTheCommands) {
    for (const char* call : {"help", "--help", "-h"}) {
        const Outcome outcome = run_nearpose(call);
        EXPECT_EQ(outcome.exit_code, 0);
        EXPECT_TRUE(outcome.err.empty());
        for (const char* command : {"estimate", "simulate", "render", "evaluate", "import"}) {
            EXPECT_TRUE(contains(outcome.out, command)) << call << " " << command;
        }
    }
}

TEST(CommandLine, BareCallListsTheCommandsAndIsBadUse) {
    const Outcome outcome = run_nearpose("");
    EXPECT_TRUE(contains(outcome.out, "estimate"));
    expect_one_error(outcome, 2, "no command");
}

TEST(CommandLine, HelpOfEstimateListsEveryOptionAndDefaults) {
    const Outcome outcome = run_nearpose("estimate --help");
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.out, run_nearpose("help estimate").out);
    for (const char* option : {"--scene ",
                               "--clouds",
                               "--camera",
                               "--models",
                               "--object",
                               "--model ",
                               "--unit",
                               "--out",
                               "--views",
                               "--method",
                               "--particles",
                               "--threads",
                               "--seed",
                               "--no-mask",
                               "--mask-index",
                               "--no-control",
                               "--initial-pose",
                               "--first",
                               "--initial-sigma-mm",
                               "--initial-sigma-deg",
                               "--last",
                               "--log",
                               "--trajectory ",
                               "--trajectory-frame",
                               "--scene-id",
                               "--fps",
                               "--pictures",
                               "--quiet",
                               "--config",
                               "--print-config"}) {
        EXPECT_TRUE(contains(outcome.out, option)) << option;
    }
    for (const char* shown : {"200", "raycast", "default", "30"}) EXPECT_TRUE(contains(outcome.out, shown)) << shown;
}

TEST(CommandLine, VersionTellsBuildAndLibraries) {
    const Outcome outcome = run_nearpose("--version");
    EXPECT_EQ(outcome.exit_code, 0);
    for (const char* part : {"nearpose 0.", "revision ", "compiler ", "Embree   ", "Ceres    2."}) {
        EXPECT_TRUE(contains(outcome.out, part)) << part;
    }
}

TEST(CommandLine, UnknownWordsSuggestTheNearest) {
    expect_one_error(run_nearpose("estimat --scene x"), 2, "did you mean 'estimate'");
    expect_one_error(run_nearpose("--config nowhere.ini rendr"), 2, "did you mean 'render'");
    expect_one_error(run_nearpose("estimate --out x --particels 5"), 2, "did you mean --particles?");
}

TEST(CommandLine, BadValuesAreBadUse) {
    expect_one_error(run_nearpose("estimate"), 2, "--out");
    expect_one_error(run_nearpose("estimate --out x"), 2, "--scene");
    expect_one_error(run_nearpose("estimate --out x --scene a"), 2, "a model is needed");
    expect_one_error(run_nearpose("estimate --out x --scene a --clouds b"), 2, "exclude");
    expect_one_error(run_nearpose("estimate --out x --particles 0"), 2, "--particles");
    expect_one_error(run_nearpose("estimate --out x --particles ten"), 2, "--particles");
    expect_one_error(run_nearpose("estimate --out x --views laser"), 2, "--views");
    expect_one_error(run_nearpose("estimate --out x --log x --scene a --model b"), 2, "--log");
    expect_one_error(run_nearpose("estimate --out x --seed 1 --seed 2"), 2, "--seed");
    expect_one_error(run_nearpose("import --out x"), 2, "--realsense-raw");
}

TEST(CommandLine, ConfigurationIsReadBeforeAndAfterTheCommand) {
    const TinyScene scene;
    write_text(scene.file("good.ini"), "[estimate]\nparticles = 17\n");
    const std::string config = "--config " + scene.file("good.ini").string();
    for (const std::string& call : {config + " estimate --print-config", "estimate --print-config " + config}) {
        const Outcome outcome = run_nearpose(call);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
        EXPECT_TRUE(contains(outcome.out, "estimate.particles=17")) << outcome.out;
    }
    EXPECT_TRUE(
        contains(run_nearpose(config + " estimate --particles 18 --print-config").out, "estimate.particles=18"));
    write_text(scene.file("mistyped.ini"), "[estimate]\nparticels = 17\n");
    expect_one_error(run_nearpose("estimate --out x --config " + scene.file("mistyped.ini").string()), 2, "particels");
    expect_one_error(run_nearpose("estimate --out x --config nowhere.ini"), 2, "nowhere.ini");
}

TEST(CommandLine, APipeAsConfigurationIsRefusedAndDoesNotHang) {
    const TinyScene scene(1);
    const std::string pipe = scene.file("pipe.ini").string();
    const Outcome outcome =
        run_shell("mkfifo " + pipe + "; timeout -k 1 20 \"$NEARPOSE\" estimate --out x --config " + pipe);
    expect_one_error(outcome, 2, "pipe.ini: is not a regular file");
}

TEST(CommandLine, HelpHasItsFooterOnce) {
    const std::string help = run_nearpose("help estimate").out;
    EXPECT_EQ(help.find("Exit codes"), help.rfind("Exit codes"));
}

TEST(CommandLine, PrintedConfigurationReadsBackAsItself) {
    const TinyScene scene;
    const Outcome printed = run_nearpose("estimate " + scene.input() + "--out a.csv --seed 5 --no-mask --print-config");
    ASSERT_EQ(printed.exit_code, 0) << printed.err;
    write_text(scene.file("printed.ini"), printed.out);
    const Outcome again = run_nearpose("estimate --print-config --config " + scene.file("printed.ini").string());
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(again.out, printed.out);
}

}  // namespace
}  // namespace nearpose::program_tests
