// Before the image is looked at: resampling where the weights have become uneven, then control and diffusion, as in the
// paper's algorithm.
#pragma once

#include "core/update/belief.hpp"
#include "core/update/frame.hpp"

namespace nearpose {

// The belief of the update before, carried to this frame.
Belief predict(const Belief& before, const Frame& frame, Ledger& ledger);

// As many particles as describe the posterior (KLD sampling, Fox 2003). Its cells are the modes of those particles that
// are not far less likely than the best. All particles until the track is confirmed.
int particles_wanted(const Belief& belief, const Frame& frame);

}  // namespace nearpose
