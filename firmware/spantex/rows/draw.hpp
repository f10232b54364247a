// SPDX-License-Identifier: Apache-2.0
// Drawing by rows: planes and polygons from an RGB565 map in directly addressed memory to rows of RGB565. For cores without an engine beside them:
// nothing is copied, coordinates are those of block.hpp (docs/SPEC.md "Rows"). The engine's profiles (draw.hpp) are more exact and know more.
//
//   target    where rows go: `texel565* row(x, y, count)` gives memory for that many pixels, at most 32; `void done(x, y, count)` ends them: every one has
//             been written. Rows arrive block by block, within `width` and `height` or, where a target has it, within `rectangle area()`. frame565 is a
//             frame buffer; targets.hpp has other formats, parts of frames, blending, displays without a frame buffer.
//   filter    nearest, three_point, bilinear: level 0; mip_bilinear, trilinear: maps whose sides halve exactly, or are 1.
#pragma once
#include <stdint.h>

#include <spantex/coverage.hpp>
#include <spantex/plane.hpp>
#include <spantex/polygon.hpp>
#include <spantex/rows/block.hpp>
#include <spantex/rows/run.hpp>
#include <spantex/status.hpp>
#include <spantex/texture.hpp>

namespace spantex::rows {

// A frame buffer of RGB565, rows of `stride` pixels, caller's memory.
struct frame565 {
  texel565* pixels;
  int32_t width, height, stride;

  texel565* row(int32_t x, int32_t y, int32_t) const { return pixels + (y * stride + x); }
  void done(int32_t, int32_t, int32_t) const {}
};

// Whether a target's rows lie `stride` pixels apart and need no end: their addresses are not asked for one by one then.
template <class Target> inline constexpr bool rows_follow_each_other = false;
template <> inline constexpr bool rows_follow_each_other<frame565> = true;

// Pixels that a target takes.
template <class Target>
constexpr rectangle area_of(const Target& target) {
  if constexpr (requires { target.area(); }) return target.area();
  else return {0, 0, target.width, target.height};
}

// The screen that they are part of: what is set up for it (pictures.hpp) is the same for every part.
template <class Target>
constexpr rectangle screen_of(const Target& target) {
  if constexpr (requires { target.screen(); }) return target.screen();
  else return area_of(target);
}

constexpr bool is_supported(filter kind) {
  return kind == filter::nearest || kind == filter::three_point || kind == filter::bilinear || kind == filter::mip_bilinear || kind == filter::trilinear;
}

namespace detail {

inline constexpr int largest_side = 1 << largest_block_log2;

// Columns [from, to) of a row, bit i for column i.
constexpr uint32_t columns(int32_t from, int32_t to) { return (to >= 32 ? 0xFFFFFFFFu : (1u << to) - 1) & ~((1u << from) - 1); }

// By reference or as a copy.
template <class T, bool ByReference> struct kept { using type = const T; };
template <class T> struct kept<T, true> { using type = const T&; };

// Rectangles: the same columns in every row.
struct rectangle_cover {
  static constexpr bool whole_rows = true;
  constexpr bool prepare(uint32_t*, int32_t, int32_t, int, int) const { return true; }
  constexpr uint32_t row(const uint32_t*, int) const { return 0xFFFFFFFFu; }
};

// Polygons: the masks of the spans that a block consists of, or lies in.
struct polygon_cover {
  static constexpr bool whole_rows = false;
  const edge_set* edges;

  SPANTEX_FRAME_APART constexpr bool prepare(uint32_t* rows, int32_t x0, int32_t y0, int k, int n) const {  // rows: [largest_side]
    bool whole = true;
    for (int i = 0; i < edges->count; ++i) {
      const edge_range range = range_of(edges->edges[i], x0, y0, 1 << k, 1 << n);
      if (range.high < 0) return false;
      whole = whole && range.low >= 0;
    }
    if (whole) {
      for (int j = 0; j < 1 << n; ++j) rows[j] = 0xFFFFFFFFu;
      return true;
    }
    const int columns_each = min_of(1 << k, span_side), rows_each = min_of(1 << n, span_side);
    uint32_t any = 0;
    for (int y = 0; y < 1 << n; y += rows_each) {
      for (int j = 0; j < rows_each; ++j) rows[y + j] = 0;
      for (int x = 0; x < 1 << k; x += columns_each) {
        const span_mask mask = coverage(*edges, (x0 + x) >> 3, (y0 + y) >> 3);
        for (int j = 0; j < rows_each; ++j) {
          const uint32_t bits = uint32_t(mask >> (span_side * ((y0 & 7) + j)) & 0xFF) >> (x0 & 7) & columns(0, columns_each);
          rows[y + j] |= bits << x;
          any |= bits;
        }
      }
    }
    return any != 0;
  }
  constexpr uint32_t row(const uint32_t* rows, int j) const { return rows[j]; }
};

}  // namespace detail

// What is known of a map when the program is compiled. A map that repeats, with sides that are powers of two, needs the least code (nearest only).
enum class map_kind : uint8_t { any, repeats_in_powers_of_two };

inline namespace SPANTEX_ROWS_KERNELS {

// `Small`: less stack for more instructions; part of the type, as programs may be compiled for size in part.
template <filter Kind, class Target, class Cover, map_kind Map = map_kind::any, bool Small = optimised_for_size>
class painter {
 public:
  // What the target takes of `wanted`.
  painter(const plane& p, const texture_view& t, const Target& target, const rectangle& wanted, const Cover& cover, state& memory)
      : plane_(p), map_(t), target_(target), memory_(memory), area_(memory.area = intersection(wanted, area_of(target))), cover_(cover) {}

  SPANTEX_FRAME_MERGED void draw() {
    if (area_.empty()) return;
    const int32_t width_log2 = has_straight_rows(plane_) ? widest_block_log2 : largest_block_log2, width = 1 << width_log2, height = detail::largest_side;
    for (int32_t y = area_.y0 & -height; y < area_.y1; y += height)
      for (int32_t x = area_.x0 & -width; x < area_.x1; x += width) draw_largest(x, y, width_log2);
  }

 private:
  // A block as large as they come: halves, one after the other, of what cannot be drawn.
  void draw_largest(int32_t x, int32_t y, int k) {
    int n = largest_block_log2;
    uint32_t path = 1;  // the halvings that lead here, two bits each, the last one lowest: 1 if this is the second half, 2 if it is one of upper and lower
    while (path != 0) {
      const outcome next = draw_block(x, y, k, n);
      if (next == outcome::upper_and_lower) { path = path << 2 | 2; --n; continue; }
      if (next == outcome::left_and_right) { path <<= 2; --k; continue; }
      for (; (path & 1) != 0; path >>= 2) {
        if ((path & 2) != 0) y -= 1 << n++;
        else x -= 1 << k++;
      }
      if (path == 0) return;
      path |= 1;
      if ((path & 2) != 0) y += 1 << n;
      else x += 1 << k;
    }
  }

  SPANTEX_FRAME_MERGED outcome draw_block(int32_t x0, int32_t y0, int k, int n) {
    const int32_t left = max_of(area_.x0 - x0, 0), right = min_of(area_.x1 - x0, 1 << k);
    const int32_t top = max_of(area_.y0 - y0, 0), bottom = min_of(area_.y1 - y0, 1 << n);
    if (left >= right || top >= bottom || (k <= largest_block_log2 && !cover_.prepare(memory_.masks, x0, y0, k, n))) return outcome::behind;
    // Inlined where code is to be least; else its frame is not to lie under the kernels'.
    constexpr auto at = Map == map_kind::repeats_in_powers_of_two ? block_at<false> : block_at_apart<uses_levels(Kind)>;
    const outcome found = at(plane_, x0, y0, k, n, {map_.last_level(), 0}, memory_.about, memory_.coordinates);
    if (found == outcome::drawn) draw_strips(x0, y0, left, right, top, bottom);
    return found;
  }

  using block_part = detail::block_part;
  SPANTEX_FRAME_MERGED void draw_strips(int32_t x0, int32_t y0, int32_t left, int32_t right, int32_t top, int32_t bottom) {
    block& b = memory_.coordinates;
    const auto end_of = [](int32_t at, int32_t multiple, int32_t end) { return min_of((at | (multiple - 1)) + 1, end); };
    block_part& part = memory_.part;
    part = {x0, y0, 0, 0, int8_t(top), 0, 0, false};
    for (; part.top < bottom; part.top = part.bottom) {
      part.left = int16_t(left);
      part.right = int16_t(right);
      part.bottom = int8_t(end_of(part.top, b.straight ? detail::wide_strip_rows : detail::strip_rows, bottom));
      if constexpr (uses_levels(Kind)) {
        if (!find_levels(b, part)) {
          draw_by_rows(b, part);
          continue;
        }
      }
      begin_rows(b, part);
      for (;;) {
        part.right = int16_t(end_of(part.left, detail::largest_side, right));
        if (b.k <= largest_block_log2 || prepare_part(part)) draw_part(b, part);
        if (part.right == right) break;
        step_rows(part);
        part.left = part.right;
      }
    }
  }
  // Rows wider than a part are straight.
  SPANTEX_FRAME_APART SPANTEX_WRAPS void step_rows(const block_part& part) {
    walk* w = &memory_.rows[detail::row_in_strip(part.top)];
    for (int n = part.bottom - part.top; n > 0; --n, ++w) {
      w->u += (part.right - part.left) * w->du;
      w->v += (part.right - part.left) * w->dv;
    }
  }
  bool prepare_part(const block_part& part) {
    const int32_t x = part.left & -detail::largest_side, y = part.top & -detail::wide_strip_rows;
    return cover_.prepare(memory_.masks + y, part.x0 + x, part.y0 + y, largest_block_log2, min_of(memory_.coordinates.n, 3));  // 8 rows or less
  }
  // Sets the levels of a strip, shortened to rows that lie on the same. False if even those along a row differ.
  SPANTEX_FRAME_APART bool find_levels(const block& b, block_part& part) {
    const int last_level = map_.last_level();
    detail::interval levels{};
    for (;;) {
      levels = detail::levels_of(b, part.top, part.bottom, detail::level_rounding(Kind), last_level);
      if (levels.low == levels.high) break;
      if (!b.straight) return false;
      part.bottom = int8_t((part.top + part.bottom) / 2);
    }
    part.level = int8_t(max_of(levels.low, 0));
    part.two = Kind == filter::trilinear && levels.low >= 0 && levels.low < last_level;
    return true;
  }
  // Positions of the part's rows on a level from its left; where the kernels read.
  SPANTEX_FRAME_APART void begin_rows(block& b, const block_part& part) {
    const int level = part.level;
    if constexpr (Map == map_kind::repeats_in_powers_of_two) {
      b.u.offset = wrapped_base(b.u.base, map_.width()) << 16;
      b.v.offset = wrapped_base(b.v.base, map_.height()) << 16;
    } else {
      detail::set_offsets(b, level, Kind == filter::nearest ? 0 : snap);
      set_level_view(map_, level, memory_.fine);
      memory_.at.base_u = detail::base_on(level, b.u.base);
      memory_.at.base_v = detail::base_on(level, b.v.base);
    }
    detail::make_rows(b, part.top, part.bottom, memory_.rows);
    const int down = uses_levels(Kind) ? level - b.unit_log2 : 0;
    if (down == 0 && part.left == 0) return;
    for (int j = part.top; j < part.bottom; ++j) {
      walk& w = memory_.rows[detail::row_in_strip(j)];
      if (uses_levels(Kind) && down != 0) w = detail::scaled(w, down);
      detail::go_on(w, part.left);
    }
  }
  static constexpr int32_t wrapped_base(int32_t base, int32_t size) { return base & (size - 1); }

  static constexpr bool plain_rows = !Small && Cover::whole_rows && rows_follow_each_other<Target>;

  // A copy is not read again row by row, or block by block, but costs stack.
  using part_of_rows = typename detail::kept<block_part, Small>::type;
  using kept_source = typename detail::kept<source, Small>::type;
  using area_of_blocks = typename detail::kept<rectangle, Small>::type;
  template <class Row>
  [[gnu::always_inline]] void each_row(part_of_rows part, const Row& draw_row) {
    const int32_t column = part.left & -detail::largest_side;
    const uint32_t wanted = detail::columns(part.left - column, part.right - column);
    for (int32_t j = part.top; j < part.bottom; ++j) {
      int first = part.left, count = part.right - part.left;
      if constexpr (!Cover::whole_rows) {
        const uint32_t mask = cover_.row(memory_.masks, j) & wanted;
        if (mask == 0) continue;
        const int skipped = __builtin_ctz(mask);
        first = column + skipped;
        count = 32 - __builtin_clz(mask) - skipped;
      }
      draw_row(target_.row(part.x0 + first, part.y0 + j, count), first, count, j);
      target_.done(part.x0 + first, part.y0 + j, count);
    }
  }

  // With walks from pixel `first`.
  template <class Row>
  [[gnu::always_inline]] void each_walk(const block_part& part, const Row& draw_row) {
    if constexpr (plain_rows) {
      const int first = part.left, count = part.right - first;
      int j = part.top;
      each_row_of(list_of(part), [&](texel565* out, const walk& w) __attribute__((always_inline)) { draw_row(out, first, count, j++, w); });
    } else {
      each_walk_of(part, draw_row);
    }
  }
  template <class Row>
  [[gnu::always_inline]] void each_walk_of(part_of_rows part, const Row& draw_row) {
    const walk* const top = &memory_.rows[detail::row_in_strip(part.top)];
    each_row(part, [&](texel565* out, int first, int count, int j) {
      const walk* w = Small ? &memory_.rows[detail::row_in_strip(j)] : top + (j - part.top);
      if (!Cover::whole_rows && first != part.left) {
        copy(*w, memory_.at.at);
        detail::go_on(memory_.at.at, first - part.left);
        w = &memory_.at.at;
      }
      draw_row(out, first, count, j, *w);
    });
  }

  [[gnu::always_inline]] row_list list_of(const block_part& part) const {
    const walk* const top = &memory_.rows[detail::row_in_strip(part.top)];
    return {target_.row(part.x0 + part.left, part.y0 + part.top, part.right - part.left), target_.stride, top, top + (part.bottom - part.top), memory_.coordinates.straight};
  }

  void draw_part(const block& b, const block_part& part) {
    if constexpr (Map == map_kind::repeats_in_powers_of_two) {
      draw_masked(part, 0, 0);
    } else {
      const bool whole = find_source(b, part, part.level);
      if constexpr (Kind == filter::trilinear) {
        if (part.two) {
          if (find_coarser_source(b, part.level) && whole) draw_with_two(b, part);
          else draw_two_cut_at_borders(b, part);
          return;
        }
      }
      if (!draw_with_level(part, whole)) draw_cut_at_borders(part);
    }
  }

  // Finds where the kernels read. False if borders of the level cut the part.
  SPANTEX_FRAME_APART bool find_source(const block& b, const block_part& part, int level) {
    detail::box& x = memory_.reach;
    const auto row = [&](int j) -> const walk& { return memory_.rows[detail::row_in_strip(j)]; };
    detail::box_of_rows(row(part.top), row(part.bottom - 1), part.right - part.left, level - b.unit_log2, x);
    return detail::source_of(memory_.fine, x.u, x.v, memory_.at.base_u, memory_.at.base_v, Kind == filter::nearest ? 0 : 1, memory_.near);
  }
  // Then of the level after it.
  SPANTEX_FRAME_APART bool find_coarser_source(const block& b, int level) {
    set_level_view(map_, level + 1, memory_.coarse);
    const detail::box& x = memory_.reach;
    return detail::source_of(memory_.coarse, {detail::coarser(x.u.low), detail::coarser(x.u.high)}, {detail::coarser(x.v.low), detail::coarser(x.v.high)},
                             b.u.base >> (level + 1), b.v.base >> (level + 1), 1, memory_.far);
  }

  // All pixels on one level. False if its borders cut the part.
  [[gnu::noinline]] bool draw_with_level(const block_part& part, bool whole) {
    constexpr filter kind = uses_levels(Kind) ? filter::bilinear : Kind;
    const kept_source s = memory_.near;
#if SPANTEX_ROWS_MVE
    if constexpr (kind == filter::bilinear) {
      mve::source map;
      if (whole ? detail::lanes_within(memory_.reach, s, map) : detail::lanes_wrapped(memory_.fine, memory_.at.base_u, memory_.at.base_v, map)) {
        each_walk(part, [&](texel565* out, int, int count, int, const walk& w) { mve::bilinear(out, count, w, map, memory_.between.words); });
        return true;
      }
    }
#endif
    if (!whole) return false;
    if constexpr (kind == filter::nearest && plain_rows) nearest_rows(list_of(part), part.right - part.left, s);
    else each_walk(part, [&](texel565* out, int, int count, int, const walk& w) { run<kind>(out, count, w, s, memory_.between); });
    return true;
  }
  SPANTEX_FRAME_APART void draw_cut_at_borders(const block_part& part) {
    constexpr filter kind = uses_levels(Kind) ? filter::bilinear : Kind;
    if (kind == filter::nearest && memory_.fine.masked)
      return draw_masked(part, wrapped_base(memory_.at.base_u, memory_.fine.width), wrapped_base(memory_.at.base_v, memory_.fine.height));
    each_walk(part, [&](texel565* out, int, int count, int, const walk& w) {
      copy(w, memory_.at.at);
      draw_level<kind>(out, count, memory_.fine, memory_.at, memory_.between);
    });
  }

  // Texels of level 0 of a map that repeats in powers of two: masks wrap, no run is cut. The base is added to positions.
  SPANTEX_FRAME_MERGED SPANTEX_WRAPS void draw_masked(const block_part& part, int32_t base_u, int32_t base_v) {
    const uint32_t masks = uint32_t(map_.height() - 1) << 16 | uint32_t(map_.width() - 1);
    const source s{map_.numbers(0), 2 * map_.width()};
    each_walk(part, [&](texel565* out, int, int count, int, const walk& w) {
      if constexpr (Map == map_kind::repeats_in_powers_of_two) return nearest_masked_run(out, count, w, s, masks);
      walk& there = memory_.at.at;
      there = moved(w, base_u << 16, base_v << 16);
      nearest_masked_run(out, count, there, s, masks);
    });
  }

  // All pixels between two levels.
  [[gnu::noinline]] void draw_with_two(const block& b, const block_part& part) {
    each_walk_between(b, part, [&](texel565* out, int count, const walk& w) { run_between(out, count, w, memory_); });
  }
  SPANTEX_FRAME_APART void draw_two_cut_at_borders(const block& b, const block_part& part) {
    each_walk_between(b, part, [&](texel565* out, int count, const walk& w) {
      copy(w, memory_.at.at);
      draw_between(out, count, memory_);
    });
  }
  // With memory_.level of the row's first pixel.
  template <class Row>
  [[gnu::always_inline]] void each_walk_between(const block& b, const block_part& part, const Row& draw_row) {
    level_rows levels{};
    if constexpr (!Small) levels = levels_to_draw(b);
    each_walk(part, [&](texel565* out, int first, int count, int j, const walk& w) {
      if constexpr (Small) set_level(b, first, j);
      else memory_.level = level_at(levels, first, j);
      draw_row(out, count, w);
    });
  }
  static constexpr level_rows levels_to_draw(const block& b) {
    level_rows levels = level_rows_of(b);
    levels.start += detail::level_rounding(Kind);
    return levels;
  }
  static constexpr level_run level_at(const level_rows& levels, int first, int j) { return {levels.row(j).start + first * levels.step, levels.step}; }
  SPANTEX_FRAME_APART void set_level(const block& b, int first, int j) { memory_.level = level_at(levels_to_draw(b), first, j); }

  // Row by row, where pixels of one lie on several levels.
  SPANTEX_FRAME_APART void draw_by_rows(block& b, const block_part& part) {
    b.u.offset = b.v.offset = 0;
    detail::make_rows(b, part.top, part.bottom, memory_.rows);
    each_row(part, [&](texel565* out, int first, int count, int j) {
      for (const int end = first + count; first < end;) {
        const level_part x = begin_part<Kind>(map_, j, first, end, memory_);
        if (Kind != filter::mip_bilinear && x.two) draw_between(out, x.count, memory_);
        else draw_level<filter::bilinear>(out, x.count, memory_.fine, memory_.at, memory_.between);
        first += x.count;
        out += x.count;
      }
    });
  }

  const plane& plane_;
  const texture_view& map_;
  const Target& target_;
  state& memory_;
  area_of_blocks area_;
  Cover cover_;
};

}  // namespace SPANTEX_ROWS_KERNELS

// What a map must be. Errors: out_of_range (its format, a filter that rows do not have), bad_levels (a side that is neither half of the finer level's nor 1).
constexpr status check(const texture_view& t, filter kind) {
  if (t.format() != texel_format::rgb565 || !is_supported(kind)) return status::out_of_range;
  if (!uses_levels(kind)) return status::ok;
  const auto follows = [](int32_t fine, int32_t coarse) { return fine == 2 * coarse || coarse == 1; };
  for (int level = 0; level < t.last_level(); ++level)
    if (!follows(t.width(level), t.width(level + 1)) || !follows(t.height(level), t.height(level + 1))) return status::bad_levels;
  return status::ok;
}

// The part of a plane in front of the viewer inside `area`, which is cut to the target's. Errors: those of check(); out_of_range for a
// map that is not what `Map` says.
template <filter Kind, map_kind Map = map_kind::any, class Target>
status draw(state& memory, const Target& target, const plane& p, const texture_view& t, const rectangle& area) {
  static_assert(Map == map_kind::any || Kind == filter::nearest, "spantex: only the nearest texel is wrapped by masks");
  SPANTEX_TRY(check(t, Kind));
  if (Map != map_kind::any && !repeats_in_powers_of_two(t.wrap_u(), t.wrap_v(), t.width(), t.height())) return status::out_of_range;
  painter<Kind, Target, detail::rectangle_cover, Map>(p, t, target, area, {}, memory).draw();
  return status::ok;
}

// A polygon. Errors: those of check().
template <filter Kind, class Target>
SPANTEX_FRAME_APART status draw(state& memory, const Target& target, const polygon& p, const texture_view& t) {
  SPANTEX_TRY(check(t, Kind));
  painter<Kind, Target, detail::polygon_cover>(p.map, t, target, p.box, {&p.edges}, memory).draw();
  return status::ok;
}

// The same with the filter chosen at run time: all of them are linked.
template <class Memory, class Target, class... What>
status draw_any(filter kind, Memory& memory, const Target& target, const What&... what) {
  switch (kind) {
    case filter::nearest: return draw<filter::nearest>(memory, target, what...);
    case filter::three_point: return draw<filter::three_point>(memory, target, what...);
    case filter::bilinear: return draw<filter::bilinear>(memory, target, what...);
    case filter::mip_bilinear: return draw<filter::mip_bilinear>(memory, target, what...);
    case filter::trilinear: return draw<filter::trilinear>(memory, target, what...);
    default: return status::out_of_range;
  }
}

}  // namespace spantex::rows
