#include "apps/program/program.hpp"

int main(int argc, char** argv) {
    return nearpose::program::run_program(argc, argv);
}
