// SPDX-License-Identifier: Apache-2.0
// Drawing by rows: planes and polygons from an RGB565 map in directly addressed memory to rows of RGB565. For cores without an engine beside them:
// nothing is copied, coordinates are those of block.hpp (docs/SPEC.md "Rows"). The engine's profiles (draw.hpp) are more exact and know more.
//
//   target    where rows go: `texel565* row(x, y, count)` gives memory for that many pixels, at most 32; `void done(x, y, count)` ends them: every one has
//             been written. Rows arrive block by block, within `width` and `height` or, where a target has it, within `rectangle area()`. frame565 is a
//             frame buffer; targets.hpp has other formats, parts of frames, blending, displays without a frame buffer.
//   filter    nearest, three_point, bilinear: level 0; mip_bilinear, trilinear: maps whose sides halve exactly.
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
    constexpr int side = detail::largest_side;
    for (int32_t y = area_.y0 & -side; y < area_.y1; y += side)
      for (int32_t x = area_.x0 & -side; x < area_.x1; x += side) draw_square(x, y);
  }

 private:
  // Blocks of 32 x 32 pixels: halves, one after the other, of what cannot be drawn.
  void draw_square(int32_t x, int32_t y) {
    int k = largest_block_log2, n = largest_block_log2;
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

  struct block_part { int32_t x0, y0; int8_t left, right, top, bottom; };

  SPANTEX_FRAME_MERGED outcome draw_block(int32_t x0, int32_t y0, int k, int n) {
    const int32_t left = max_of(area_.x0 - x0, 0), right = min_of(area_.x1 - x0, 1 << k);
    const int32_t top = max_of(area_.y0 - y0, 0), bottom = min_of(area_.y1 - y0, 1 << n);
    // Made at once it takes less stack, made when it is needed fewer instructions.
    const auto make_part = [&] { return block_part{x0, y0, int8_t(left), int8_t(right), int8_t(top), int8_t(bottom)}; };
    block_part part{};
    if constexpr (Small) part = make_part();
    if (left >= right || top >= bottom || !cover_.prepare(memory_.masks, x0, y0, k, n)) return outcome::behind;
    block& b = memory_.coordinates;
    // Inlined where code is to be least; else its frame is not to lie under the kernels'.
    constexpr auto at = Map == map_kind::repeats_in_powers_of_two ? block_at<false> : block_at_apart<uses_levels(Kind)>;
    const outcome found = at(plane_, x0, y0, k, n, {map_.last_level(), 0}, memory_.about, b);
    if (found != outcome::drawn) return found;
    if constexpr (!Small) part = make_part();
    if constexpr (Map == map_kind::repeats_in_powers_of_two) draw_masked(b, part);
    else if constexpr (uses_levels(Kind)) draw_with_levels(b, part);
    else on_one_level(b, part, 0, find_source(b, 0, Kind == filter::nearest ? 0 : snap));
    return outcome::drawn;
  }

  // A copy is not read again row by row, or block by block, but costs stack.
  using part_of_rows = typename detail::kept<block_part, Small>::type;
  using area_of_blocks = typename detail::kept<rectangle, Small>::type;
  template <class Row>
  [[gnu::always_inline]] void each_row(part_of_rows part, const Row& draw_row) {
    const uint32_t wanted = detail::columns(part.left, part.right);
    for (int32_t j = part.top; j < part.bottom; ++j) {
      int first = part.left, count = part.right - part.left;
      if constexpr (!Cover::whole_rows) {
        const uint32_t mask = cover_.row(memory_.masks, j) & wanted;
        if (mask == 0) continue;
        first = __builtin_ctz(mask);
        count = 32 - __builtin_clz(mask) - first;
      }
      draw_row(target_.row(part.x0 + first, part.y0 + j, count), first, count, j);
      target_.done(part.x0 + first, part.y0 + j, count);
    }
  }

  // With walks from pixel `first`, on a level for which offsets are set.
  template <class Row>
  [[gnu::always_inline]] void each_walk(const block& b, const block_part& part, int level, const Row& draw_row) {
    detail::row_maker rows;
    each_row(part, [&](texel565* out, int first, int count, int j) {
      walk& w = rows.at(b, j, memory_.at.at);
      if (level != b.unit_log2) w = detail::scaled(w, level - b.unit_log2);
      if (first != 0) w = advanced(w, first);
      draw_row(out, first, count, j, w);
    });
  }
  // Runs that are cut go on in memory_.at.
  [[gnu::always_inline]] level_walk& going_on([[maybe_unused]] const walk& w) {
    if constexpr (SPANTEX_ROWS_MVE) memory_.at.at = w;
    return memory_.at;
  }

  // Sets offsets for a level, and finds where the kernels read. False if borders of the level cut the block.
  SPANTEX_FRAME_APART bool find_source(block& b, int level, int32_t offset) {
    detail::set_offsets(b, level, offset);
    memory_.fine = level_of(map_, level);
    detail::box_of_block(b, level, memory_.at.at, memory_.reach);
    const detail::box& x = memory_.reach;
    return detail::source_of(memory_.fine, x.u, x.v, detail::base_on(level, b.u.base), detail::base_on(level, b.v.base), Kind == filter::nearest ? 0 : 1, memory_.near);
  }
  // Then of the level after it.
  SPANTEX_FRAME_APART bool find_coarser_source(const block& b, int level) {
    memory_.coarse = level_of(map_, level + 1);
    const detail::box& x = memory_.reach;
    return detail::source_of(memory_.coarse, {detail::coarser(x.u.low), detail::coarser(x.u.high)}, {detail::coarser(x.v.low), detail::coarser(x.v.high)},
                             b.u.base >> (level + 1), b.v.base >> (level + 1), 1, memory_.far);
  }

  // All pixels on one level. False if its borders cut the block.
  [[gnu::noinline]] bool draw_with_level(const block& b, const block_part& part, int level, bool whole) {
    constexpr filter kind = uses_levels(Kind) ? filter::bilinear : Kind;
    const source& s = memory_.near;
#if SPANTEX_ROWS_MVE
    if constexpr (kind == filter::bilinear) {
      mve::source map;
      if (whole ? detail::lanes_within(memory_.reach, s, map) : detail::lanes_wrapped(memory_.fine, detail::base_on(level, b.u.base), detail::base_on(level, b.v.base), map)) {
        each_walk(b, part, level, [&](texel565* out, int, int count, int, const walk& w) { mve::bilinear(out, count, w, map, memory_.between.words); });
        return true;
      }
    }
#endif
    if (!whole) return false;
    each_walk(b, part, level, [&](texel565* out, int, int count, int, const walk& w) { run<kind>(out, count, w, s, memory_.between); });
    return true;
  }
  SPANTEX_FRAME_APART void draw_cut_at_borders(block& b, const block_part& part, int level) {
    constexpr filter kind = uses_levels(Kind) ? filter::bilinear : Kind;
    if (kind == filter::nearest && wraps_by_mask(memory_.fine)) return draw_masked(b, part);
    memory_.at.base_u = detail::base_on(level, b.u.base);
    memory_.at.base_v = detail::base_on(level, b.v.base);
    each_walk(b, part, level, [&](texel565* out, int, int count, int, const walk& w) {
      draw_level<kind>(out, count, memory_.fine, going_on(w), memory_.between);
    });
  }

  // Texels of level 0 of a map that repeats in powers of two: masks wrap, no run is cut.
  SPANTEX_FRAME_MERGED SPANTEX_WRAPS void draw_masked(block& b, const block_part& part) {
    b.u.offset = (b.u.base & (map_.width() - 1)) << 16;
    b.v.offset = (b.v.base & (map_.height() - 1)) << 16;
    const uint32_t masks = uint32_t(map_.height() - 1) << 16 | uint32_t(map_.width() - 1);
    const source s{map_.numbers(0), 2 * map_.width()};
    each_walk(b, part, 0, [&](texel565* out, int, int count, int, const walk& w) { nearest_masked_run(out, count, w, s, masks); });
  }

  // All pixels between two levels.
  [[gnu::noinline]] void draw_with_two(const block& b, const block_part& part, int level) {
    each_row_between(b, part, level, [&](texel565* out, int count, const walk& w) {
      trilinear_run(out, count, w, memory_.near, memory_.far, memory_.level, memory_.between);
    });
  }
  SPANTEX_FRAME_APART void draw_two_cut_at_borders(block& b, const block_part& part, int level) {
    memory_.at.base_u = detail::base_on(level, b.u.base);
    memory_.at.base_v = detail::base_on(level, b.v.base);
    each_row_between(b, part, level, [&](texel565* out, int count, const walk& w) {
      going_on(w);
      draw_between(out, count, memory_);
    });
  }
  // With memory_.level of the row's first pixel.
  template <class Row>
  [[gnu::always_inline]] void each_row_between(const block& b, const block_part& part, int level, const Row& draw_row) {
    each_walk(b, part, level, [&](texel565* out, int first, int count, int j, const walk& w) {
      set_level(b, first, j);
      draw_row(out, count, w);
    });
  }
  SPANTEX_FRAME_APART void set_level(const block& b, int first, int j) {
    level_run d = level_row_at(b, j);
    d.start += first * d.step + detail::level_rounding(Kind);
    memory_.level = d;
  }

  void on_one_level(block& b, const block_part& part, int level, bool whole) {
    if (!draw_with_level(b, part, level, whole)) draw_cut_at_borders(b, part, level);
  }

  // How a block is drawn that has levels of detail: whole on a level, or cut at its borders; between two levels, likewise; or row by row, where its pixels
  // lie on several.
  enum class way : uint8_t { on_one, cut_on_one, between_two, cut_between_two, by_rows };
  SPANTEX_FRAME_APART way find_way(block& b, int& level) {
    const detail::interval levels = detail::levels_of(b, detail::level_rounding(Kind), map_.last_level());
    if (levels.low != levels.high) return way::by_rows;
    level = max_of(levels.low, 0);
    const bool whole = find_source(b, level, snap);
    if (Kind == filter::mip_bilinear || levels.low < 0 || level == map_.last_level()) return whole ? way::on_one : way::cut_on_one;
    return find_coarser_source(b, level) && whole ? way::between_two : way::cut_between_two;
  }
  [[gnu::always_inline]] void draw_with_levels(block& b, const block_part& part) {
    int level = 0;
    const way how = find_way(b, level);
    if (how <= way::cut_on_one) on_one_level(b, part, level, how == way::on_one);
    else if (how == way::by_rows) draw_by_rows(part);
    else if constexpr (Kind != filter::mip_bilinear) how == way::between_two ? draw_with_two(b, part, level) : draw_two_cut_at_borders(b, part, level);
  }
  SPANTEX_FRAME_APART void draw_by_rows(const block_part& part) {
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

// What a map must be. Errors: out_of_range (its format, a filter that rows do not have), bad_levels (sides that do not halve exactly).
constexpr status check(const texture_view& t, filter kind) {
  if (t.format() != texel_format::rgb565 || !is_supported(kind)) return status::out_of_range;
  if (!uses_levels(kind)) return status::ok;
  for (int level = 0; level < t.last_level(); ++level)
    if (t.width(level) != 2 * t.width(level + 1) || t.height(level) != 2 * t.height(level + 1)) return status::bad_levels;
  return status::ok;
}

// The part of a plane in front of the viewer inside `area`, which is cut to the target's. Errors: those of check(); out_of_range for a
// map that is not what `Map` says.
template <filter Kind, map_kind Map = map_kind::any, class Target>
status draw(state& memory, const Target& target, const plane& p, const texture_view& t, const rectangle& area) {
  static_assert(Map == map_kind::any || Kind == filter::nearest, "spantex: only the nearest texel is wrapped by masks");
  SPANTEX_TRY(check(t, Kind));
  if (Map != map_kind::any && !wraps_by_mask(level_of(t, 0))) return status::out_of_range;
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
