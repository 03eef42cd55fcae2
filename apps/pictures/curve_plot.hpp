// Curves with bands as a picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/error_measures/curve.hpp"

namespace nearpose::pictures {

// Where values should lie.
struct Target {
    double low = 0.0, high = 0.0;  // no band where equal
    std::string label;
};

struct CurvePlot {
    std::string title;
    std::string x_title;  // with its unit
    std::string y_title;
    bool x_logarithmic = false;  // y is where its values span a lot
    std::vector<evaluation::Curve> curves;
    bool is_share_of_share = false;    // both axes run from 0 to 1, with the diagonal where they should agree
    bool y_is_share = false;           // y runs from 0 to 1
    Target target = {};                // of y, as a shaded band
    std::vector<double> nominal = {};  // of y, a level by curve, as thin lines in the curves' colours; may be empty
};

// Medians as lines, the middle half of the values (of shares: the 95 % interval) as bands, a legend. Plots lie below
// each other in one picture. Throws std::runtime_error naming the file, std::invalid_argument for no curve with a bin.
void write_curve_plots(const std::filesystem::path& path, const std::vector<CurvePlot>& plots);

}  // namespace nearpose::pictures
