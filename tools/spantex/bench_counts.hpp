// SPDX-License-Identifier: Apache-2.0
// Work on fixed scenes in counts that are the same on every machine, for committed baselines. No clock.
#pragma once

namespace spantex::tool {

// A line a row on stdout: its name, then the counts that the heading names, of one picture. With `draws_only` each row is drawn once by the direct
// scalar engine, the n-th in spantex::tool::draw_counted_row<n>, which a profiler can watch, and only names are printed.
void print_counts(bool draws_only);

}  // namespace spantex::tool
