#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Proof that the checks bite: each gate breaks one line of a copy of the tree and runs the test that must notice, one gate a processor. A gate that stays
silent fails, and so does a line that is no longer there to break. A gate counts only if its test passes in the unbroken tree, tried once a suite.  --list names them; arguments select by name;
--short takes the first gate of each suite and leaves the unbroken tree to `make test`, which runs the same suites in it."""
import concurrent.futures
import fnmatch
import os
import pathlib
import queue
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
F = "firmware/spantex/"

STRESS = ["stress", "a_short_run*", [f"sim/stress{part}.cpp" for part in ("", "_describe", "_footprints", "_judge", "_planes", "_polygons")]]
KERNELS = [f"hal/kernels/{name}.cpp" for name in ("avx2", "avx512", "byte_planes", "kernel", "neon", "planar_map", "row_levels", "shortcuts", "sse41", "upright", "words")]
OBJECT_SPACE = ["sim/" + name + ".cpp" for name in ("distance_field", "draw_host", "encode", "encode_bc", "encode_etc", "figures", "file", "ideal",
                                                    "image", "map", "object_space_host", "palette", "pattern", "prefilter", "quality", "reference",
                                                    "scene", "trace", "unchanged", "world")] + KERNELS
MAPS = ["sim/" + name + ".cpp" for name in ("encode", "encode_bc", "encode_etc", "file", "image", "map", "palette", "pattern", "prefilter")]
PACKS = MAPS + ["sim/pack.cpp", "sim/inverse_filter.cpp"]
LEVELS = MAPS + ["sim/" + name + ".cpp" for name in ("archive", "ideal", "level", "model", "scene", "tour", "world")]
FIELDS = PACKS + ["sim/distance_field.cpp"]
LIBRARIES = {"bc": ["-lsquish"], "quake_level": ["-lassimp", "-lzip"]}  # that a suite links

BENCH = ["hal/bench_engine.cpp", "hal/bench_link.cpp", "sim/bench_wires.cpp"]
GPIOD = [*BENCH, "hal/gpiod_lines.cpp", "-DSPANTEX_GPIOD_VERSION=1", "-lgpiod", *(f"-Wl,--wrap=gpiod_{f}" for f in (
    "chip_open_lookup", "chip_close", "chip_get_line", "chip_find_line", "line_is_used", "line_consumer", "line_request_bulk", "line_release_bulk",
    "line_set_direction_input_bulk", "line_set_direction_output_bulk", "line_set_value_bulk", "line_get_value_bulk", "line_event_wait_bulk", "line_event_read"))]

GPIOD2 = [*BENCH, "hal/gpiod_lines.cpp", "-Itests/gpiod2", "-DSPANTEX_GPIOD_VERSION=2"]
COMPARE = [*BENCH, "sim/bench_compare.cpp", "sim/trace.cpp"]

# name, file, what stands there, what it is broken into, suite, case, further sources the suite links
GATES = [
    ("one Newton step less", F + "reciprocal.hpp", "for (int k = 0; k < unit.reciprocal_iterations; ++k)", "for (int k = 1; k < unit.reciprocal_iterations; ++k)", "reciprocal", "wide_reciprocal*", []),
    ("one bit less in the reciprocal", F + "reciprocal.hpp", "y = newton_step(m, y);\n  return y;", "y = newton_step(m, y);\n  return y & ~1u;", "reciprocal", "wide_reciprocal*", []),
    ("one bit less in 1/w", F + "coordinates.hpp", "return uint32_t(shift_right(y, 32 - bits - below_one));",
     "return uint32_t(shift_right(y, 32 - bits - below_one)) & ~1u;", "reciprocal", "one_over*", []),
    ("truncated quotients", F + "reciprocal.hpp", "(product + (uint64_t(1) << (shift - 1))) >> shift", "product >> shift", "reciprocal", "quotients*", []),
    ("truncated positions", F + "datapath.hpp", "return int32_t(scale_down(int64_t(u.raw()), decltype(u)::fraction_bits + level - bits, mode));",
     "return int32_t(scale_down(int64_t(u.raw()), decltype(u)::fraction_bits + level - bits, (void(mode), rounding::floor)));", "conformance", "exact_conforms_at*", ["sim/verifier.cpp"]),
    ("texel centres off by half", F + "datapath.hpp", "const auto u = position - half_texel_of(level);",
     "const auto u = position - half_texel{};", "conformance", "exact_conforms_at*", ["sim/verifier.cpp"]),
    ("rows: blocks that bend too much", F + "rows/block.hpp", "1 << (23 + 2 - row_tolerance_bits)", "1 << (23 + 7 - row_tolerance_bits)", "rows", "positions_keep*", []),
    ("rows: blocks at the horizon passed over", F + "rows/block.hpp", "hx + (p.w.x > 0 ? reach : -reach), hy + (p.w.y > 0 ? reach : -reach)", "hx, hy", "rows", "planes_to*", []),
    ("stored pixels as if in another column", F + "pixels.hpp", "++from, ++at.i, ++at.x) write_pixel<F>(at, *from, 255);", "++from, ++at.i) write_pixel<F>(at, *from, 255);", "rows_targets", "every_format*", []),
    ("rows: 1/w by one term less", F + "rows/block.hpp", "for (int n = 0; n < 3; ++n)", "for (int n = 0; n < 1; ++n)", "rows", "at_least_99*", []),
    ("rows: runs one texel too long", F + "rows/run.hpp", "(origin + size - neighbour) * (1 << 16)", "(origin + size) * (1 << 16)", "rows", "kernels_draw*repeat", []),
    ("rows: the coarser level's border unheeded", F + "rows/run.hpp", "within_both(s.within.u, of_finer(c.u))", "s.within.u", "rows", "kernels_draw*repeat", []),
    ("rows: colours cut", F + "rows/sample.hpp", "const uint32_t half = 1u << bits >> 1;", "const uint32_t half = 0 * bits;", "rows", "colours_lie*", []),
    ("a dither matrix turned", F + "pixels.hpp", "bayer.m[at.y & 7][at.x & 7]", "bayer.m[at.x & 7][at.y & 7]", "pixels", "every_colour*", []),
    ("blends of 16 bits by one alpha off", F + "pixels.hpp", "s * alpha + d * (255 - alpha)", "s * alpha + d * (256 - alpha)", "pixels", "every_blend*", []),
    ("nibbles the other way round", F + "pixels.hpp", "(at.i & 1) != 0 ? 0 : 4", "(at.i & 1) != 0 ? 4 : 0", "pixels", "a_run_touches*", []),
    ("swapped numbers not swapped", F + "pixels.hpp", "(__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) == native", "(__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) != native", "pixels",
     "every_colour*", []),
    ("a key that is drawn", F + "pixels.hpp", "{ return c == key; }", "{ return c == key && key == 0; }", "pixels", "a_run_touches*", []),
    ("one buffer for two", F + "rows/targets.hpp", "    started[buffer] = true;\n    buffer ^= 1;", "    started[buffer] = true;", "rows_targets", "tiles_equal*", []),
    ("a buffer that is not waited for", F + "rows/targets.hpp", "    if (started_[next_]) display_.wait(next_);\n    started_[next_] = false;\n    return direct", "    return direct", "rows_targets",
     "runs_sent*", []),
    ("transfers left under way", F + "rows/targets.hpp", "    if (started[buffer]) display.wait(buffer);\n  return result;", "    (void)result;\n  return result;", "rows_targets", "tiles_that*", []),
    ("a clip that is not kept", F + "rows/targets.hpp", "t.area_ = intersection(memory_.held, clip);", "t.area_ = intersection(memory_.held, memory_.held); (void)clip;", "rows_targets", "every_format*", []),
    ("tiles set up for themselves", F + "rows/targets.hpp", "target.set_screen(screen);", "target.set_screen(tile);", "rows_pictures", "tiles_show*", []),
    ("quads by affine weights", F + "pictures.hpp", "accumulate(out.of[n], uint64_t(cut_to(i, a.all, bits)), uint64_t(cut_to(j, a.all, bits)));", "out.of[n] = wide(i > 0 && j > 0 ? 1 : 2);", "rows_pictures", "quads_hit*", []),
    ("quads on the map by the screen alone", F + "pictures.hpp", "if (shape == quad_shape::any) multiply_by_areas(map, bits, w);", "", "rows_pictures", "quads_between*", []),
    ("depths of 20 bits", F + "pictures.hpp", "down = max_of(0, most - room);", "down = max_of(0, most - min_of(room, 20));", "rows_pictures", "quads_between*", []),
    ("pictures at the right border left out", F + "pictures.hpp", "right = right && x >= p.box.x1;", "right = right && x >= p.box.x1 - 20;", "rows_pictures", "pictures_at*", []),
    ("corners of the map of one depth", F + "pictures.hpp", "= {v.map.u, v.map.v, v.w};", "= {v.map.u, v.map.v, 1};", "rows_pictures", "triangles_on*", []),
    ("what is clipped written over what is not", F + "polygon.hpp", "const int start = max_edges - 1 - o.count;", "const int start = min_of(2, max_edges - 1 - o.count);", "polygon", "outlines*", []),
    ("carries of products lost", F + "wide.hpp", "+ high + (sum.low < low ? 1u : 0u));", "+ high);", "wide", "products_of*", []),
    ("products of a negative factor", F + "wide.hpp", "- (a < 0 ? uint64_t(b) : 0) - (b < 0 ? uint64_t(a) : 0));", "- (a < 0 ? uint64_t(b) : 0));", "wide", "products_of*", []),
    ("halves cut at set-up", F + "wide.hpp", "if (half && ++a.low == 0) ++a.high;", "", "wide", "shifts*", []),
    ("quads of any shape", F + "pictures.hpp", "return turns == 4 || turns == -4;", "return turns <= 4;", "rows_pictures", "quads_that*", []),
    ("sprites turned the other way", F + "pictures.hpp", "form(out.exact_v, s.scale_x, -turn.sine,", "form(out.exact_v, s.scale_x, turn.sine,", "rows_pictures", "sprites_lie*", []),
    ("tenths of a degree cut", F + "pictures.hpp", "* 1250999896492u + (1u << 19)) >> 20", "* 1250999896492u) >> 20", "rows_pictures", "sprites_lie*", []),
    ("ceilings taken for floors", F + "pictures.hpp", "const int sign = map.height > 0 ? -1 : 1;", "const int sign = -1;", "rows_pictures", "floors_and*", []),
    ("a cube's faces mixed up", F + "pictures.hpp", "{6, 2, 0, 4}, {2, 3, 1, 0}", "{2, 3, 1, 0}, {6, 2, 0, 4}", "rows_pictures", "faces_of*", []),
    ("back faces drawn", F + "rows/pictures.hpp", "list.cull == culling::back && !memory.shape.front_facing", "list.cull == culling::back && memory.shape.box.empty()", "rows_pictures", "triangle_lists*", []),
    ("indices not looked at", F + "rows/pictures.hpp", "if (*indices++ >= vertex_count) return", "if (*indices++ > vertex_count + 9) return", "rows_pictures", "triangle_lists*", []),
    ("the C interface's scales mixed up", F + "spantex_c.cpp", "s.scale_x, s.scale_y, s.angle", "s.scale_y, s.scale_x, s.angle", "c_interface", "quads_and*", [F + "spantex_c.cpp"]),
    ("a null map taken", F + "spantex_c.cpp", "map == nullptr || in(*map).level_count() == 0", "map == nullptr", "c_interface", "what_is*", [F + "spantex_c.cpp"]),
    ("wrong tie rule of edges", F + "coverage.hpp", "dy < 0 || (dy == 0 && dx > 0)", "dy < 0 || dy == 0", "coverage", "a_square*", []),
    ("no tie rule of edges", F + "coverage.hpp", "(top_left ? 0 : 1)", "0 * top_left", "coverage", "fans*", []),
    ("swapped banks", F + "local_memory.hpp", "fine_[channel][parity_banks::bank(x, y)][block] = value;",
     "fine_[channel][parity_banks::bank(y, x)][block] = value;", "local_memory_banks", "every_fetch*", []),
    ("output switch without its second bit", F + "local_memory.hpp", "return (select & 2) ?", "return false ?", "local_memory_banks", "every_fetch*", []),
    ("a vector kernel's halves always up", "hal/kernels/vectors/pixels.hpp", "add16(rest, x & 0x00800080)", "add16(rest, set(0x00800080))", "kernels", "random_planes*", KERNELS),
    ("a vector kernel's texels beyond a period", "hal/kernels/vectors/kernel.hpp", "in_reach(levels, 0, reach_of(c), p)", "in_reach(levels, 0, reach_of(c) - 8192, p)", "kernels", "random_planes*", KERNELS),
    ("a vector kernel's reciprocal of one Newton step", "hal/kernels/vectors/reciprocal.hpp", "newton(m, newton(m, seed))", "newton(m, seed)", "kernels", "random_planes*", KERNELS),
    ("NEON's next level without its half", "hal/kernels/vectors/tables_neon.hpp", "uint16_t(1 - 128)", "uint16_t(-128)", "scripts", "kernel_identity", []),
    ("NEON's pixels all between the finer two of three levels", "hal/kernels/vectors/tables_neon.hpp", "  pick(upper, far, middle);\n", "", "scripts", "kernel_identity", []),
    ("NEON's levels near and far the same", "hal/kernels/vectors/neon.hpp", "vqsubq_u16(whole, vdupq_n_u16(128))", "vqsubq_u16(whole, vdupq_n_u16(127))", "scripts", "kernel_identity", []),
    ("NEON's twist the wrong way", "hal/kernels/vectors/neon.hpp", "twist = vsub_s32", "twist = vadd_s32", "scripts", "kernel_identity", []),
    ("a vector kernel's far texels wrapped within four periods", "hal/kernels/vectors/spans.hpp", "if (l.doublings > 0)", "if (l.doublings > 99)", "kernels", "random_planes*", KERNELS),
    ("a vector kernel's ratios of positions cut to 14 bits", "hal/kernels/vectors/spans.hpp", "<< rest_bits) + rest_u", "<< rest_bits)", "kernels", "random_planes*", KERNELS),
    ("a vector kernel's far periods kept on levels that are no halves", "hal/kernels/vectors/spans.hpp", " - turned * (1 << q.subtexel_bits)", " - 0 * turned", "kernels", "levels_that*", KERNELS),
    ("a vector kernel's lanes all on the first one's level", "hal/kernels/vectors/spans.hpp", "out = whole == set(level[k]) ? on(level[k]) : out;", "out = out;", "kernels", "levels_that*", KERNELS),
    ("a vector kernel's samples not counted", "hal/kernels/vectors/pixels.hpp", "if (!every_one) x &=", "if (!every_one) (void)", "kernels", "random_planes*", KERNELS),
    ("a vector kernel's mean half up", "hal/kernels/vectors/pixels.hpp", "whole - (v((whole * n) << 15 == t) & whole & 1)", "whole", "kernels", "random_planes*", KERNELS),
    ("a vector kernel's rows as long as they like", "hal/kernels/vectors/aniso.hpp", "limit - reach_of(c)", "8192", "kernels", "rows_beyond*", KERNELS),
    ("a vector kernel's texels before the division", "hal/kernels/vectors/common.hpp", "extent + (extent >> (-1 - c.slope_log2)) + 1", "extent", "kernels", "texels_after*", KERNELS),
    ("kernels of other flags under one name", "firmware/spantex/rows/packed.hpp", "define SPANTEX_ROWS_KERNELS with_thumb1", "define SPANTEX_ROWS_KERNELS plain", "scripts", "mixed_flags", []),
    ("copies of texels next to the centre", "hal/kernels/shortcuts.cpp", "2 * most_off_centre * (w >> 16)", "2 * (most_off_centre + 72) * (w >> 16)", "kernels", "whole_texels_are*", KERNELS),
    ("copies of texels on a level", "hal/kernels/shortcuts.cpp", "2 * most_off_centre * (w >> 16)", "2 * (most_off_centre + 48) * (w >> 16)", "kernels", "whole_texels_of*", KERNELS),
    ("copies of what does not stay at the centre", "hal/kernels/shortcuts.cpp", "&& holds(c.x0, c.y1) && holds(c.x1, c.y1)", "", "kernels", "whole_texels*", KERNELS),
    ("copies along one axis looked at", "hal/kernels/shortcuts.cpp", " && centred(p.v_at(x, y), y + 2 * v)", "", "kernels", "whole_texels*", KERNELS),
    ("copies beyond the end of the range", "hal/kernels/shortcuts.cpp", "constexpr int32_t farthest = 32000", "constexpr int32_t farthest = 40000", "kernels", "whole_texels*", KERNELS),
    ("copies beyond a clamped map's end from its beginning", "hal/kernels/shortcuts.cpp", "row[map.columns - 1]", "row[0]", "kernels", "whole_texels*", KERNELS),
    ("copies of a map that begins again a texel late", "hal/kernels/shortcuts.cpp", "count > 0; at = 0", "count > 0; at = 1", "kernels", "whole_texels*", KERNELS),
    ("parts of spans copied whole", "hal/kernels/shortcuts.cpp", "if (bits == a_row)", "if (bits != 0)", "kernels", "whole_texels*", KERNELS),
    ("a map of one colour but one texel filled", "hal/kernels/row_levels.cpp", "uniform_ &= texels_.back() == texels_.front();", "", "kernels", "random_planes*", KERNELS),
    ("scaled planes: columns of the row's length", 'hal/kernels/upright.cpp', 'const span_coefficients c = mantissas(u, v, std::max(u.bits, row_bits));', 'const span_coefficients c = mantissas(u, v, row_bits);', "kernels", "spans_of_two*", KERNELS),
    ("scaled planes: rows of the first length", "hal/kernels/upright.cpp", "if (k > 0 && at[j] != y) return false;", "", "kernels", "spans_of_two*", KERNELS),
    ("scaled planes: the level of the first length", "hal/kernels/upright.cpp", "t.level = t.lengths.size() == 1 || t.level == level ? level : -1;", "t.level = level;", "kernels", "levels_of_two*", KERNELS),
    ("scaled planes: turned ones", "hal/kernels/upright.cpp", "(p.u.y | p.v.x | p.w.x | p.w.y) == 0", "(p.v.x | p.w.x | p.w.y) == 0", "kernels", "planes_that*", KERNELS),
    ("scaled planes: beyond the end of the range", "hal/kernels/upright.cpp", "if (!r.v_in_range || std::abs(r.base_v) > largest_base(kind_) || ", "if (", "kernels", "scaled_planes_at*", KERNELS),
    ("scaled planes: rounded forms where they show", "hal/kernels/upright.cpp", "return rounding_is_small(map_,", "return true || rounding_is_small(map_,", "kernels", "scaled_planes_of*", KERNELS),
    ("scaled planes: single texels to blend", "hal/kernels/upright.cpp", "return kind_ == filter::nearest ? nearest_texel(x, one) : blended", "return kind_ <= filter::bilinear ? nearest_texel(x, one) : blended", "kernels", "scaled_planes*", KERNELS),
    ("scaled planes: a clamped map's end a texel early", 'hal/kernels/level_rows.hpp', 'clamp_to(u, 1 - count, columns - 1)', 'clamp_to(u, 1 - count, columns - 2)', "kernels", "scaled_planes*", KERNELS),
    ("scaled planes: a clamped map's beginning", 'hal/kernels/level_rows.hpp', 'clamp_to(u, 1 - count, columns - 1)', 'clamp_to(u, 0, columns - 1)', "kernels", "scaled_planes*", KERNELS),
    ("scaled planes: the coarser level taken for the finer", 'hal/kernels/vectors/upright.hpp', 'return pixels_between(fine, coarse, fraction);', 'return pixels_between(coarse, fine, fraction);', "kernels", "scaled_planes*", KERNELS),
    ("scaled planes: a level rounded once", "hal/kernels/vectors/upright.hpp", "return pixels_of_level(fine);", "return pixels_of(fine);", "kernels", "scaled_planes*", KERNELS),
    ("scaled planes: columns from the table's beginning", 'hal/kernels/vectors/upright.hpp', "return l.columns->prepared.data() + (work.sx", "return l.columns->prepared.data() + 0 * (work.sx", "kernels", "scaled_polygons*", KERNELS),
    ("scaled planes: four texels for two pixels that take five", "hal/kernels/vectors/blend_rows.hpp", "> near_texels - 2)", "> near_texels - 1)", "kernels", "scaled_planes*", KERNELS),
    ("scaled planes: mirrored pixels from the first one's texels", "hal/kernels/vectors/blend_rows.hpp", "const int32_t first = min_of(texel(n), texel(n + 1));", "const int32_t first = texel(n);", "kernels", "scaled_planes*", KERNELS),
    ("fills behind the viewer", "hal/kernels/shortcuts.cpp", "return s.map->w_at(x, y) > 0; })", "return s.map->w_at(x, y) != 0; })", "kernels", "maps_of_one*", KERNELS),
    ("a vector kernel's positions next to the range's end", "hal/kernels/kernel.hpp", "- (2 << max_extent_log2) - 2", "- (1 << max_extent_log2) - 2", "kernels", "positions_next*", KERNELS),
    ("a vector kernel's texels beyond two periods", "hal/kernels/vectors/spans.hpp", "  at = least16_unsigned(at, subtract16(at, two));\n", "", "kernels", "random_planes*", KERNELS),
    ("words rounded half up", "hal/kernels/vectors/words.hpp", "- 1) * in_both + (x >> fraction & in_both)", "- 0) * in_both", "kernels", "random_planes*", KERNELS),
    ("truncated colours", F + "filter.hpp", "uint8_t(round_off(c.value, c.bits, q.colour_rounding))", "uint8_t(c.value >> c.bits)", "filter", "*within_1_lsb*", []),
    ("weights that do not sum to one", F + "filter.hpp", "return (a << weight_bits) + (b - a) * f;", "return (a << weight_bits) - a + (b - a) * f;",
     "filter", "a_constant*", []),
    ("an interpolation with two multiplications", F + "filter.hpp", "return (a << weight_bits) + (b - a) * f;", "return a * ((Number(1) << weight_bits) - f) + b * f;",
     "kt88_operations", "*trilinear*", []),
    ("level off by one bit", F + "level.hpp", "return power * (log2_16", "return 1 * (log2_16", "level", "exact_profile*", []),
    ("minor axis that falls as the major one", F + "level.hpp", "return f == level_formula::minor ? 1 : 2;", "return f == level_formula::minor ? 2 : 2;",
     "level", "the_minor_axis*", []),
    ("nearest level rounded up on ties", F + "level.hpp", "((level + half + (1 << level_bits) - 1) >> level_bits) - 1", "(level + half) >> level_bits", "level", "the_nearest*", []),
    ("spans of 16 pixels taken for 8", F + "coordinates.hpp", "return (1 << v.span_log2) - 1;", "return min_of(reach, (1 << v.span_log2) - 1);", "run_time_profile", "spans_of_*", []),
    ("rows' levels of spans of 4 and 16 pixels about the wrong point", F + "level.hpp", "hy = half_pixels(k) + c.from_y;", "hy = half_pixels(k) + 0 * c.from_y;", "level", "spans_of_4*", []),
    ("columns' levels of spans of 4 and 16 pixels about the wrong point", F + "level.hpp", "hx = half_pixels(k) + c.from_x,", "hx = half_pixels(k) + 0 * c.from_x,", "level", "spans_of_4*", []),
    ("sections of an evaluation asked for not widened", F + "coordinates.hpp", "bound += forced_evaluation_bound(", "bound += 0 * forced_evaluation_bound(", "run_time_profile",
     "evaluations_asked*", []),
    ("a seed of a smaller table", F + "reciprocal.hpp", "reciprocal_seed(k, bits);\n}", "reciprocal_seed(k, bits) + 64;\n}", "run_time_profile", "reciprocals_of*", []),
    ("section one texel short", F + "plan.hpp", "const int32_t neighbour = kind == filter::nearest ? 0 : 1;", "const int32_t neighbour = 0 * int(kind);", "plan", "spans_equal*power*", []),
    ("sections not widened for rounding", F + "coordinates.hpp", "return int32_t(2 * bound >> (error_unit_log2 - 16)) + 2;", "(void)bound; return -6;", "plan",
     "jobs_hold*", []),
    ("wrap off by one", F + "wrap.hpp", "return k < size ? k : period - 1 - k;", "return k < size ? k : period - k;", "wrap", "*", []),
    ("halves of the engine not told apart", "hal/direct_engine.hpp", "one_half& x = halves_[int(h)];\n    SPANTEX_TRY(x.life.may_load());\n    return x.texels",
     "one_half& x = halves_[0];\n    SPANTEX_TRY(x.life.may_load());\n    return x.texels", "draw", "*", []),
    ("ownership not checked", "hal/engine.hpp", "if (busy_) return status::half_busy;\n    if (!ready_)", "if (!ready_)", "hal_conformance", "*", ["sim/trace.cpp", *BENCH]),
    ("a half that the loader has filtered", "hal/ownership.hpp", "if (overlap_cycles(time, loading_[int(h)]) != 0) return noted", "if (false) return noted", "loading_engine", "a_half_that_the_loader*", []),
    ("a half that the filter has loaded", "hal/ownership.hpp", "if (overlap_cycles(time, computing_[int(h)]) != 0) return noted", "if (false) return noted", "loading_engine",
     "a_half_that_the_filter*", []),
    ("the loader not waited for", "hal/loading_engine.hpp", "if (loading_ && loading_half_ == h) settle();", "", "loading_engine", "pictures_of_seed*", []),
    ("the loader's word not asked", "hal/loading_engine.hpp", "      s = loader_.state();\n", "      s = status::ok;\n", "loading_engine", "pictures_of_seed*", []),
    ("a load given up that goes on", "hal/loading_engine.hpp", "if (s != status::ok) loader_.stop();", "", "loading_engine", "a_load_that_never*", []),
    ("runs copied beyond the map's edge", F + "loader.hpp", "&& t.wrapped_u(u + count, at.level) == from + count) ++count;", ") ++count;", "loading_engine", "copied*", []),
    ("W = 0 drawn", F + "coverage.hpp", "if (value > 0) mask |=", "if (value >= 0) mask |=", "coverage", "front_masks*", []),
    ("vertices snapped downwards", F + "polygon.hpp", "const int64_t n = x * (int64_t(2) << subpixel_bits) + z,", "const int64_t n = x * (int64_t(2) << subpixel_bits),",
     "polygon", "vertices_snap*", []),
    ("set-up rounded down", F + "wide.hpp", "constexpr wide scale_down(const wide& a, int n) { return n >= 0 ? shift_right_nearest(a, n)",
     "constexpr wide scale_down(const wide& a, int n) { return n >= 0 ? shift_right_floor(a, n)", *STRESS),
    ("slopes of w cut short", F + "coordinates.hpp", "bit_length(slope) - 31", "bit_length(slope) - 12", *STRESS),
    ("affine too early", F + "coordinates.hpp", "+ 1 + steep <= -q.tolerance_bits)", "+ 1 + steep <= 3 - q.tolerance_bits)", *STRESS),
    ("a term too few", F + "coordinates.hpp", "c.terms = uint8_t(terms);", "c.terms = uint8_t(terms > 1 ? terms - 1 : 1);", *STRESS),
    ("the planner forgets the 16 bits of a series", F + "coordinates.hpp", "|| resolution_log2 + slope_log2 > series_bits - 3 - q.tolerance_bits) return;",
     "|| resolution_log2 < -99) return;", "series", "what_the_planner*", []),
    ("series too early by a bit", F + "coordinates.hpp", "+ 1 <= -q.tolerance_bits - 1) {", "+ 1 <= -q.tolerance_bits) {", "series", "what_the_planner*", []),
    ("a series' slope of the wrong scale", F + "coordinates.hpp", "bit_length(slope) - q.reciprocal_bits,", "bit_length(slope) - 1 - q.reciprocal_bits,",
     "series", "what_the_planner*", []),
    ("powers of e summed without their signs", F + "coordinates.hpp", "trust_to<series_number>(e - series_number", "trust_to<series_number>(e + series_number",
     "series", "every_slope*", []),
    ("numerators of a series cut to 13 bits", F + "coordinates.hpp", "offset_bits - series_bits - 1);", "offset_bits - series_bits + 2);", "series", "numerators*", []),
    ("flat logarithms without e^2", F + "level.hpp", "series_number::from_raw(square.raw() >> (series_bits + 1 - slope_log2)));",
     "series_number::from_raw(square.raw() >> 31));", "series", "every_logarithm*", []),
    ("flat logarithms of steep spans", F + "level.hpp", "most_level_slope_log2 = -4;", "most_level_slope_log2 = -3;", "series", "every_logarithm*", []),
    ("halves up at write-out", F + "filter.hpp", "uint8_t(round_off(c.value, c.bits, q.colour_rounding))", "uint8_t(round_off(c.value, c.bits, rounding::nearest))",
     "properties", "weights_of*", []),
    ("halves up in means", F + "filter.hpp", "rest + (whole & 1) > weight - rest;", "rest >= weight - rest;", "properties", "weights_of*", []),
    ("one level of two not rounded", F + "datapath.hpp", "if (!c.two_levels) return kept_of_level(fine, q, most_bits);", "if (!c.two_levels) return fine;",
     "plan", "spans_equal*other*", []),
    ("two levels rounded after, not before", F + "filter.hpp", "const int bits = min_of(c.bits, min_of(q.blend_bits, most_bits - q.level_bits));",
     "const int bits = min_of(c.bits, min_of(0 * q.blend_bits, most_bits - q.level_bits));", "filter", "two_levels_are_within*", []),
    ("beyond the range on the wrong side", F + "coordinates.hpp", "return n < 0 ? 1 - limit : limit - 1;", "return limit - 1;", *STRESS),
    ("drift across a row", F + "plane.hpp", "return f.c + f.x * (hx - origin_x) + f.y * (hy - origin_y);",
     "return f.c + f.x * (hx - origin_x) + f.y * (hy - origin_y) + (hx >> 6);", *STRESS),
    ("log2 between its knots", F + "log2.hpp", "(((high - low) * t + 0x8000) >> 16)", "((high - low) / 2)", *STRESS),
    ("an axis of one texel forgotten", F + "datapath.hpp", "return one ? 0 : detail::on_level", "return one && level > 3 ? 0 : detail::on_level", *STRESS),
    ("triangles of the three-point filter exchanged", F + "filter.hpp", "if (!(w.v >= w.u)) {", "if (w.v >= w.u) {", *STRESS),
    ("small polygons refused", F + "polygon.hpp", "if (area == 0) return status::degenerate;",
     "if (area < 4096 && area > -4096) return status::degenerate;", *STRESS),
    ("polygons turned inside out", F + "polygon.hpp", "for (int k = 0; k < 3 && determinant.negative(); ++k)", "for (int k = 0; k < 3 && determinant.zero(); ++k)", *STRESS),
    ("spans of the stress run away from the horizon", "sim/stress_planes.cpp", "      put_horizon(s, r, 6);\n",
     "", *STRESS),
    ("set-up's rounding always small enough", F + "coordinates.hpp", "return p.rounding_bits == 0 || ", "return true || p.rounding_bits == 0 || ", "coordinates",
     "the_callers*", []),
    ("set-up's rounding told from a sixteenth of W", F + "coordinates.hpp", "set_up_tolerance_bits = 12;", "set_up_tolerance_bits = 0;", "coordinates", "the_callers*", []),
    ("exact forms about the wrong base", F + "coordinates.hpp", "x.b = f.y - multiply(p.exact_w.y, x.base);", "x.b = f.y - multiply(p.exact_w.x, x.base);", "coordinates",
     "exact_references*", []),
    ("exact forms cut to 20 bits of W", F + "coordinates.hpp", "exact_w_bits = 45,", "exact_w_bits = 20,", "coordinates", "exact_references*", []),
    ("exact forms not the caller's", F + "plane.hpp", "out.exact_v.x = m.d;", "out.exact_v.x = m.a;", *STRESS),
    # the bench
    ("bench: CRC-16 not compared", "firmware/bench/frame.hpp", "return refuse(result::bad_crc);", "(void)0;", "bench_faults", "every_lie*", BENCH),
    ("bench: CRC-16 with its low byte first", "firmware/bench/frame.hpp", "uint32_t(bytes_[size_ - 2] << 8 | bytes_[size_ - 1])", "uint32_t(bytes_[size_ - 1] << 8 | bytes_[size_ - 2])",
     "bench_frames", "damaged*", []),
    ("bench: CRC-16 by another polynomial", "firmware/bench/wire.hpp", "0x1021u : 0u", "0x1020u : 0u", "bench_frames", "errors*", []),
    ("bench: seal of answers not compared", "hal/bench_link.cpp", "if (!answer_.sealed_with(session)) return", "if (false) return", "bench_faults", "every_lie*", BENCH),
    ("bench: answers of another sequence taken", "hal/bench_link.cpp", " || answer_.sequence() != sequence_)", ")", "bench_faults", "every_lie*", BENCH),
    ("bench: repeated frames executed again", "firmware/bench/responder.hpp", "if (has_executed_ && request_.command() == executed_command_",
     "if (false && request_.command() == executed_command_", "bench_faults", "every_fault*", BENCH),
    ("bench: half bytes exchanged", "firmware/bench/port.hpp", "upper_out_ ? held_out_ & 15 : held_out_ >> 4", "upper_out_ ? held_out_ >> 4 : held_out_ & 15", "bench_faults",
     "sound*", BENCH),
    ("bench: state not restored", "hal/bench_engine.cpp", "SPANTEX_TRY(restore(h));", "(void)h;", "bench_faults", "a_device_that_restarts*", BENCH),
    ("bench: loss of the other half not reported", "hal/bench_engine.cpp", "if (k != h && !memory_[int(k)].empty()) unreported_", "if (false) unreported_", "bench_faults",
     "a_device_that_is_gone*", BENCH),
    ("bench: lines left driven when the device is gone", "hal/bench_engine.cpp", "  connected_ = false;\n  link_.lines().release_all();\n  return why", "  connected_ = false;\n  return why",
     "bench_faults", "a_device_that_is_gone*", BENCH),
    ("bench: coefficients taken unchecked", "firmware/bench/responder.hpp", "if (!coefficients_in_range(prof_.get(), c)) return", "if (false) return",
     "coefficient_ranges", "the_device*", BENCH),
    ("bench: numerators of any size taken", "firmware/bench/coefficient_ranges.hpp", "if (n >= uint64_t(1) << q.offset_bits || n >", "if (n >", "coefficient_ranges", "every_range*", BENCH),
    ("bench: coefficients of the planner refused", "firmware/bench/coefficient_ranges.hpp", "+ max_extent_log2)) + 16)", "+ max_extent_log2 - 2)))", "coefficient_ranges", "what_the*", BENCH),
    ("bench: exchanged weights not told from a sound filter", "sim/bench_compare.cpp", "plain(0, 0, filter::bilinear, u, v)", "plain(0, 0, filter::bilinear, u, u)",
     "bench_compare", "every_broken*seed*", COMPARE),
    ("bench: a difference in the span of the other half", "sim/bench_compare.cpp", "what == operation::take ? memory_[int(h)].span : marked_", "marked_", "bench_compare", "another_answer*", COMPARE),
    ("bench: libgpiod 2 leaves its settings", "hal/gpiod_lines.cpp", "  gpiod_line_settings_free(settings);", "", "gpiod2_lines", "every_failing*", GPIOD2),
    ("bench: a line's lookup fails unnamed", "hal/gpiod_lines.cpp", 'return failed("line " + std::string(role) + " = " + *name', 'return failed("line " + *name', "gpiod_lines", "every_failing*", GPIOD),
    ("bench: control lines stay outputs", "hal/gpiod_lines.cpp", "if (control_driven) control_driven = gpio::make_inputs(control) != 0;", "", "gpiod_lines", "lines_become*", GPIOD),
    ("bench: backing off beyond the exchange", "hal/bench_link.cpp", "lines_.pause(std::min(back_off_ns, left_ns));", "lines_.pause(back_off_ns), (void)left_ns;", "bench_faults", "backing_off*", BENCH),
    ("bench: a device that comes back not waited for", "hal/bench_engine.cpp", "(k >= limits.recoveries && !wait_longer)", "k >= limits.recoveries + 0 * wait_longer", "bench_faults", "patience*", BENCH),
    ("bench: identities of other fields taken", "hal/bench_engine.cpp", "if (!whole_identity_) return", "if (false) return", "bench_faults", "a_profile_of*", BENCH),
    ("bench: a field of profiles not sent", "hal/span_archive.hpp", 'visit("mip_bias", mip_bias);', "static_cast<void>(mip_bias);", "bench_faults", "a_device_of_another*", BENCH),
    ("bench: a device's last field not compared", "firmware/bench/responder.hpp", "k < profile_field_count; ++k)\n      if (wanted", "k + 1 < profile_field_count; ++k)\n      if (wanted",
     "bench_faults", "every_field*", BENCH),
    ("bench: faults that leave lines driven", "hal/gpiod_lines.cpp", "  if (release_lines != nullptr) release_lines();\n", "", "gpiod_lines", "every_signal*", GPIOD),
    ("bench: a signal not caught", "hal/gpiod_lines.cpp", "s <= SIGRTMAX; ++s) {", "s <= SIGTERM; ++s) {", "gpiod_lines", "every_signal*", GPIOD),
    ("bench: echo that does not turn", "firmware/bench/port.hpp", "latched_ << 1 | latched_ >> (DataBits - 1)", "latched_", "bench_self_test", "sound_wires*",
     [*BENCH, "sim/bench_self_test.cpp"]),
    # packages
    ("packages: a manifest of another version", "library.json", '"version": "0.1.0"', '"version": "0.1.1"', "packaging", "version_agrees", []),
    ("packages: a field that PlatformIO does not know", "library.json", '"license":', '"licence":', "packaging", "manifests", []),
    ("packages: headers for C not installed", "CMakeLists.txt", 'PATTERN "*.hpp" PATTERN "*.h")', 'PATTERN "*.hpp")', "packaging", "installed_headers", []),
    ("packages: the engine not installed", "CMakeLists.txt", "${spantex_dir}/hal/engine.hpp ${spantex_dir}/hal/direct_engine.hpp ", "${spantex_dir}/hal/engine.hpp ", "packaging", "pkg_config", []),
    ("packages: another minor version taken", "CMakeLists.txt", "COMPATIBILITY SameMinorVersion", "COMPATIBILITY SameMajorVersion", "packaging", "cmake_installed", []),
    ("packages: installed where nobody asked", "CMakeLists.txt", "set(spantex_install_default OFF)", "set(spantex_install_default ON)", "packaging", "cmake_subdirectory", []),
    ("packages: sources of the C interface left out", "CMakeLists.txt", "CONFIGURE_DEPENDS ${spantex_dir}/firmware/spantex/*.cpp)", "CONFIGURE_DEPENDS ${spantex_dir}/firmware/spantex/*.cc)", "packaging", "c_interface", []),
    ("packages: C++17 told nothing", F + "bits.hpp", "#if __cplusplus < 201709L", "#if __cplusplus < 201103L", "packaging", "older_standard", []),
    ("packages: globs watched in ESP-IDF's script", "CMakeLists.txt", "  file(GLOB spantex_sources ${", "  file(GLOB spantex_sources CONFIGURE_DEPENDS ${", "packaging", "esp_idf", []),
    ("packages: headers twice in one", "tools/amalgamate", "        if name in self.done:\n", "        if name == 0:\n", "packaging", "one_header", []),
    ("packages: a file short in PlatformIO's", "library.json", '"hal/engine.hpp", ', "", "packaging", "platformio", []),
    ("packages: spantex in Zephyr without C++20", "zephyr/Kconfig", "\tdepends on STD_CPP20 || STD_CPP2B\n", "", "packaging", "zephyr_kconfig", []),
    ("packages: the man page lacks a subcommand", "docs/spantex.1", ".B sweep\n", ".I sweep\n", "packaging", "man_page", []),
    ("packages: uninstall takes what is not ours", "Makefile", " -depth -type d -empty -delete", " -depth -delete", "packaging", "uninstall", []),
    ("packages: a name that Arduino has as a macro", F + "bits.hpp", "constexpr int min_of(int a, int b) { return a < b ? a : b; }",
     "constexpr int min(int a, int b) { return a < b ? a : b; }\nconstexpr int min_of(int a, int b) { return min(a, b); }", "packaging", "arduino", []),
    ("examples: a band drawn over while DMA sends it", "docs/examples/pico/main.cpp", "draw_band(floor, map, y, bands[which])", "draw_band(floor, map, y, bands[0])", "packaging", "arduino", []),
    ("examples: DMA not waited for", "docs/examples/pico/main.cpp", "dma_channel_wait_for_finish_blocking(channel);  // the other band is out", "", "packaging", "pico", []),
    ("examples: LVGL's stride taken for its width", "docs/examples/lvgl/perspective_image.cpp", "int32_t(buffer->header.stride / 2)}", "int32_t(buffer->header.w)}", "packaging", "lvgl", []),
    ("a source without its licence", "tools/targets.py", "# SPDX-License-Identifier: Apache-2.0\n", "", "licence_headers", "*", []),
    # wrap modes
    ("repeat without its sign", F + "wrap.hpp", "if (k < 0) k += period;", "(void)0;", "wrap", "every_size*", []),
    ("mirror like repeat", F + "wrap.hpp", "mode == wrap::mirror ? 2 * size : size", "size", "wrap", "large_sizes*", []),
    ("clamp one texel short", F + "wrap.hpp", "index < 0 ? 0 : size - 1", "index < 0 ? 0 : size - 2", "wrap", "far_indices*", []),
    ("v wrapped by the width", F + "texture.hpp", "wrapped(wrap_v_, k, height(level))", "wrapped(wrap_v_, k, width(level))", "texture", "each_axis*", []),
    # level of detail
    ("shorter column of the Jacobian", F + "level.hpp", "c.level_row[j] > c.level_column[i] ?", "c.level_row[j] < c.level_column[i] ?", "level", "default_profile*", []),
    ("gradients without their twist", F + "level.hpp", "detail::log2_length(ux + twist_u * hy, vx + twist_v * hy, c.exponent)",
     "detail::log2_length(ux, vx, c.exponent)", "level", "exact_profile*", []),
    ("level of a pixel about itself off", F + "level.hpp", "(1 << 16) - 2 * log2_16(uint64_t(p.w_at(hx, hy)))", "(2 << 16) - 2 * log2_16(uint64_t(p.w_at(hx, hy)))", "level", "spans_across*", []),
    ("major axis by one interval", F + "plane.hpp", "return max_of(g.x, g.y) + (2 << 16);", "return max_of(g.x, g.y) + (1 << 16);", "level", "the_major*", []),
    ("major axis with log2 W once", F + "level.hpp", "p.major_log2 - 2 * log2_of_w(r)", "p.major_log2 - log2_of_w(r)", "level", "the_major*", []),
    ("KT88's camera: half the axis", F + "plane.hpp", "(log2_16(magnitude(d)) - (16 << 16)) + (1 << 16);", "(log2_16(magnitude(d)) - (16 << 16));", "plane",
     "kt88_levels*", []),
    ("level bias in eighths", F + "level.hpp", "finer(unbiased_level(prof, c, i, j), q.mip_bias) + q.level_bias * (1 << 12);", "finer(unbiased_level(prof, c, i, j), q.mip_bias) + q.level_bias * (1 << 13);", "level", "the_bias*", []),
    # 16-bit texels
    ("5 bits widened by repeating", F + "texel.hpp", "uint8_t((x * 527 + 23) >> 6)", "uint8_t((x << 3) | (x >> 2))", "texel", "every_16*unpacks*", []),
    ("6 bits widened without rounding", F + "texel.hpp", "uint8_t((x * 259 + 33) >> 6)", "uint8_t((x * 259) >> 6)", "texel", "every_16*unpacks*", []),
    ("red and blue of rgb565 swapped", F + "texel.hpp", "{field(11, 5), field(5, 6), field(0, 5), 255}", "{field(0, 5), field(5, 6), field(11, 5), 255}", "texel",
     "every_16*unpacks*", []),
    # depth
    ("equal depths drawn", F + "visibility.hpp", "if (z <= stored) return false;", "if (z < stored) return false;", "polygon", "the_first*", []),
    ("depth not stored", F + "visibility.hpp", "if (stores) stored = z;", "(void)stores;", "polygon", "the_nearer*", []),
    ("depth off by a bit", F + "polygon.hpp", "const int down = 63 + shift - (drop - 1)", "const int down = 63 + shift - drop", "polygon", "depth_is*", []),
    # sections and jobs
    ("a span that does not fit drawn whole", F + "plan.hpp", "part) && count > 1) {", "part) && count > 64) {", "plan", "jobs_hold*", []),
    ("reciprocals of pixels near the horizon not counted", F + "plan.hpp", "    job.divides += detail::reciprocals_a_pixel(s.kind, c.how);\n    SPANTEX_TRY", "    SPANTEX_TRY", "plan", "jobs_hold*", []),
    ("runs that overlap", F + "plan.hpp", "    index += count;", "    index += count > 1 ? count / 2 : 1;", "correction", "a_span_is_split*", []),
    ("runs that never grow again", F + "plan.hpp", "index % (2 * count) == 0) count *= 2;", "index % (2 * count) == 0) break;", "correction", "a_span_is_split*", []),
    ("two pixels split side by side wrongly", F + "plan.hpp", "const int x = (index & 1) | ((index >> 1) & 2)", "const int x = (index & 1) | (index & 2)", "plan",
     "jobs_hold*", []),
    ("level raised twice", F + "plan.hpp", "        ++level;", "        level += 1 + (level + 1 < t.last_level());", "correction", "a_level_is_raised*", []),
    ("clamped section at its box's corner", F + "plan.hpp", "low : (low + high + 1 - side) >> 1", "low : low", "correction", "clamped_sections*", []),
    # correction, output switch
    ("correction with weight 0 at the far end", F + "datapath.hpp", "fraction = most;", "fraction = 0 * most;", "correction", "corrected_positions*", []),
    ("correction one texel too far", F + "datapath.hpp", "side - (kind == filter::nearest ? 1 : 2)", "side - 1", "correction", "corrected_positions*", []),
    ("correction keeps the weight at the near end", F + "datapath.hpp", "    texel = origin;\n    fraction = 0;", "    texel = origin;", "correction", "corrected_positions*", []),
    ("output switch without its first bit", F + "local_memory.hpp", "(select & 1) ?", "false ?", "local_memory_banks", "every_fetch*", []),
    # positions in short words
    ("long shifts of short words", F + "coordinates.hpp", "longest_position_shift(Prof::value) > 30", "longest_position_shift(Prof::value) > 99", "coordinates",
     "magnified*", []),
    # what the proofs are about: the code drifts from the formulas that were proved, or a range grows beyond them
    ("proofs: numerator", F + "coordinates.hpp", "mantissa::from_raw(b) * hy);", "mantissa::from_raw(b) * hx);", "scripts", "proofs", []),
    ("proofs: w", F + "coordinates.hpp", "Slope::from_raw(c.h) * hy);", "Slope::from_raw(c.h) * hx);", "scripts", "proofs", []),
    ("proofs: series", F + "coordinates.hpp", "product.raw() >> (series_bits - slope_log2)));", "product.raw() >> (series_bits - slope_log2 - (terms > 2))));",
     "scripts", "proofs", []),
    ("proofs: steeper series allowed", F + "coordinates.hpp", "most_series_slope_log2 = -2,", "most_series_slope_log2 = 0,", "scripts", "proofs", []),
    ("proofs: quotient", F + "reciprocal.hpp", "(magnitude(n) >> drop) * w.y; ", "((magnitude(n) >> drop) | 1) * w.y; ", "scripts", "proofs", []),
    ("proofs: planner's margin", F + "coordinates.hpp", "uint64_t(r.w) / 2 - uint64_t(r.w) / 256", "uint64_t(r.w) / 2 - uint64_t(r.w) / 512", "scripts", "proofs", []),
    ("proofs: exponent", F + "accuracy.hpp", "return min_of(p.offset_bits - 1 - extent_log2, max_exponent);", "return min_of(p.offset_bits - extent_log2, max_exponent);",
     "scripts", "proofs", []),
    ("proofs: gradients", F + "level.hpp", "slope(c.a_u, c.h) - slope(c.b_u, c.g)", "slope(c.a_u, c.h) + slope(c.b_u, c.g)", "scripts", "proofs", []),
    ("proofs: position on a level", F + "datapath.hpp", "spantex::u<0, 31>::from_raw(ratio) - half_texel_of(level);",
     "spantex::u<0, 31>::from_raw(ratio) - half_texel_of(0 * level);", "scripts", "proofs", []),
    ("proofs: offset_bits may be 32", F + "profile.hpp", "p.offset_bits <= 31", "p.offset_bits <= 32", "scripts", "proofs", []),
    ("proofs: shorter reciprocals allowed", F + "profile.hpp", "p.reciprocal_bits >= 12", "p.reciprocal_bits >= 11", "scripts", "proofs", []),
    ("proofs: level bound without its slopes", F + "accuracy.hpp", "144 * detail::bound_power", "36 * detail::bound_power", "scripts", "proofs", []),
    ("views cut from the wrong side", F + "object_grid.hpp", "box.y0 - 1, box.y1 + 1}, true}", "box.y0 - 1, box.y1 + 1}, false}", "object_space", "no_covered*", OBJECT_SPACE),
    ("grid of object space twice too coarse", F + "object_grid.hpp", "numerator = 30 * uint64_t(z)", "numerator = 60 * uint64_t(z)", "object_space", "no_covered*", OBJECT_SPACE),
    ("means of object space cut", F + "object_space.hpp", "uint8_t((sum + p.weight / 2) / p.weight)", "uint8_t((sum - p.weight / 2) / p.weight)", "object_space", "every_constant*", OBJECT_SPACE),
    ("sine without its last term", F + "camera.hpp", "y = series_step(square, inverse_of(20), y);\n  y = series_step(square, inverse_of(6), y);", "y = series_step(square, inverse_of(20), 0xFFFFFFFFu);\n  y = series_step(square, inverse_of(6), y);",
     "camera", "sine*", []),
    ("cut-outs pending in a span not waited for", F + "draw.hpp", "job.sx == sx && job.sy == sy) return drain();", "job.sx == sx && job.sy == sy) return status::ok;", "shade", "overlapping*", []),
    ("depth of cut-outs stored before they are known", F + "visibility.hpp", "if (stores) stored = z;", "(void)stores, stored = z;", "shade", "a_cut_out*", []),
    ("blend rounded down", F + "bits.hpp", "  x += 128;\n", "  x += 127;\n", "shade", "blends*", []),
    ("colours cut to 16 bits of W", F + "shade.hpp", "const inverse over_w = invert(w);", "const inverse over_w = invert(w >> 30 << 30);", "shade", "colours_are*", []),
    ("magnified contours not steepened", F + "contour.hpp", "return clamp_to(unit - across_log2(prof, c, d, i, j) -",
     "return clamp_to(unit - max_of(0, across_log2(prof, c, d, i, j)) -", "contour", "outlines*sixteenth*", []),
    ("contours by the longer axis alone", F + "contour.hpp", "int32_t across = length == 0 ?", "int32_t across = length != 1 ?", "contour", "outlines*tilted*", []),
    ("contours by the Jacobian, not its transposed", F + "contour.hpp", "detail::squares(d.u * ux + d.v * vx, d.u * uy + d.v * vy)",
     "detail::squares(d.u * ux + d.v * uy, d.u * vx + d.v * vy)", "contour", "outlines*tilted*", []),
    ("contours without the perspective", F + "contour.hpp", "across -= 2 * (log2_16", "across -= 0 * (log2_16", "contour", "*tilted*", []),
    ("contours of a span without the Jacobian's twist", F + "contour.hpp", "c.axis.b_u = slope(c.a_u, c.h) - slope(c.b_u, c.g);", "c.axis.b_u = 0;", "contour", "*tilted*", []),
    ("contours clamped in seed", F + "plan.hpp", "q.overflow == overflow_policy::clamp ? overflow_policy::coarser : q.overflow;", "q.overflow == overflow_policy::clamp ? q.overflow : q.overflow;",
     "contour", "cheaper*", []),
    ("own units of a contour forgotten", F + "contour.hpp", "const int32_t unit = c.contour.own_units ?", "const int32_t unit = !c.contour.own_units ?", "contour", "the_distance*", []),
    ("outline of half its width", F + "contour.hpp", "outline * (1 << 11)", "outline * (1 << 10)", "contour", "coverage*", []),
    ("distances of a field without the half between", "sim/distance_field.cpp", "root_256(square) - 128", "root_256(square)", "distance_field", "signed*", FIELDS),
    ("levels of a field in texels of level 0", "sim/distance_field.cpp", "count * 256 * (int64_t(1) << level)", "count * 256 * (int64_t(1) << (0 * level))", "distance_field", "levels_hold*", FIELDS),
    ("packs forget the scale of a field", F + "pack.hpp", "return {r.u16(32), r.u16(34), r.u8(36),", "return {r.u16(32), uint16_t(r.u16(34) | 1), r.u8(36),", "distance_field", "packs_hold*", FIELDS),
    # formats
    ("red and blue of rgb888 swapped", F + "texel.hpp", "return {p[0], p[1], p[2], 255};", "return {p[2], p[1], p[0], 255};", "formats", "every_byte*", MAPS),
    ("alpha of la88 lost", F + "texel.hpp", "return {p[0], p[0], p[0], p[1]};", "return {p[0], p[0], p[0], 255};", "formats", "every_byte*", MAPS),
    ("a8 in white", F + "texel.hpp", "return {0, 0, 0, p[0]};", "return {255, 255, 255, p[0]};", "formats", "every_byte*", MAPS),
    ("luminance cut", F + "texel.hpp", "29 * c.b + 128) >> 8)", "29 * c.b) >> 8)", "formats", "luminance*", MAPS),
    ("nibbles of palette4 swapped", F + "texel.hpp", "(x & 1 ? 0 : 4)", "(x & 1 ? 4 : 0)", "formats", "palette4*", MAPS),
    ("indices beyond the palette read on", F + "texture.hpp", "index < palette_count_ ? palette_[index] : rgba8{0, 0, 0, 0}", "palette_[index < palette_count_ ? index : 0]", "formats", "every_texel*", MAPS),
    ("rows of blocks too short", F + "texture.hpp", "(by * blocks_across(width(level)) + bx)", "(by * (width(level) / block_side) + bx)", "formats", "every_texel*", MAPS),
    ("a cell read from the held block alone", F + "loader.hpp", "    if (index != held_) {", "    if (held_ < 0) {", "formats", "the_loader*", MAPS),
    ("a block filtered for its neighbour", F + "loader.hpp", "    if (index != held_) {", "    if (held_ < 0) {", "properties", "pixels_of_every*", []),
    ("a block decoded for each texel", F + "loader.hpp", "      held_ = index;", "      held_ = -1;", "formats", "a_block*", MAPS),
    ("cut cells read across the cut", F + "loader.hpp", "== x[1] / block_side ? 1 : 2;", "== x[1] / block_side ? 2 : 1;", "formats", "a_block*", MAPS),
    ("two thirds rounded", F + "bc.hpp", "uint8_t((2 * x + y) / 3)", "uint8_t((2 * x + y + 1) / 3)", "bc", "random*", MAPS),
    ("three colours never", F + "bc.hpp", "if (three_allowed && c0 <= c1)", "if (three_allowed && c0 < c1)", "bc", "*end_points*", MAPS),
    ("bc2 and bc3 with three colours", F + "bc.hpp", "decode_bc_colours(p + 8, false, out);\n  uint8_t alpha[8]{};", "decode_bc_colours(p + 8, true, out);\n  uint8_t alpha[8]{};", "bc", "random*", MAPS),
    ("alphas of bc3 in six steps", F + "bc.hpp", "a0 > a1 ? 7 : 5", "a0 >= a1 ? 7 : 5", "bc", "*alphas*", MAPS),
    ("second table of ETC's halves for both", F + "etc.hpp", "all.paint[(by_rows ? y : x) / 2]", "all.paint[(by_rows ? x : y) / 2]", "etc", "individual*", MAPS),
    ("signs of differential colours lost", F + "etc.hpp", "(e.field(top - 5, top - 7) ^ 4) - 4", "e.field(top - 5, top - 7)", "etc", "differential*", MAPS),
    ("order of H's colours ignored", F + "etc.hpp", "rgb_number(c1) >= rgb_number(c2) ? 1 : 0", "rgb_number(c1) >= rgb_number(c2) ? 1 : 1", "etc", "h_mode*", MAPS),
    ("planar blocks not rounded", F + "etc.hpp", "4 * o + 2) >> 2", "4 * o) >> 2", "etc", "planar*", MAPS),
    ("alpha of EAC by rows", F + "etc.hpp", "out.texel[4 * (n % 4) + 2 * half + n / 4]", "out.texel[n + 8 * half]", "etc", "eac*", MAPS),
    ("punch-through opaque", F + "etc.hpp", "paint[2] = opaque ? etc_moved(base, -a) : etc_transparent;", "paint[2] = etc_moved(base, -a);", "etc", "punch*", MAPS),
    # packs
    ("payload of a pack not checked", F + "pack.hpp", "if (check == payload_check::crc &&", "if (check != payload_check::crc &&", "pack", "every_flipped*", PACKS),
    ("cut packs opened", F + "pack.hpp", "return r.size < r.u32(8) ? status::pack_truncated : status::ok;", "return status::ok;", "pack", "every_cut*", PACKS),
    ("levels of a pack anywhere", F + "pack.hpp", "if (r.u32(entry) != next ||", "if (r.u32(entry) == next + 1 ||", "pack", "each_kind*", PACKS),
    ("facts of level 0 alone", "sim/pack.cpp", "f.opaque = f.opaque && c.a == 255;", "f.opaque = (k > 0 && f.opaque) || c.a == 255;", "pack", "facts*", PACKS),
    ("coverage not kept down the levels", "sim/pack.cpp", "if (&level != &levels[0]) keep_coverage(", "if (&level == &levels[0]) keep_coverage(", "pack", "levels_keep*", PACKS),
    ("packs that do not say sRGB", F + "pack.hpp", "if ((flags & pack_format::srgb) != 0) out.set_colours(", "if ((flags & pack_format::srgb) == 0) out.set_colours(", "srgb_levels", "packs*", PACKS),
    ("levels of sRGB maps averaged as coded", "sim/prefilter.hpp", "return colours == colour_space::srgb ? srgb_decoded(code) : code;", "return colours == colour_space::srgb ? code * 257 : code;",
     "srgb_levels", "a_level*", PACKS),
    ("alpha-weighted sharpening of sRGB maps by alpha twice", "sim/inverse_filter.cpp", "colours == colour_space::srgb ? (2 * x * alpha + 255) / 510", "colours == colour_space::srgb ? (2 * x * 255 + 255) / 510",
     "srgb_levels", "a_constant*", PACKS),
    # object space
    ("samples nearest, not spread", F + "object_space.hpp", "add(px + 1, py + 1, colour, f * g);", "add(px + 1, py + 1, colour, 0 * f * g);", "object_space", "*tilted_and_grazing*", OBJECT_SPACE),
    ("normal turned the other way", F + "object_grid.hpp", "sin_a = ratio_s1_30(y, length);", "sin_a = -ratio_s1_30(y, length);", "object_space", "the_rotation*", OBJECT_SPACE),
    ("pixels of object space may overflow", F + "object_space.hpp", "if (weight > max_pixel_weight - p.weight) return false;", "if (weight > 2 * max_pixel_weight - p.weight) return false;", "object_space", "a_full*", OBJECT_SPACE),
    ("object space at half the level", F + "object_grid.hpp", "detail::level_term(max_of(logs.x, logs.y) + (1 << 16) - 2 * w_log2)", "detail::level_term(max_of(logs.x, logs.y) - 2 * w_log2)", "object_space", "the_level*", OBJECT_SPACE),
    ("an end of the frame for each block", F + "object_space.hpp", "SPANTEX_TRY(texturing_.flush());", "SPANTEX_TRY(texturing_.finish());", "object_space", "a_frame*", OBJECT_SPACE),
    ("coarser field not in the finer one's texels", F + "contour.hpp", "(c.contour.own_units ? 2 : 1)", "(c.contour.own_units ? 1 : 1)", "contour", "outlines*", []),
    ("alpha decoded", F + "datapath.hpp", "c.linear_light && channel != alpha_channel;", "c.linear_light && channel <= alpha_channel;", "srgb", "light*", []),
    ("linear sums of fewer bits than their weight", F + "datapath.hpp", "return {s.value << (max_linear_sum_bits - s.bits), max_linear_sum_bits};", "return s;", "srgb", "a_constant*", []),
    ("encoding biased by a unit", F + "srgb.hpp", "if (2 * linear >=", "if (2 * linear + 20 >=", "srgb", "encoding*", []),
    ("2^x cut off above 2^10", F + "exp2.hpp", "scale_down(fraction, 10 - whole)", "shift_right(fraction, 10 - whole)", "contour", "powers*", []),
    ("areas rounded without their margin", F + "area.hpp", "(sums[n] + 9) >> detail::swept_bits", "(sums[n] - 9) >> detail::swept_bits", "area", "cells_of*", []),
    ("areas not held within a texel", F + "area.hpp", "clamp_to(next - swept, 0, 2 << (2 * bits))", "next - swept", "area", "polygons_that_cross*", []),
    ("hat a layer too wide", F + "area.hpp", "(2 * m + 1), 4)", "(2 * m + 2), 4)", "area", "weights_of_hat*", []),
    ("thin footprints left empty", F + "area.hpp", ">= 2 * length && length > 0) return;", ">= 0) return;", "area", "thin*", []),
    ("sections without the corners of footprints", F + "plan.hpp", "const auto far = int8_t(area_margin(c.kind)),", "const auto far = int8_t(0),", "plan", "spans_equal*power*", []),
    ("every tile of a footprint the first", F + "area.hpp", "column = part.first_sample % across * side,", "column = 0,", "footprint_properties", "footprints_equal*", []),
    # filters with a footprint
    ("proofs: doubled angle", F + "footprint.hpp", "twice = 2 * (ux * uy + vx * vy);", "twice = ux * uy + vx * vy;", "scripts", "footprint_proofs", []),
    ("proofs: zero components of a long axis", F + "footprint.hpp", "    if (x == 0) return int32_t(0);\n", "", "scripts", "footprint_proofs", []),
    ("proofs: axis divided by w once", F + "footprint.hpp", "for (int k = 0; k < 2; ++k) x =", "for (int k = 0; k < 1; ++k) x =", "scripts", "footprint_proofs", []),
    ("proofs: more samples than sums hold", F + "footprint.hpp", "max_footprint_samples = 16;", "max_footprint_samples = 32;", "scripts", "footprint_proofs", []),
    ("proofs: swept areas", F + "area.hpp", "return scaled(above - d * top) + corner;", "return scaled(above - d * top) - corner;", "scripts", "footprint_proofs", []),
    ("proofs: 2^x without its last knot", F + "exp2.hpp", "if (k == 64) return 1u << 17;", "if (k == 64) return 1u << 16;", "scripts", "footprint_proofs", []),
    ("proofs: distances by the coarser field alone", F + "contour.hpp", "return a * (one - int32_t(fraction)) + b * int32_t(fraction);", "return a * one + b * int32_t(fraction);",
     "scripts", "footprint_proofs", []),
    ("samples off their middle", F + "footprint.hpp", "(2 * k + 1 - n) * step", "(2 * k + 2 - n) * step", "footprint", "samples_are*", [*MAPS, "sim/reference.cpp"]),
    ("samples' bias from level 0 on", F + "level.hpp", "max_of(level_16 + bias * (1 << 12), min_of(level_16, -5 * bias * (1 << 9)))", "level_16 + bias * (1 << 12)", "footprint", "footprints_are*", [*MAPS, "sim/reference.cpp"]),
    ("mip bias from level 0 on", F + "level.hpp", "max_of(level_16 + bias * (1 << 12), min_of(level_16, -5 * bias * (1 << 9)))", "level_16 + bias * (1 << 12)", "level", "the_mip_bias*", []),
    ("no mip bias", F + "level.hpp", "finer(unbiased_level(prof, c, i, j), q.mip_bias)", "unbiased_level(prof, c, i, j)", "level", "the_mip_bias*", []),
    ("squares weighted alike", F + "footprint.hpp", "row_weight = aside + 3 - distance;", "row_weight = aside + 3;", "footprint", "squares_have*", [*MAPS, "sim/reference.cpp"]),
    ("means rounded down", F + "filter.hpp", "return uint16_t(whole + (up ? 1 : 0));", "return uint16_t(whole + 0 * up);", "footprint_properties", "pixels_are*", []),
    ("means biased at ties and beyond", F + "filter.hpp", "rest >= weight - rest :", "rest + weight / 16 >= weight - rest :", "footprint", "a_mean_is*", [*MAPS, "sim/reference.cpp"]),
    ("means' ties to odd", F + "filter.hpp", "rest + (whole & 1) > weight - rest", "rest + (~whole & 1) > weight - rest", "footprint", "a_mean_is*", [*MAPS, "sim/reference.cpp"]),
    ("means of a footprint biased", F + "filter.hpp", "rest + (whole & 1) > weight - rest", "rest + weight / 16 > weight - rest", "footprint_properties", "pixels_are*", []),
    ("footprints out of range half as wide", F + "area.hpp", "int32_t(1) << (10 + c.exponent)", "int32_t(1) << (9 + c.exponent)", "footprint_properties", "footprints_at*", []),
    ("footprints at the horizon clipped along one axis", F + "area.hpp", "clipped.a_u = halved(r.a_u);", "clipped.a_u = r.a_u;", "footprint_properties", "footprints_at*", []),
    ("a sample left out", F + "datapath.hpp", "k < min_of(c.axis.last_sample, f.samples); ++k)", "k < min_of(c.axis.last_sample, max_of(1, f.samples - 1)); ++k)",
     "footprint_properties", "pixels_are*", []),
    ("areas of hat halved upwards", F + "area.hpp", "weight[n] = shift_right(weight[n], 1);", "weight[n] = (weight[n] >> 1) + 8;", *STRESS),
    ("columns without their perspective", F + "footprint.hpp", "return {c.a_u - slope(c.c_u, c.g), c.b_u - slope(c.c_u, c.h),", "return {c.a_u, c.b_u,", *STRESS),
    ("contours by the nearest twelfth bit down", F + "contour.hpp", "const int64_t distance = scale_down(product, detail::field_bits + level_bits - int(log2 >> 16));",
     "const int64_t distance = scale_down(product, detail::field_bits + level_bits - int(log2 >> 16)) * 63 / 64;", *STRESS),
    ("rows with half their samples", F + "footprint.hpp", "return {level, clamp_to(int(samples), 1, q.max_samples)};", "return {level, clamp_to(int(samples) / 2, 1, q.max_samples)};",
     "conformance", "aniso_of_exact*", ["sim/verifier.cpp"]),
    ("floors that hide what is in front", F + "visibility.hpp", "range.most <= *floor", "range.least <= *floor", "visibility", "floors*", []),
    ("floors above what is stored", F + "visibility.hpp", "*floor = range.least;", "*floor = range.most;", "visibility", "no_pixel*", []),
    ("one colour taken from the first texel", F + "shortcuts.hpp", "return texel == colour; });", "return texel.a == colour.a; });", "skips", "what_is_nearly*", []),
    ("copies a quarter of a texel aside", F + "shortcuts.hpp", "const int32_t most = (1 << (15 - q.subtexel_bits)) - (1 << (16 - q.coordinate_bits));", "const int32_t most = 1 << 14;", "skips", "whole_steps*", []),
    ("copies where the section is clamped", F + "shortcuts.hpp", "c.two_levels || c.corrects || ", "c.two_levels || ", "skips", "a_clamped*", []),
    ("transparent by the texels of one level", F + "draw.hpp", "below(c.fine.level, job.fine) && (!c.two_levels || below(c.coarse.level, job.coarse))",
     "below(c.fine.level, job.fine)", "skips", "texels_that_are_seen*", []),
    ("transparent though the alpha reaches the threshold", F + "shortcuts.hpp", "return texel.a < limit; });", "return texel.a <= limit; });", "skips", "texels_that_are_seen*", []),
    ("fills before what is still computed there", F + "draw.hpp", "if ((pixels_of(job) & mask) != 0 && job.sx == sx && job.sy == sy) {", "if ((pixels_of(job) & mask) != 0 && job.sx == sx + 1) {", "skips",
     "no_skip*default", []),
    ("the other half's section out of turn", F + "draw.hpp", "SPANTEX_TRY(drain());\n    next_ = other(next_);", "next_ = other(next_);", "skips", "no_skip*default", []),
    ("one colour on the finer level alone", F + "draw.hpp", "job.coarse, true, coarse) && coarse == colour)", "job.coarse, true, coarse))", "skips", "what_is_nearly*", []),
    ("constant jobs of maps one texel wide", F + "shortcuts.hpp", "c.fine.one_u && c.fine.one_v && !c.two_levels;", "c.fine.one_u || c.fine.one_v;", "skips", "what_is_nearly*", []),
    ("depth of a blended surface without alpha stored", F + "shade.hpp", "return cut_out;", "return true;", "skips", "no_skip*default", []),
    ("alpha of colours forgotten", F + "shade.hpp", "(modulates && colours.flat.a != 255)", "false", "skips", "what_is_nearly*", []),
    ("polygons outside one pixel too early", F + "polygon.hpp", "left = left && p.x < clip.x0 * p.z;", "left = left && p.x < (clip.x0 + 20) * p.z;", "skips", "a_polygon*", []),
    ("uniform sections loaded all the same", F + "draw.hpp", "if (skips_.on(one_texel ? skip::one_texel : skip::uniform) &&", "if (skips_.on(skip::one_texel) && one_texel &&", "skips", "texels_that*", []),
    ("spans kept though an edge is another", "sim/unchanged.cpp", "a.shape == b.shape && ", "", "unchanged", "each_coefficient*", OBJECT_SPACE),
    ("spans kept though the map has other texels", "sim/unchanged.cpp", "(a.serial() == b.serial() || same_texels(a, b))", "true", "unchanged", "maps_count*", OBJECT_SPACE),
    ("spans kept though texels in place are others", "sim/unchanged.cpp", "a.serial() == serials_[before] && ", "", "unchanged", "maps_count*", OBJECT_SPACE),
    ("spans kept though the background is another", "sim/unchanged.cpp", "a.background == b.background;", "true;", "unchanged", "write_out*", OBJECT_SPACE),
    ("spans kept though they are blended now", "sim/unchanged.cpp", "a.how.alpha == b.how.alpha && ", "", "unchanged", "write_out*", OBJECT_SPACE),
    ("spans kept where something went away", "sim/unchanged.cpp", "if (!common.before[k]) mark(scene_.items[k]);", "if (!common.before[k] && k > scene_.items.size()) mark(scene_.items[k]);", "unchanged",
     "a_moving_object*", OBJECT_SPACE),
    ("spans kept though surfaces change places", "sim/unchanged.cpp", "if (at != ends.begin()) previous[size_t(k)] = at[-1];", "if (k > 0) previous[size_t(k)] = k - 1;", "unchanged", "random*", OBJECT_SPACE),
    ("what lies in a surface taken for hidden", "sim/unchanged.cpp", ">= depth_.values", "> depth_.values", "unchanged", "what_moves*", OBJECT_SPACE),
    ("kept spans cleared", "sim/draw_host.cpp", "if (out.kept[span] != 0) continue;", "", "unchanged", "a_still*", OBJECT_SPACE),
    ("kept spans drawn again", "hal/kernels/rows.hpp", "if (scalar.keeps(first + k, sy)) {", "if (scalar.keeps(first + k, sy) && first < 0) {", "unchanged", "a_still*", OBJECT_SPACE),
    ("a kernel's surface under what is still computed", "sim/draw_host.cpp", "if (by_kernel) SPANTEX_TRY(renderer.flush());", "", "unchanged", "random*", OBJECT_SPACE),
    ("all levels made with the first", "sim/map.cpp", "w.asked |= 1u << level;", "w.asked |= (1u << level_count()) - 1;", "levels_on_demand", "levels_are*", OBJECT_SPACE),
    ("a level read before it is made", F + "draw.hpp", "reads_.touch(level);", "reads_.touch(0);", "levels_on_demand", "levels_are*", OBJECT_SPACE),
    ("blocks decoded and not counted", F + "global_reads.hpp", "    ++blocks_;\n", "", "levels_on_demand", "blocks_are*", OBJECT_SPACE),
    ("a block decoded beside the section", F + "loader.hpp", "      map_.decode_block(level_, x / block_side, y / block_side, block_);",
     "      map_.decode_block(level_, 0, 0, block_);\n      map_.decode_block(level_, x / block_side, y / block_side, block_);", "levels_on_demand", "blocks_are*", OBJECT_SPACE),
    ("a skip without its switch", F + "draw.hpp", "if (skips_.on(skip::held) && holds(h,", "if (holds(h,", "skips", "what_is*", []),
    ("depth test reversed", F + "visibility.hpp", "if (z <= stored) return false;", "if (z > stored) return false;", "polygon", "the_nearer*", []),
    ("farthest first", "sim/scene.cpp", "std::sort(order.begin(), order.end());", "std::sort(order.rbegin(), order.rend());", "quake_level", "eight_layers*", LEVELS),
    ("a level's vertices believed", "sim/level.cpp", "if (index >= count) throw damaged(k);", "if (index >= count) continue;", "quake_level", "damaged*", LEVELS),
    ("walls that do not stop a walk", "sim/tour.cpp", "u + v <= 1 && t >= 0 && t <= 1", "u + v <= 1 && t >= 0 && t <= 0", "quake_level", "a_walk*", LEVELS),
]

# Where the processor has what the kernel takes.
if "avx512_vbmi" in pathlib.Path("/proc/cpuinfo").read_text():
    GATES += [
        ("AVX-512: levels that are no halves taken for such", "hal/kernels/avx512/levels.hpp", "set32(last)) != 0;", "set32(last)) > 0xFFFF;", "kernels", "levels_that*", KERNELS),
        ("AVX-512: the last level that is a half taken for the next", "hal/kernels/avx512/levels.hpp", "exact_count() - 1) * (1", "exact_count() - 0) * (1", "kernels", "levels_that*", KERNELS),
        ("AVX-512: axes that do halve exactly scaled twice", "hal/kernels/avx512/by_level.hpp", "_mm512_cmpeq_epi32_mask(ratio, of32<1 << 30>())", "_mm512_cmpneq_epi32_mask(ratio, of32<1 << 30>())", "kernels", "levels_that*", KERNELS),
        ("AVX-512: scaled positions rounded down", "hal/kernels/avx512/by_level.hpp", "put(s.from, _mm512_castsi512_si256(_mm512_add_epi32(from, half)));", "put(s.from, _mm512_castsi512_si256(from));", "kernels", "levels_that*", KERNELS),
        ("AVX-512: rows on several scaled levels on one", "hal/kernels/avx512/aniso.hpp", "set32(s.first_level[n])) != 0) return false;\n  const colouring", "set32(s.first_level[n])) > 0xFFFF) return false;\n  const colouring", "kernels", "minified*", KERNELS),
        ("AVX-512: quads on two levels take from one", "hal/kernels/avx512/by_level.hpp", "fine[m] = _mm512_mask_mov_epi32(fine[m], second, coarse[m]);", "(void)second;", "kernels", "random_planes*", KERNELS),
        ("AVX-512: spans magnified that are not", "hal/kernels/avx512/columns.hpp", "_mm512_sub_epi64(s.exponent, set(2))", "_mm512_sub_epi64(s.exponent, set(1))", "kernels", "random_planes*", KERNELS),
        ("AVX-512: spread quads from their section", "hal/kernels/avx512/by_level.hpp", "s.fit = s.fine.fit;", "s.fit = 0xF;", "kernels", "random_planes*", KERNELS),
        ("AVX-512: sections of nine columns", "hal/kernels/avx512/sections.hpp", "of32<block_side - 1>()", "of32<block_side>()", "kernels", "random_planes*", KERNELS),
        ("AVX-512: scaled planes in windows that are too narrow", "hal/kernels/avx512/upright.hpp", "if (last >= window) {", "if (last > window) {", "kernels", "scaled_planes*", KERNELS),
        ("AVX-512: scaled planes wider than two windows", "hal/kernels/avx512/upright.hpp", "if (last >= 2 * window) return false;", "if (last > 2 * window) return false;", "kernels", "scaled_planes*", KERNELS),
        ("AVX-512: pairs of spans from the row's first", "hal/kernels/avx512/upright.hpp", "span[before % 2 + k] = work.masks[k];", "span[k] = work.masks[k];", "kernels", "scaled_polygons*", KERNELS),
        ("AVX-512: parts of pairs written whole", "hal/kernels/avx512/upright.hpp", "while (end < masks.end && masks.all(end)) ++end;", "while (end < masks.end && !masks.none(end)) ++end;", "kernels", "scaled_polygons*", KERNELS),
        ("AVX-512: the row above taken for the one below", "hal/kernels/avx512/upright.hpp", "if (rows.lower[j] == before.from) below = before;", "if (rows.lower[j] == before.from) below = above;", "kernels", "scaled_planes*", KERNELS),
        ("AVX-512: levels of scaled planes in 256ths", "hal/kernels/avx512/upright.hpp", "set32(row.fraction << 17 | (512 - 2 * row.fraction))", "set32(row.fraction << 16 | (512 - row.fraction))", "kernels", "scaled_planes*", KERNELS),
        ("AVX-512: a scaled level rounded once", "hal/kernels/avx512/upright.hpp", "return as.on_one_level(x);", "return as.even(_mm512_add_epi32(_mm512_slli_epi32(x, 1), as.half));", "kernels", "scaled_planes*", KERNELS),
        ("AVX-512: two samples taken for one", "hal/kernels/avx512/aniso.hpp", ">= samples ? as_many : fewer)", ">= samples + 1 ? as_many : fewer)", "kernels", "random_planes*", KERNELS),
        ("AVX-512: third samples on the first", "hal/kernels/avx512/aniso.hpp", "max_of(n - 1 - 2 * k, 0)", "max_of(n - 1, 0)", "kernels", "random_planes*", KERNELS),
        ("AVX-512: rows' sections without their ends", "hal/kernels/avx512/aniso.hpp", "_mm512_mask_add_epi32(_mm512_sub_epi32(middle, aside), 0xFF00, middle, aside)", "middle", "kernels", "random_planes*", KERNELS),
        ("AVX-512: every sample of a spread quad counted", "hal/kernels/avx512/aniso.hpp", "_mm512_maskz_mov_epi32(lanes, weights)", "weights", "kernels", "random_planes*", KERNELS),
        ("AVX-512: means' halves up", "hal/kernels/avx512/aniso.hpp", "_mm512_mask_andnot_epi32(whole, tie,", "_mm512_mask_andnot_epi32(whole, 0 * tie,", "kernels", "random_planes*", KERNELS),
        ("AVX-512: directions turned by one", "hal/kernels/avx512/columns.hpp", "_mm512_movepi64_mask(across), of64<16>()", "_mm512_movepi64_mask(across), of64<17>()", "kernels", "random_planes*", KERNELS),
        ("AVX-512: split quads from their first blocks", "hal/kernels/avx512/aniso.hpp", "fine[m] = _mm512_mask_mov_epi32(fine[m], later, coarse[m]);", "(void)later;", "kernels", "ordinary_planes*", KERNELS),
        ("AVX-512: rows on two levels from one", "hal/kernels/avx512/aniso.hpp", "for (int n = 0; s.crossing && n < quads; ++n)", "for (int n = quads; n < quads; ++n)", "kernels", "minified_planes*", KERNELS),
        ("AVX-512: bases up to the end of the range", "hal/kernels/avx512/lanes.hpp", " - max_texture_side / 4;", ";", "kernels", "samples_next*", KERNELS),
        ("AVX-512: areas not rounded", "hal/kernels/avx512/columns.hpp", "keep(b.area_log2, level_term16(level));", "keep(b.area_log2, level);", "kernels", "random_planes*", KERNELS),
        ("AVX-512: halves always up", "hal/kernels/avx512/filters.hpp", "_mm512_and_si512(x, one), one); }", "one, one); }", "kernels", "random_planes*", KERNELS),
    ]

FLAGS = ["-std=c++20", "-O1", "-I.", "-Ifirmware", "-pthread"]
LINK = ["-lcmocka", "-Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc"]


def test_of(tree, folder, gate):
    """Build and command of the test that must notice. Of the proofs, what ties them to the code: the proofs themselves do not read it."""
    suite, case, sources = gate[4:]
    if suite == "scripts":
        return None, ["/usr/bin/python3", str(tree / f"tests/scripts/{case}.py"), "--links"]
    if suite in ("packaging", "licence_headers"):
        return None, ["/usr/bin/python3", str(tree / f"tests/scripts/{suite}.py"), case]
    program = folder / "program"
    return [os.environ.get("CXX", "g++"), *FLAGS, f"tests/unit/{suite}.cpp", *sources, "-o", str(program), *LINK, *LIBRARIES.get(suite, [])], [str(program)]


def outcome(tree, gate, unbroken=False):
    """None if the test fails, or with `unbroken` if it passes; else why not."""
    _, command = test_of(tree, tree, gate)
    try:
        ran = subprocess.run(command, env=dict(os.environ, SPANTEX_TEST_FILTER=gate[5], SPANTEX_SHORT="1"), capture_output=True, text=True, errors="replace", timeout=300)
    except subprocess.TimeoutExpired:
        return "no verdict within 300 s"
    said = ran.stdout + ran.stderr
    if "Running 0 test" in said:
        return f"{gate[4]} has no case {gate[5]}"
    if unbroken:
        return None if ran.returncode == 0 else f"{gate[4]}.{gate[5]} fails before anything is broken"
    if gate[4] == "scripts" and not re.search("inputs: not as proved|DOES NOT HOLD|static assertion failed|[1-9][0-9]* differ", said):
        return "no verdict:\n" + said[-2000:]
    if gate[4] == "packaging" and f"packaging: {gate[5]}: " not in said:
        return "no verdict:\n" + said[-2000:]
    return None if ran.returncode != 0 else f"{gate[4]}.{gate[5]} did not notice"


def build_of(tree, gate):
    """What the compiler says if the gate's suite does not build."""
    build, _ = test_of(tree, tree, gate)
    built = build and subprocess.run(build, cwd=tree, capture_output=True, text=True)
    return built.stderr if built and built.returncode != 0 else None


def bites(trees, gate):
    """Breaks the gate's line in a tree that nobody else uses now. None if its test notices, else why not."""
    tree = trees.get()
    _, name, old, new = gate[:4]
    path = tree / name
    text = path.read_text()
    try:
        path.write_text(text.replace(old, new))
        refused = build_of(tree, gate)
        if refused is not None:  # a static_assert that refuses is a check that bites
            return None if "static assertion failed" in refused else "does not build:\n" + refused[-2000:]
        return outcome(tree, gate)
    finally:
        path.write_text(text)
        trees.put(tree)


def baseline(trees, gates):
    """Why the tests of a suite's gates cannot be trusted, by case: each must pass in an unbroken tree, built once for all of them."""
    tree = trees.get()
    try:
        refused = build_of(tree, gates[0])
        if refused is not None:
            return {g[5]: "does not build unbroken:\n" + refused[-2000:] for g in gates}
        return {case: outcome(tree, next(g for g in gates if g[5] == case), unbroken=True) for case in {g[5] for g in gates}}
    finally:
        trees.put(tree)


def main():
    if "--list" in sys.argv:
        print("\n".join(f"{g[0]}: {g[4]}.{g[5]}" for g in GATES))
        return 0
    short = "--short" in sys.argv
    wanted = [a for a in sys.argv[1:] if a != "--short"] or ["*"]
    gates = [g for g in GATES if any(fnmatch.fnmatch(g[0], w) for w in wanted)]
    if short:
        gates = list({g[5] if g[4] == "scripts" else g[4]: g for g in reversed(gates)}.values())[::-1]
    if not gates:
        print(f"no gate is called {' '.join(wanted)}")
        return 2
    stale = [g for g in GATES if (ROOT / g[1]).read_text().count(g[2]) != 1]
    for g in stale:
        print(f"STALE   {g[0]}: {g[1]}: the line to break stands there {(ROOT / g[1]).read_text().count(g[2])} times")
    if stale:
        return 1
    silent, trees = 0, queue.Queue()
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for k in range(os.cpu_count()):
            tree = pathlib.Path(folder) / str(k)
            for part in ("docs", "firmware", "hal", "sim", "tests", "tools", "zephyr"):
                shutil.copytree(ROOT / part, tree / part)
            for path in ROOT.iterdir():
                if path.is_file() and path.name != ".git":
                    shutil.copy(path, tree)
            trees.put(tree)
        suites = {}
        for g in gates:
            suites.setdefault((g[4], tuple(g[6])), []).append(g)
        faults = {} if short else dict(zip(suites, pool.map(lambda named: baseline(trees, named), suites.values())))
        for (suite, _), cases in faults.items():
            for case, fault in cases.items():
                if fault:
                    print(f"BROKEN  {suite}.{case}: {fault}", flush=True)
        sound = [g for g in gates if short or not faults[g[4], tuple(g[6])][g[5]]]
        silent += len(gates) - len(sound)
        for gate, reason in zip(sound, pool.map(lambda g: bites(trees, g), sound)):
            silent += reason is not None
            print(f"{'bites ' if reason is None else 'SILENT'}  {gate[0]}: {gate[4]}.{gate[5]}{'' if reason is None else ': ' + reason}", flush=True)
    print(f"{len(gates) - silent} of {len(gates)} gates bite")
    return 1 if silent else 0


if __name__ == "__main__":
    sys.exit(main())
