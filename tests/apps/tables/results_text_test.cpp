#include "apps/tables/results_text.hpp"

#include <gtest/gtest.h>

namespace nearpose::tables {
namespace {

// A bin's line stands where its x does, also where only some curves have it.
TEST(ResultsText, TellsTheNumbersOfCurves) {
    CurveSet set{"Error", "distance [mm]", "error [mm]", false, {}};
    set.curves.push_back({"cast", {{125.0, 8, 0.25, 0.2, 0.3, 0.5}, {175.0, 9, 0.125, 0.1, 0.2, 0.375}}});
    set.curves.push_back({"a|b", {{175.0, 4, 2.0, 1.0, 3.0, 4.0}}});
    Results results{"Name", "command", {}};
    results.tables.push_back({"t", "Title", "Text.", {{"error", "mm", 1}}, {{"row", 3, {{1.25, {}, 2.0}}}}, {set}});
    EXPECT_EQ(markdown_of(results, {"t-1.png"}),
              "# Name\n\n"
              "Made by `command`. In brackets: the 95 % confidence interval over runs.\n\n"
              "## Title\n\nText.\n\n"
              "| | runs | error [mm] |\n|---|---:|---:|\n| row | 3 | 1.2 [-, 2.0] |\n\n"
              "![Error](t-1.png)\n\n"
              "The error [mm], median (95 %) of the frames:\n\n"
              "| distance [mm] | cast | a\\|b |\n|---:|---:|---:|\n"
              "| 125 | 0.25 (0.50) | - |\n| 175 | 0.12 (0.38) | 2.00 (4.00) |\n\n");
    results.tables[0].curve_sets[0].curves.clear();
    EXPECT_EQ(markdown_of(results, {""}).find("median"), std::string::npos);
}

}  // namespace
}  // namespace nearpose::tables
