// Global localisation: the particles at first, and after a loss.
#pragma once

#include "core/update/frame.hpp"
#include "core/update/situation.hpp"

namespace nearpose {

// Draws poses from what is seen; the best become the particles. `plan` says which share of a whole search is made.
SearchResult search(const Plan& plan, const Frame& frame, Ledger& ledger);

}  // namespace nearpose
