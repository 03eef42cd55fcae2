// The command line of a run on a small scene.
#pragma once

#include <string>

#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {

inline std::string estimate(const TinyScene& scene, const std::string& more) {
    return "estimate " + scene.input() + "--out " + scene.file("poses.csv").string() + " " + more;
}

}  // namespace nearpose::program_tests
