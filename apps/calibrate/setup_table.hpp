// A set-up's errors in words and figures, for whoever has to change the set-up.
#pragma once

#include <string>

#include "apps/set_up/calibration.hpp"
#include "core/base/camera.hpp"

namespace nearpose::program {

// What a recording says of one quantity.
enum class SetupFinding {
    kAsGiven,       // the error is not told from zero
    kContradicted,  // it is
    kNotShown,      // the motion says hardly more than was known before
};

SetupFinding finding_of(double error, double sigma, double prior_sigma);

// A row for each unknown: the error, its standard deviation, the one before the recording, the finding.
std::string setup_table(const Calibration& calibration);

// What to change where: a line or more for each quantity that the recording contradicts. `given` are the intrinsics as
// they are now. One line where all is as given.
std::string advice_of(const Calibration& calibration, const PinholeCamera& given);

}  // namespace nearpose::program
