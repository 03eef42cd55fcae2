// The program and the list of its commands: with main.cpp the only place that knows them all.
#pragma once

namespace nearpose::program {

// The whole program: reads the command line, runs the command, reports errors, gives the exit code.
int run_program(int argc, const char* const* argv);

}  // namespace nearpose::program
