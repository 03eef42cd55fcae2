// Curves with bands as a picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/evaluation/curve.hpp"

namespace nearpose::pictures {

struct CurvePlot {
    std::string title;
    std::string x_title;  // with its unit
    std::string y_title;
    bool x_logarithmic = false;  // y is where its values span a lot
    std::vector<evaluation::Curve> curves;
    bool is_share_of_share = false;  // both axes run from 0 to 1, with the diagonal where they should agree
};

// Medians as lines, the middle half of the values as bands, a legend. Plots lie below each other in one picture. Throws
// std::runtime_error naming the file, std::invalid_argument for no curve with a bin.
void write_curve_plots(const std::filesystem::path& path, const std::vector<CurvePlot>& plots);

}  // namespace nearpose::pictures
