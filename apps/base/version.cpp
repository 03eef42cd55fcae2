#include "apps/base/version.hpp"

namespace nearpose::program {

// The names in capitals come from CMake.
std::string version_number() {
    return NEARPOSE_VERSION;
}

std::string version_text() {
    return "nearpose " NEARPOSE_VERSION
           "\n"
           "revision " NEARPOSE_REVISION
           "\n"
           "compiler " NEARPOSE_COMPILER
           "\n"
           "build    " NEARPOSE_BUILD_TYPE
           "\n"
           "Embree   " NEARPOSE_EMBREE_VERSION
           "\n"
           "Ceres    " NEARPOSE_CERES_VERSION "\n";
}

}  // namespace nearpose::program
