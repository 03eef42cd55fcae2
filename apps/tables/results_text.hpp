// Results for people and for other programs.
#pragma once

#include <string>
#include <vector>

#include "apps/tables/results.hpp"

namespace nearpose::tables {

// Tables with "value [low, high]". `pictures` are the file names of the curves, in the order of tables and sets; empty
// where a set has no picture.
std::string markdown_of(const Results& results, const std::vector<std::string>& pictures);

// A line an entry: table,row,runs,column,unit,value,low,high; what is not known is left empty.
std::string csv_of(const Results& results);

}  // namespace nearpose::tables
