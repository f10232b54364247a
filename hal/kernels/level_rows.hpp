// SPDX-License-Identifier: Apache-2.0
// A level in rows, by texels that may lie anywhere: mirrored axes are stored to their period.
#pragma once
#include <stdint.h>

#include <spantex/texture.hpp>
#include "planar_map.hpp"

namespace spantex::kernels {

struct level_rows {
  const rgba8* origin;  // texel (0, 0)
  int32_t stride, columns, rows, apron;  // columns and rows: to a period or, clamped, to the level's end
  wrap wrap_u, wrap_v;

  explicit level_rows(const planar_map& map, int level = 0)
      : origin(map.levels_in_rows().row(level, 0)), stride(map.levels_in_rows().stride(level)), columns(map.levels_in_rows().columns(level)), rows(map.levels_in_rows().rows(level)),
        apron(map.levels_in_rows().apron()), wrap_u(stored(map.wrap_u())), wrap_v(stored(map.wrap_v())) {}

  // A row, its apron first, and where in it `count` texels from u on lie side by side: at most one more than the apron has.
  const rgba8* row(int32_t v) const { return origin + int64_t(wrapped(wrap_v, v, rows)) * stride - apron; }
  int32_t column(int32_t u, int32_t count) const { return apron + (wrap_u == wrap::clamp ? clamp_to(u, 1 - count, columns - 1) : wrapped(wrap_u, u, columns)); }

 private:
  static wrap stored(wrap mode) { return mode == wrap::mirror ? wrap::repeat : mode; }
};

}  // namespace spantex::kernels
