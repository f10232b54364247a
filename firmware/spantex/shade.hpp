// SPDX-License-Identifier: Apache-2.0
// Write-out: what a pixel's colour does to the frame (docs/SPEC.md "Write-out"). A renderer is given one of two shadings as a type: `opaque_only`, the
// default, stores pixels as they come and has no code or state for anything else; `shading` chooses at run time.
//
//   colour    multiplied, each channel, with one colour or with colours interpolated between a polygon's vertices; 255 changes nothing
//   opaque    stored; depth tested and stored before the pixel is computed
//   cut_out   stored, and its depth with it, where alpha reaches the threshold
//   blended   round((s a + d (255 - a)) / 255) over what is there; depth tested, not stored: draw from far to near
//   premultiplied  s + round(d (255 - a) / 255), at most 255; depth likewise
//
// Products and blends are of the coded 8-bit values, the frame's own.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/plane.hpp>
#include <spantex/polygon.hpp>
#include <spantex/reciprocal.hpp>
#include <spantex/span.hpp>
#include <spantex/status.hpp>

namespace spantex {

enum class alpha_mode : uint8_t { opaque, cut_out, blended, premultiplied };

inline constexpr rgba8 white{255, 255, 255, 255};

constexpr rgba8 modulated(rgba8 t, rgba8 c) {
  const auto product = [](uint8_t a, uint8_t b) { return uint8_t(over_255(uint32_t(a) * b)); };
  return {product(t.r, c.r), product(t.g, c.g), product(t.b, c.b), product(t.a, c.a)};
}

// Straight alpha over an opaque frame; the frame's own alpha becomes a + d (255 - a) / 255.
constexpr rgba8 blended(rgba8 s, rgba8 d) {
  const uint32_t a = s.a, rest = 255 - a;
  const auto mixed = [=](uint32_t x, uint32_t y) { return uint8_t(over_255(x * a + y * rest)); };
  return {mixed(s.r, d.r), mixed(s.g, d.g), mixed(s.b, d.b), mixed(255, d.a)};
}

// A colour above its alpha is not premultiplied; the sum stops at 255.
constexpr rgba8 blended_premultiplied(rgba8 s, rgba8 d) {
  const uint32_t rest = 255u - s.a;
  const auto sum = [=](uint32_t x, uint32_t y) { return uint8_t(min_of(int(x + over_255(y * rest)), 255)); };
  return {sum(s.r, d.r), sum(s.g, d.g), sum(s.b, d.b), sum(s.a, d.a)};
}

// --- colours of vertices -------------------------------------------------------------------------------

// Perspective-correct: channel k of a pixel is Nk/W, Nk linear on the screen like Nu and Nv (polygon.hpp), in the plane's scale times 2^-up.
struct colour_forms {
  linear_form channel[channel_count];
  rgba8 flat;        // if nothing varies: the colour everywhere, and no division
  int8_t up;
  bool varies = false;
  friend constexpr bool operator==(const colour_forms&, const colour_forms&) = default;
};

namespace detail {

// Forms stay below 2^59 over the polygon's box, as Nu and Nv do, whatever they are far outside the polygon.
constexpr colour_forms make_colour_forms(const polygon_basis& b, const vertex* vertices, const projection& camera, const rgba8* colours, const polygon& p) {
  const rgba8 first = colours[0], second = colours[b.second], third = colours[b.second + 1];
  colour_forms out{{}, first, 0, !(first == second && first == third)};
  if (!out.varies) return out;
  const uint8_t values[channel_count][3] = {
      {first.r, second.r, third.r}, {first.g, second.g, third.g}, {first.b, second.b, third.b}, {first.a, second.a, third.a}};
  const edge at[] = {held(project(vertices[0], camera)), held(project(vertices[b.second], camera)), held(project(vertices[b.second + 1], camera))};
  const edge* const corners[] = {&at[0], &at[1], &at[2]};
  adjugate_row rows[3];
  wide determinant;
  for (int axis = 0; axis < 3; ++axis) {
    make_adjugate_row(corners, axis, rows[axis]);
    add_product(determinant, rows[axis].of[0], on_axis(at[0], axis));
  }
  const int sign = determinant.negative() ? -1 : 1;
  wide_form forms[channel_count];
  int bits = 0;
  for (int k = 0; k < channel_count; ++k) {
    const uint8_t(&v)[3] = values[k];
    for (int axis = 0; axis < 3; ++axis)
      interpolate(rows[axis], sign * (v[0] << 16), sign * (v[1] << 16), sign * (v[2] << 16), coefficient(forms[k], axis));
    move_origin(forms[k], p.map.origin_x, p.map.origin_y);
    bits = max_of(bits, bound_bits(forms[k], p.box.x1 - p.box.x0 + 32, p.box.y1 - p.box.y0 + 32));
  }
  out.up = int8_t(max_of(0, bits - 59 - b.drop));
  for (int k = 0; k < channel_count; ++k) out.channel[k] = narrowed(forms[k], b.drop + out.up);
  return out;
}

// n / w 2^up to nearest, 0..255. The bit lengths keep the quotient below 2^10.
constexpr uint8_t colour_value(int64_t n, int up, int64_t w, inverse over_w) {
  if (n <= 0) return 0;
  const int bits = bit_length(uint64_t(n));
  if (bits + up > bit_length(uint64_t(w)) + 8) return 255;
  return uint8_t(min_of(int(quotient(n, max_of(0, bits - 31), over_w, up)), 255));
}

constexpr int64_t value_at(const linear_form& f, int32_t dx, int32_t dy) { return f.c + f.x * dx + f.y * dy; }

// dx, dy half pixels from the forms' origin, W > 0 there. Polygons with an edge in common and the same colours at its ends agree along it.
constexpr rgba8 colour_at(const colour_forms& f, const linear_form& w_form, int32_t dx, int32_t dy) {
  if (!f.varies) return f.flat;
  const int64_t w = value_at(w_form, dx, dy);
  const inverse over_w = invert(w);
  const auto value = [&](int k) { return colour_value(value_at(f.channel[k], dx, dy), f.up, w, over_w); };
  return {value(0), value(1), value(2), value(3)};
}

}  // namespace detail

// A polygon with colours at its vertices: make_polygon (polygon.hpp), which lists the errors, and the forms. The colours of the three vertices that give
// the texture plane determine those of the others: a polygon of more must have them in that plane (else draw triangles).
constexpr status make_polygon(const vertex* vertices, const rgba8* colours, int count, const projection& camera, rectangle clip, polygon& out,
                              colour_forms& forms) {
  if (count < 3 || count > max_polygon_vertices) return status::bad_size;
  detail::polygon_basis basis{};
  out.box = clip;
  SPANTEX_TRY(detail::make_polygon(detail::pointers_to(vertices, count).to, count, camera, out, basis));
  forms = detail::make_colour_forms(basis, vertices, camera, colours, out);
  return status::ok;
}

// At a pixel's centre (half pixels) inside the polygon.
constexpr rgba8 colour_at(const polygon& p, const colour_forms& f, int32_t hx, int32_t hy) {
  return detail::colour_at(f, p.map.w, hx - p.map.origin_x, hy - p.map.origin_y);
}

// --- shadings ------------------------------------------------------------------------------------------

enum class write_result : uint8_t { stored, mixed, left };  // what became of a pixel; left: what was there stays

struct opaque_only {
  static constexpr bool enabled = false;
  struct job {
    constexpr bool stores_depth() const { return false; }
    constexpr bool without_alpha() const { return false; }
  };
  constexpr bool stores_depth_first() const { return true; }
  constexpr job of(const plane&) const { return {}; }
  constexpr job of(const polygon&, uint32_t*) const { return {}; }
};

struct shading {
  static constexpr bool enabled = true;

  alpha_mode alpha = alpha_mode::opaque;
  uint8_t threshold = 128;                 // cut_out: a smaller alpha is left out
  rgba8 colour = white;                    // multiplies every pixel
  const colour_forms* colours = nullptr;   // of the polygon that is drawn, instead; read while draw() runs

  // What is kept of a surface until its last pixel is written.
  struct job {
    alpha_mode alpha = alpha_mode::opaque;
    uint8_t threshold = 0;
    bool modulates = false;
    colour_forms colours{};
    linear_form w{}, depth{};
    int32_t origin_x = 0, origin_y = 0;
    uint32_t* depth_values = nullptr;      // cut_out: stored with the pixel
    bool no_alpha = false;                 // of a map whose alpha is 255, drawn as if opaque

    constexpr bool stores_depth() const { return depth_values != nullptr; }

    // Every alpha that is written will be 255: then all modes store the colour. True if that was a cut-out's, whose depth may now be stored first.
    constexpr bool without_alpha() {
      if (alpha == alpha_mode::opaque || colours.varies || (modulates && colours.flat.a != 255)) return false;
      const bool cut_out = alpha == alpha_mode::cut_out;
      alpha = alpha_mode::opaque;
      depth_values = nullptr;
      no_alpha = true;
      return cut_out;
    }

    // Pixels of a smaller alpha are left out, whatever their colour: multiplied, it does not grow.
    constexpr int left_below() const { return alpha == alpha_mode::cut_out ? threshold : alpha == alpha_mode::blended ? 1 : 0; }

    // Of a pixel that is written; index as below.
    constexpr void store_depth(int32_t x, int32_t y, int32_t index) const {
      if (stores_depth()) depth_values[index] = detail::depth_of(depth, 2 * x + 1 - origin_x, 2 * y + 1 - origin_y);
    }

    // Pixel (x, y), `depth_index` in the depth buffer.
    constexpr write_result write(rgba8 s, int32_t x, int32_t y, rgba8& there, int32_t depth_index) const {
      if (modulates) s = modulated(s, detail::colour_at(colours, w, 2 * x + 1 - origin_x, 2 * y + 1 - origin_y));
      switch (alpha) {
        case alpha_mode::opaque: break;
        case alpha_mode::cut_out:
          if (s.a < threshold) return write_result::left;
          store_depth(x, y, depth_index);
          break;
        case alpha_mode::blended:
          if (s.a == 0) return write_result::left;
          there = spantex::blended(s, there);
          return write_result::mixed;
        case alpha_mode::premultiplied:
          there = blended_premultiplied(s, there);
          return write_result::mixed;
      }
      there = s;
      return write_result::stored;
    }
  };

  constexpr bool stores_depth_first() const { return alpha == alpha_mode::opaque; }

  constexpr job of(const plane& p) const {
    job j{alpha, threshold, !(colour == white), {}, p.w, {}, p.origin_x, p.origin_y, nullptr};
    j.colours.flat = colour;
    return j;
  }
  constexpr job of(const polygon& p, uint32_t* depth_values) const {
    job j = of(p.map);
    if (colours != nullptr) {
      j.colours = *colours;
      j.modulates = colours->varies || !(colours->flat == white);
    }
    j.depth = p.depth;
    if (alpha == alpha_mode::cut_out) j.depth_values = depth_values;
    return j;
  }
};

}  // namespace spantex
