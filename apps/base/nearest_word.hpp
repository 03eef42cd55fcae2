// What somebody may have meant.
#pragma once

#include <string>
#include <vector>

namespace nearpose::program {

// Of `known` (at least one) the word that the fewest inserted, deleted or changed letters make of `word`.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace nearpose::program
