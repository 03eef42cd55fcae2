#include "core/search/search_options.hpp"

#include "core/base/check.hpp"

namespace nearpose {

void validate(const SearchOptions& options) {
    check_option("search.candidates", options.candidates, 0, 1e6);
    check_option("search.least_candidates", options.least_candidates, 1, 1e6);
    check_option("search.draws", options.draws, 0, 1e7);
    check_option("search.draws_factor_unsegmented", options.draws_factor_unsegmented, 1, 1e3);
    validate(options.step, "search.step");
}

}  // namespace nearpose
