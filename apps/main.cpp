#include "apps/command_line.hpp"

int main(int argc, char** argv) {
    return nearpose::program::run_program(argc, argv);
}
