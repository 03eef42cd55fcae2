// The columns that a table may have: how the figures of a row's runs become one entry.
//
// A figure is one number of one run; `translation_mean` is the mean error of its frames after the burn-in, of those
// with a pose. A column of that name is its mean over all runs that have it, with an interval over runs (never over
// frames, which depend on each other). Endings choose otherwise:
//   _held       the mean over the runs that are within 10 mm and 5 degrees in every frame after the burn-in
//   _converged  over the runs whose median errors after the burn-in are within 10 mm and 5 degrees
//   _median     translation_median: the median over runs of translation_mean, with the interval of its ranks
// The errors along and about single axes count without their sign; depth_mean alone keeps it: where it is positive, the
// estimate lies behind the truth.
//
// Shares of runs have Wilson's interval. Frames until something are medians in which a run that never gets there
// counts as later than all others; where that is half of the runs, there is no value.
//
// Frames that do not show the part (look_away, nonsense_frames, scene) count for no error and no arrival. `held`,
// `stays`, `frames_to_hold` and `lost` also leave out the first 3 frames that show it again and the first 3 in which it
// lies elsewhere (object_moves): in them it may be found again. A run that never shows the part has none of all these.
//
// Verdicts are counted over all frames of a run, those of the burn-in and those without the part too:
//   accepted, lost_verdicts   the shares of frames with that verdict
//   accepted_of_right         of the frames whose pose is within half the tolerance, the share that is accepted; runs
//                             without such frames are left out
//   false_accepts             of frames accepted with a wrong pose: beyond tolerance_mm or tolerance_deg at the centre
//                             of the box, or any pose in a frame that does not show the part
//   false_accepts_of_accepts  the share of a run's accepts that are false; its mean leaves out runs without accepts
//   accepted_wrong            the number of frames that are false accepts
//   first_accept              frames up to and with the first accept that is right
//   frames_to_recover         frames after the last one with a fault, up to and with the first accept that is right; of
//                             runs whose fault ends before they do
//   frames_to_refind          frames from the one that shows the part again, or where it lies elsewhere, up to and with
//                             the first within 10 mm and 5 degrees
//   first_within_3            the share of runs within 10 mm and 5 degrees in one of the first three frames
#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/error_measures/run_summary.hpp"
#include "apps/experiment/setting.hpp"
#include "apps/tables/results.hpp"

namespace nearpose::experiment {

using Figures = std::map<std::string, double>;  // what is not known is left out

Figures figures_of(const evaluation::RunSummary& summary, const evaluation::SummaryOptions& options);

std::vector<std::string> column_names(TableKind kind);
// Both throw std::out_of_range for a name that is not among these.
tables::Column heading_of(TableKind kind, const std::string& name);
tables::Entry entry_of(TableKind kind, const std::string& name, const std::vector<Figures>& runs);

// Confidence interval of the median, from ranks of the values, which may hold infinity; without bounds where there are
// too few (5).
tables::Entry median_of(std::vector<double> values);

}  // namespace nearpose::experiment
