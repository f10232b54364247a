// SPDX-License-Identifier: Apache-2.0
// A loader for tests: everything it was given lies in the half after so many polls, and nothing before; who reads earlier finds other texels.
#pragma once
#include <hal/loading_engine.hpp>

namespace spantex::sim {

struct late_loader {
  int delay = 3;                     // polls from start to the last texel; below zero: never
  status outcome = status::ok;       // of loads from now on
  int starts = 0, stops = 0, left = 0;
  rgba8* texels = nullptr;
  const texel_copy* copies = nullptr;
  int count = 0;
  status now = status::ok;

  void start(rgba8* half, const texel_copy* list, int n) {
    ++starts;
    texels = half;
    copies = list;
    count = n;
    left = delay;
    now = status::half_busy;
    for (int k = 0; k < n; ++k)
      for (int i = 0; i < list[k].count; ++i) half[list[k].to + i] = {uint8_t(~list[k].from[i].r), 1, 2, 3};
    if (delay == 0) finish();
  }
  status state() const { return now; }
  void poll() {
    if (now == status::half_busy && left > 0 && --left == 0) finish();
  }
  void stop() {
    ++stops;
    now = status::ok;
  }
  void finish() {
    for (int k = 0; k < count; ++k) copy_cursor(texels, copies + k, 1).copy(copies[k].count);
    now = outcome;
  }
};

}  // namespace spantex::sim
