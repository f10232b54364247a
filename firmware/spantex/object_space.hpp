// SPDX-License-Identifier: Apache-2.0
// Texturing in object space, filtering in the screen plane (RD16; derivations in docs/METHODS.md, "Object space").
//
//   1. the polygon is turned parallel to the screen: x', y' on its plane, z' constant
//   2. there it is textured on a regular grid, at one level of detail found once: an affine map, so spans of 8x8 samples go through any span engine
//   3. each sample is turned back and projected: one homography, evaluated as the engine's own coordinates are: a division a span or a sample
//   4. each sample is spread over the four pixels around it with weights (1-f)(1-g), f(1-g), (1-f)g, fg; the pixel is sum S I / sum S
//
// No holes: a pixel collects the samples that lie less than a pixel away on both axes. The grid's pitch is such that half a pitch on both
// grid axes moves no point of the visible polygon by more than 15/16 pixel; what is left of a pixel covers the snapping of vertices
// (1/128), the steps of f and g (1/64) and the rounding of positions. The nearest visible part decides; `share` makes the grid finer. A margin of a
// pixel beyond the polygon is sampled too.
//
// Sums: f, g have 6 bits, a sample's weights add up to 2^12, colours have 8 bits. A pixel takes weights up to 2^24, 4096 whole samples:
// 255 * 2^24 < 2^32. What comes beyond is dropped and counted. A constant c gives (c W + W/2) / W = c exactly.
#pragma once
#include <stddef.h>
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/coverage.hpp>
#include <spantex/draw.hpp>
#include <spantex/object_grid.hpp>
#include <spantex/plane.hpp>
#include <spantex/polygon.hpp>
#include <spantex/status.hpp>
#include <spantex/wide.hpp>

namespace spantex {

// --- sums on the screen ------------------------------------------------------------------------------------

inline constexpr int spread_bits = 6;
inline constexpr uint32_t max_pixel_weight = uint32_t(1) << 24;
inline constexpr uint32_t max_samples_per_pixel = max_pixel_weight >> (2 * spread_bits);
static_assert(uint64_t(255) * max_pixel_weight + max_pixel_weight / 2 < (uint64_t(1) << 32), "sums and the rounding of their quotient fit 32 bits");

struct pixel_sums { uint32_t r, g, b, a, weight; };

// False if the pixel has all it can hold.
constexpr bool add_sample(pixel_sums& p, rgba8 colour, uint32_t weight) {
  if (weight > max_pixel_weight - p.weight) return false;
  p.r += weight * colour.r;
  p.g += weight * colour.g;
  p.b += weight * colour.b;
  p.a += weight * colour.a;
  p.weight += weight;
  return true;
}

// sum S I / sum S to nearest, weight > 0.
constexpr rgba8 mean_of(const pixel_sums& p) {
  const auto mean = [&](uint32_t sum) { return uint8_t((sum + p.weight / 2) / p.weight); };
  return {mean(p.r), mean(p.g), mean(p.b), mean(p.a)};
}

struct object_space_counters {
  uint64_t samples = 0;                  // textured, projected and spread
  uint64_t divides = 0;                  // reciprocals for projecting: one a span, one a sample where the span needs it
  uint64_t spreads = 0;                  // sums added to
  uint64_t spreads_dropped = 0;          // the pixel was full
  uint64_t pixels = 0;                   // written
  uint64_t pixels_without_samples = 0;   // covered, but no sample fell near: never, if the grid is right
  uint32_t largest_weight = 0;           // of a pixel written, 2^12 a sample
  uint32_t smallest_weight = UINT32_MAX;
};

namespace detail {

// Positions on the screen: a 256th of a pixel is plenty for 6 bits, the cheap evaluations serve often.
inline constexpr profile screen_positions{.coordinate_bits = 10, .tolerance_bits = 8, .exact_set_up = false};
static_assert(coordinate_bound(screen_positions) <= error_unit / 128, "far within the 1/32 pixel that the pitch leaves for rounding");

inline constexpr int max_grid_forms = max_edges + 6;

// Half planes of the grid that hold the samples of a region of the screen.
struct grid_region {
  linear_form forms[max_grid_forms];
  int count = 0;
};

// One tile of the grid: where its samples go and what they show.
struct grid_tile {
  plane screen, texture;
  grid_region region;
  int32_t columns, rows;  // spans
};

// An edge of the screen moved out by 1 + 1/32 pixel on both axes and pulled back to the grid: (256 (a Nx + b Ny) + c W) / W >= 0.
constexpr linear_form on_grid(const plane& screen, const edge& e, rectangle region) {
  const int64_t a = e.a * 256, b = e.b * 256, c = e.c + int64_t((magnitude(e.a) + magnitude(e.b)) * 264);
  const auto at = [&](int64_t x, int64_t y, int64_t w) { return multiply(a, x) + multiply(b, y) + multiply(c, w); };
  const wide_form f{at(screen.u.x, screen.v.x, screen.w.x), at(screen.u.y, screen.v.y, screen.w.y), at(screen.u.c, screen.v.c, screen.w.c)};
  const int bits = bound_bits(f, region.x1 - region.x0 + 32, region.y1 - region.y0 + 32);
  return narrowed(f, max_of(0, bits - 60));
}

// Depth, s15.16, in units of the tile's W; at most 2^60.
constexpr int64_t depth_in_w(int32_t z, int drop) {
  const int up = grid_bits - 16 + 1 - drop;
  return bit_length(uint64_t(z)) + up > 60 ? int64_t(1) << 60 : to_int64(scale_down(wide(z), -up));
}

constexpr status make_tile(const object_grid& g, int32_t tx, int32_t ty, const edge_set& edges, rectangle area, grid_tile& out) {
  const rectangle region = tile_region(g, tx, ty);
  int drop = 0;
  SPANTEX_TRY(normalise(tile_homography(g.x, g.y, g.z, tx, ty), region, out.screen, drop));
  SPANTEX_TRY(make_plane(tile_texture(g, tx, ty), region, out.texture));
  out.columns = (region.x1 + span_side - 1) / span_side;
  out.rows = (region.y1 + span_side - 1) / span_side;
  grid_region& r = out.region;
  r.count = 0;
  const linear_form& w = out.screen.w;
  r.forms[r.count++] = {w.x, w.y, w.c - depth_in_w(g.near_z, drop)};
  r.forms[r.count++] = {-w.x, -w.y, depth_in_w(g.far_z, drop) - w.c};
  const edge sides[4] = {{1, 0, -256 * int64_t(area.x0)}, {-1, 0, 256 * int64_t(area.x1)}, {0, 1, -256 * int64_t(area.y0)}, {0, -1, 256 * int64_t(area.y1)}};
  for (const edge& e : sides) r.forms[r.count++] = on_grid(out.screen, e, region);
  for (int k = 0; k < edges.count; ++k) r.forms[r.count++] = on_grid(out.screen, edges.edges[k], region);
  return status::ok;
}

constexpr span_mask sample_mask(const grid_tile& t, int32_t sx, int32_t sy) {
  span_mask mask = full_mask;
  for (int k = 0; k < t.region.count && mask != 0; ++k)
    mask &= positive_mask(t.region.forms[k], t.screen.origin_x, t.screen.origin_y, sx, sy);
  return mask;
}

// Spans of a row that the region can touch: first to last, empty if first > last.
struct span_run { int32_t first, last; };
constexpr span_run touched_spans(const grid_tile& t, int32_t sy) {
  const int64_t top = 2 * span_side * int64_t(sy) - t.screen.origin_y, bottom = top + 2 * span_side;
  int64_t low = 0, high = int64_t(t.columns) * 2 * span_side - 1;  // half samples
  for (int k = 0; k < t.region.count; ++k) {
    const linear_form& f = t.region.forms[k];
    const int64_t best = f.c + (f.y > 0 ? f.y * bottom : f.y * top);
    if (f.x == 0) {
      if (best <= 0) return {1, 0};
      continue;
    }
    const int64_t zero = t.screen.origin_x - best / f.x;  // within one of where the form is zero
    if (f.x > 0) low = zero - 1 > low ? zero - 1 : low;
    else high = zero + 1 < high ? zero + 1 : high;
  }
  return low > high ? span_run{1, 0} : span_run{int32_t(low / (2 * span_side)), int32_t(high / (2 * span_side))};
}

}  // namespace detail

// --- drawing -----------------------------------------------------------------------------------------------

// Draws polygons this way through any span engine. Sums are the caller's memory: the polygon is drawn in strips of as many rows as they
// hold, each with the same samples, so their number changes the cost but not a bit of the picture (profiles that split and take the level a pixel).
template <span_engine Engine, class Prof>
class object_space_renderer {
 public:
  // Frame, sums and engine must outlive the renderer.
  constexpr object_space_renderer(Engine& engine, const Prof& prof, const frame_buffer& frame, pixel_sums* sums, size_t sum_count)
      : frame_(frame), sums_(sums), sum_count_(sum_count), texturing_(engine, prof, {block_, block_width, span_side, block_width}) {}
  object_space_renderer(const object_space_renderer&) = delete;
  object_space_renderer& operator=(const object_space_renderer&) = delete;

  // Draws a convex polygon within `clip`, hidden pixels left out where a depth buffer is given. Errors: those of make_polygon() and
  // make_object_grid(); out_of_range (a filter that has a footprint: a grid is one level everywhere); bad_pointer (no frame or sums); bad_size (sums for less than a row of the polygon's box); what the engine reports.
  constexpr status draw(const vertex* vertices, int count, const projection& camera, rectangle clip, const texture_view& t, filter kind,
                        int share, depth_buffer depth = {}) {
    if (vertices == nullptr || frame_.pixels == nullptr || sums_ == nullptr) return status::bad_pointer;
    if (uses_footprint(kind) || uses_area(kind)) return status::out_of_range;
    polygon p{};
    SPANTEX_TRY(make_polygon(vertices, count, camera, intersection(clip, {0, 0, frame_.width, frame_.height}), p));
    object_grid g{};
    SPANTEX_TRY(make_object_grid(vertices, count, camera, p, share, g));
    const size_t width = size_t(p.box.x1 - p.box.x0), height = size_t(p.box.y1 - p.box.y0);
    const size_t rows = sum_count_ / width;
    if (rows == 0) return status::bad_size;
    const int32_t step = int32_t(rows < height ? rows : height);
    for (int32_t y = p.box.y0; y < p.box.y1; y += step)
      SPANTEX_TRY(draw_strip(p, g, t, kind, {p.box.x0, y, p.box.x1, min_of(y + step, p.box.y1)}, depth));
    return status::ok;
  }

  // Marks the frame's end; every draw() has written its pixels already.
  constexpr status finish() { return texturing_.finish(); }

  constexpr const object_space_counters& counters() const { return counters_; }
  constexpr const draw_counters& texturing() const { return texturing_.counters(); }

 private:
  static constexpr int block_spans = 8, block_width = block_spans * span_side;

  constexpr status draw_strip(const polygon& p, const object_grid& g, const texture_view& t, filter kind, rectangle area, depth_buffer depth) {
    area_ = area;
    const size_t count = size_t(area.x1 - area.x0) * size_t(area.y1 - area.y0);
    for (size_t k = 0; k < count; ++k) sums_[k] = {};
    for (int32_t ty = 0; ty < g.height; ty += grid_tile_side)
      for (int32_t tx = 0; tx < g.width; tx += grid_tile_side) {
        detail::grid_tile tile{};
        const status made = detail::make_tile(g, tx, ty, p.edges, area, tile);
        if (made == status::degenerate) continue;  // behind the viewer
        SPANTEX_TRY(made);
        for (int32_t sy = 0; sy < tile.rows; ++sy) {
          const detail::span_run run = detail::touched_spans(tile, sy);
          for (int32_t sx = run.first; sx <= run.last; sx += block_spans)
            SPANTEX_TRY(draw_block(tile, g.level, t, kind, sx, sy, min_of(block_spans, run.last - sx + 1)));
        }
      }
    write_out(p, depth);
    return status::ok;
  }

  // Up to eight spans of samples side by side: through the engine into the block, then onto the screen.
  constexpr status draw_block(const detail::grid_tile& tile, int16_t level, const texture_view& t, filter kind, int32_t sx, int32_t sy, int spans) {
    plane moved = tile.texture;
    moved.origin_x -= 2 * span_side * sx;
    moved.origin_y -= 2 * span_side * sy;
    const surface s{&moved, &t, kind, level};
    span_mask masks[block_spans] = {};
    span_mask any = 0;
    for (int k = 0; k < spans; ++k) {
      masks[k] = detail::sample_mask(tile, sx + k, sy);
      any |= masks[k];
      if (masks[k] != 0) SPANTEX_TRY(texturing_.draw_span(s, k, 0, masks[k]));
    }
    if (any == 0) return status::ok;
    SPANTEX_TRY(texturing_.flush());
    for (int k = 0; k < spans; ++k) spread_span(tile.screen, sx + k, sy, masks[k], block_ + k * span_side);
    return status::ok;
  }

  constexpr void spread_span(const plane& screen, int32_t sx, int32_t sy, span_mask mask, const rgba8* colours) {
    if (mask == 0) return;
    constexpr fixed_profile<detail::screen_positions> prof{};
    const profile& q = prof.get();
    const int32_t cx = 2 * span_side * sx + span_side, cy = 2 * span_side * sy + span_side;
    span_coefficients c{};
    bool whole = false;
    if (screen.w_at(cx, cy) > 0) whole = span_coordinates(reference_at(screen, cx, cy), q, c);
    counters_.divides += whole ? 1 : 0;
    for (; mask != 0; mask &= mask - 1) {
      const int bit = __builtin_ctzll(mask), i = bit % span_side, j = bit / span_side;
      if (!whole) pixel_coordinates(reference_at(screen, cx + half_pixels(i), cy + half_pixels(j)), q, c);
      if (!whole || c.how == evaluation::divide) ++counters_.divides;
      spread(position_at(prof, c, i, j), colours[j * block_width + i]);
    }
  }

  constexpr void spread(texel_position at, rgba8 colour) {
    ++counters_.samples;
    constexpr int drop = 16 - spread_bits;
    constexpr int32_t half = 1 << 15, one = 1 << spread_bits;
    const int32_t x = (at.u.raw() - half) >> drop, y = (at.v.raw() - half) >> drop;
    const int32_t px = x >> spread_bits, py = y >> spread_bits;
    const uint32_t f = uint32_t(x & (one - 1)), g = uint32_t(y & (one - 1));
    add(px, py, colour, (one - f) * (one - g));
    add(px + 1, py, colour, f * (one - g));
    add(px, py + 1, colour, (one - f) * g);
    add(px + 1, py + 1, colour, f * g);
  }

  constexpr void add(int32_t x, int32_t y, rgba8 colour, uint32_t weight) {
    if (weight == 0 || x < area_.x0 || x >= area_.x1 || y < area_.y0 || y >= area_.y1) return;
    if (add_sample(sum_at(x, y), colour, weight)) ++counters_.spreads;
    else ++counters_.spreads_dropped;
  }

  constexpr pixel_sums& sum_at(int32_t x, int32_t y) {
    return sums_[size_t(y - area_.y0) * size_t(area_.x1 - area_.x0) + size_t(x - area_.x0)];
  }

  // Covered pixels of the strip, by the rule of every other polygon.
  constexpr void write_out(const polygon& p, depth_buffer depth) {
    for (int32_t sy = area_.y0 / span_side; sy <= (area_.y1 - 1) / span_side; ++sy)
      for (int32_t sx = area_.x0 / span_side; sx <= (area_.x1 - 1) / span_side; ++sx) {
        span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(area_, sx, sy);
        if (mask != 0) mask &= front_mask(p.map, sx, sy);
        for (; mask != 0; mask &= mask - 1) {
          const int bit = __builtin_ctzll(mask);
          write_pixel(p, sx * span_side + bit % span_side, sy * span_side + bit / span_side, depth);
        }
      }
  }

  constexpr void write_pixel(const polygon& p, int32_t x, int32_t y, depth_buffer depth) {
    if (depth.values != nullptr) {
      const uint32_t z = depth_at(p, 2 * x + 1, 2 * y + 1);
      uint32_t& stored = depth.values[y * frame_.width + x];
      if (z <= stored) return;
      stored = z;
    }
    const pixel_sums& sum = sum_at(x, y);
    if (sum.weight == 0) { ++counters_.pixels_without_samples; return; }
    frame_.pixels[y * frame_.stride + x] = mean_of(sum);
    ++counters_.pixels;
    counters_.largest_weight = sum.weight > counters_.largest_weight ? sum.weight : counters_.largest_weight;
    counters_.smallest_weight = sum.weight < counters_.smallest_weight ? sum.weight : counters_.smallest_weight;
  }

  frame_buffer frame_;
  pixel_sums* sums_;
  size_t sum_count_;
  rgba8 block_[block_width * span_side] = {};
  renderer<Engine, Prof> texturing_;
  rectangle area_{};
  object_space_counters counters_{};
};

}  // namespace spantex
