// SPDX-License-Identifier: Apache-2.0
// spantex: fixed-point, integer-only, no-heap texture mapping in spans of 8x8 pixels.
//
//   plane / polygon set-up  ->  spans with 64-bit masks  ->  planner  ->  [ HAL: span engine ]  ->  pixels
//
// Conventions
//   screen      pixel (i, j) has its centre at (i + 1/2, j + 1/2); origin top left, y down; at most 4096 x 4096
//   texture     u, v in texels of level 0; texel (k, l) has its centre at (k + 1/2, l + 1/2); sides 1..4096; |u|, |v| < 2^15
//   levels      level L has side max(1, floor(side / 2^L)); level 0 is the full map
//   divisor     a point with W <= 0 is behind the viewer and is not drawn
//   formats     s15.16: sign, 15 integer bits, 16 fraction bits; u0.8 likewise without sign. Every rounding: docs/SPEC.md
//   errors      [[nodiscard]] status; nothing throws, allocates or keeps static state
//
// Start at draw.hpp (renderer), plane.hpp and polygon.hpp (what is drawn), texture.hpp (maps), profile.hpp (word lengths);
// camera.hpp (planes by angles), object_grid.hpp, object_space.hpp (polygons filtered on the screen).
#pragma once
#include <spantex/camera.hpp>
#include <spantex/draw.hpp>
#include <spantex/global_memory.hpp>
#include <spantex/object_space.hpp>
#include <spantex/plane.hpp>
#include <spantex/polygon.hpp>
#include <spantex/profile.hpp>
#include <spantex/shade.hpp>
#include <spantex/skips.hpp>
#include <spantex/status.hpp>
#include <spantex/texture.hpp>
#include <spantex/version.h>
