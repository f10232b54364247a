// SPDX-License-Identifier: Apache-2.0
// Rows of spans that need no arithmetic: whole texels copied, or one colour. The bytes are the engine's in profile default (its skips `copy`, `uniform`).
#pragma once
#include <stdint.h>

#include <spantex/draw.hpp>
#include "kernel.hpp"

namespace spantex::kernels {

struct shortcut {
  enum class way : uint8_t { none, copy, fill };
  way how = way::none;
  int32_t u = 0, v = 0;  // copy: pixel (x, y) is texel (x + u, y + v) of level 0, wrapped
};

// Of a surface by a filter that draws(), for all spans that `area` touches; what write-out does comes after. In linear light too, where a code that is decoded, weighted by 1 and encoded is itself.
shortcut shortcut_of(const surface& s, const planar_map& texels, rectangle area);

// Draws all spans of the row.
void draw_by(const shortcut& s, const row_work& work);

}  // namespace spantex::kernels
