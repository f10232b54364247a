// SPDX-License-Identifier: Apache-2.0
#include "sim/stress_planes.hpp"

#include <spantex/coordinates.hpp>

#include <algorithm>
#include <bit>

#include "sim/exact.hpp"
#include "sim/random.hpp"

namespace spantex::sim {
namespace {

// A random number of at most `bits` bits whose size is spread evenly over the powers of two.
int64_t any_size(random_source& r, int bits) {
  const int n = int(r.below(uint32_t(bits) + 1));
  const int64_t x = n == 0 ? 0 : int64_t(r.next() >> (64 - n));
  return r.below(2) ? x : -x;
}

int64_t positive(random_source& r, int low_bits, int high_bits) {
  const int n = low_bits + int(r.below(uint32_t(high_bits - low_bits + 1)));
  return int64_t((r.next() >> (64 - n)) | (uint64_t(1) << (n - 1)));
}

int64_t either_sign(random_source& r, int64_t x) { return r.below(2) ? x : -x; }

int any_side(random_source& r) { return r.below(2) ? 1 + int(r.below(max_screen_px)) : 1 + int(r.below(uint32_t(1) << r.below(13))); }

struct sketch {
  int64_t g = 0, h = 0, w0 = 0;        // W = w0 at (x0, y0), slopes per pixel; any common scale
  int64_t u0 = 0, v0 = 0;              // texels in s.16 at (x0, y0)
  int64_t a = 0, b = 0, d = 0, e = 0;  // slopes of the numerators, in the scale of W
  int x0 = 0, y0 = 0;
};

homography about(const sketch& s) {
  const auto constant = [&](wide at, int64_t x, int64_t y) { return at - multiply(x, s.x0) - multiply(y, s.y0); };
  const auto row = [&](int64_t t) { return shift_right_nearest(multiply(s.w0, t), 16); };
  return {wide(s.a), wide(s.b), constant(row(s.u0), s.a, s.b), wide(s.d), wide(s.e), constant(row(s.v0), s.d, s.e),
          wide(s.g), wide(s.h), constant(wide(s.w0), s.g, s.h)};
}

// The slope that moves a coordinate by `texels_16` (s.16) per pixel at the anchor.
int64_t slope(const sketch& s, int64_t texels_16, int64_t at, int64_t w_slope) {
  const wide sum = multiply(s.w0, texels_16) + multiply(at, w_slope);
  return to_int64(shift_right_nearest(sum, 16));
}

template <class Texels>
void set_slopes(sketch& s, Texels per_pixel) {
  s.a = slope(s, per_pixel(), s.u0, s.g);
  s.b = slope(s, per_pixel(), s.u0, s.h);
  s.d = slope(s, per_pixel(), s.v0, s.g);
  s.e = slope(s, per_pixel(), s.v0, s.h);
}

sketch anywhere(random_source& r, int width, int height) {
  sketch s;
  s.x0 = int(r.below(uint32_t(width)));
  s.y0 = int(r.below(uint32_t(height)));
  s.w0 = positive(r, 30, 44);
  s.u0 = any_size(r, 31);
  s.v0 = any_size(r, 31);
  s.g = any_size(r, 36);
  s.h = any_size(r, 36);
  return s;
}

// W falls to zero within `distance_px` of the anchor.
void put_horizon(sketch& s, random_source& r, uint32_t distance_px) {
  s.g = any_size(r, 36);
  s.h = either_sign(r, positive(r, 16, 36));
  const int64_t steepest = std::max(std::abs(s.g), std::abs(s.h));
  s.w0 = 1 + steepest / 256 * int64_t(r.below(256 * distance_px));
}

void set_edge_on(sketch& s, random_source& r) {
  const int64_t k = any_size(r, 12);
  s.a = s.g * k + any_size(r, 6);
  s.b = s.h * k + any_size(r, 6);
  if (r.below(2)) {  // u and v almost constant
    s.d = s.g * k + any_size(r, 6);
    s.e = s.h * k + any_size(r, 6);
  } else {  // v = m u exactly: the map of the plane is a line
    const int64_t m = any_size(r, 3);
    s.d = m * s.a;
    s.e = m * s.b;
    s.v0 = m * s.u0;
  }
}

sketch draw_sketch(stress_family family, random_source& r, int width, int height) {
  sketch s = anywhere(r, width, height);
  int low = 0, high = 22;  // bits of the gradient, 2^-16 texel per pixel
  switch (family) {
    case stress_family::horizon:
      put_horizon(s, r, 64);
      break;
    case stress_family::near_horizon:
      put_horizon(s, r, 6);
      high = 30;
      break;
    case stress_family::cancelling:
      s.u0 = any_size(r, 10);
      s.v0 = any_size(r, 10);
      s.x0 = r.below(2) ? width - 1 : 0;
      s.y0 = r.below(2) ? height - 1 : 0;
      low = 16;
      high = 24;
      break;
    case stress_family::far_coordinates: {
      const auto far = [&] { return either_sign(r, (int64_t(32768) << 16) - int64_t(r.below(1u << r.below(22)))); };
      s.u0 = far();
      s.v0 = far();
      break;
    }
    case stress_family::wide_screen:
      s.x0 = r.below(2) ? int(r.below(64)) : width - 1 - int(r.below(64));
      break;
    case stress_family::magnified:
      high = 6;
      s.g = any_size(r, 24);
      s.h = any_size(r, 24);
      break;
    case stress_family::minified:
      low = 28;
      high = 30;
      s.u0 = any_size(r, 28);
      s.v0 = any_size(r, 28);
      break;
    default:
      break;
  }
  set_slopes(s, [&] { return low == 0 ? any_size(r, high) : either_sign(r, positive(r, low, high)); });
  if (family == stress_family::edge_on) set_edge_on(s, r);
  return s;
}

// Coefficients as large as a homography may have, or W and numerators both at the ends of a plane's ranges; or the smallest there are.
homography extreme(random_source& r, int width, int height, sketch& s) {
  s = anywhere(r, width, height);
  const bool small = r.below(4) == 0;
  if (small) {
    s.w0 = 1 + int64_t(r.below(4));
    s.g = s.h = 0;
    s.u0 = either_sign(r, int64_t(r.below(4)) << 16);
    s.v0 = either_sign(r, int64_t(r.below(4)) << 16);
  } else {
    s.w0 = positive(r, 44, 44);
    s.g = any_size(r, 28);
    s.h = any_size(r, 28);
    const auto far = [&] { return either_sign(r, (int64_t(16384 + r.below(16000))) << 16); };
    s.u0 = far();
    s.v0 = far();
  }
  set_slopes(s, [&] { return small ? either_sign(r, int64_t(r.below(3)) << 16) : any_size(r, 20); });
  const homography m = about(s);
  if (small) return m;
  wide homography::*const slopes[] = {&homography::a, &homography::b, &homography::d, &homography::e, &homography::g, &homography::h};
  wide homography::*const constants[] = {&homography::c, &homography::f, &homography::i};
  int room = 127;
  for (const auto part : slopes) room = std::min(room, 110 - bit_length(m.*part));
  for (const auto part : constants) room = std::min(room, 122 - bit_length(m.*part));
  homography scaled = m;
  // Low bits of their own, so that set-up has something to round.
  const auto fill = [&](wide x) { return shift_left(x, room) + wide(int64_t(r.next() >> 1) >> std::max(0, 64 - room)); };
  for (const auto part : slopes) scaled.*part = fill(m.*part);
  for (const auto part : constants) scaled.*part = fill(m.*part);
  return scaled;
}

constexpr int32_t centre(int span) { return 16 * span + 8; }

// Calls see(hx, hy) for the span's corner pixels.
template <class See>
void each_corner(span_at s, See see) {
  for (int k = 0; k < 4; ++k) see(centre(s.x) + (k & 1 ? reach : -reach), centre(s.y) + (k & 2 ? reach : -reach));
}

bool w_changes_sign(const plane& p, span_at s) {
  bool above = false, below = false;
  each_corner(s, [&](int32_t hx, int32_t hy) { (p.w_at(hx, hy) > 0 ? above : below) = true; });
  return above && below;
}

// The product terms of a quantity cancel to less than 2^-bits of their sum.
bool cancels(int128 a, int128 b, int bits) { return size_of(a - b) <= (size_of(a) + size_of(b)) >> bits; }

bool is_flat(const plane& p, int32_t hx, int32_t hy) {
  const int128 w = p.w_at(hx, hy), nu = p.u_at(hx, hy), nv = p.v_at(hx, hy);
  const int128 ux = p.u.x * w, uy = p.u.y * w, vx = p.v.x * w, vy = p.v.y * w, gu = nu * p.w.x, hu = nu * p.w.y, gv = nv * p.w.x,
               hv = nv * p.w.y;
  if (cancels(ux, gu, 8) && cancels(uy, hu, 8) && cancels(vx, gv, 8) && cancels(vy, hv, 8)) return true;
  const int128 a = ux - gu, b = uy - hu, d = vx - gv, e = vy - hv;
  const int drop = std::max(0, std::max(std::max(bits_of(a), bits_of(b)), std::max(bits_of(d), bits_of(e))) - 60);
  return cancels((a >> drop) * (e >> drop), (b >> drop) * (d >> drop), 8);
}

bool has_far_corner(const plane& p, span_at s) {
  bool far = false;
  each_corner(s, [&](int32_t hx, int32_t hy) {
    const int128 w = p.w_at(hx, hy);
    far = far || (w > 0 && std::max(size_of(p.u_at(hx, hy)), size_of(p.v_at(hx, hy))) >= (32768 - 64) * w);
  });
  return far;
}

bool numerator_cancels(const plane& p, const linear_form& f, int32_t hx, int32_t hy) {
  const int64_t terms = int64_t(magnitude(f.c) + magnitude(f.x * (hx - p.origin_x)) + magnitude(f.y * (hy - p.origin_y)));
  return std::abs(p.value(f, hx, hy)) <= terms >> 5;
}

bool is_at_an_end(const plane& p, int32_t hx, int32_t hy) {
  const auto bits = [&](const linear_form& f) { return bit_length(magnitude(p.value(f, hx, hy))); };
  if (bits(p.w) >= 43 && std::max(bits(p.u), bits(p.v)) >= 57) return true;
  int zeros = 64;
  for (const linear_form* f : {&p.u, &p.v, &p.w})
    for (const int64_t x : {f->x, f->y, f->c}) zeros = std::min(zeros, std::countr_zero(uint64_t(x)));
  return zeros >= 24;
}

// In the outer eighth on either side of a screen of 4096 pixels.
bool is_outer(int32_t h, int32_t middle) { return std::abs(h - middle) >= max_screen_px * 3 / 4; }

// Where W passes zero along a row (or, with the axes exchanged, a column) of half pixels, if on the screen.
bool crossing(int64_t slope_w, int64_t at_origin, int32_t origin, int size_px, int& span) {
  if (slope_w == 0) return false;
  const int64_t h = origin - at_origin / slope_w;
  if (h < 0 || h >= 2 * size_px) return false;
  span = int(h / 16);
  return true;
}

}  // namespace

stress_plane_case make_stress_plane(stress_family family, uint64_t seed) {
  random_source r(seed);
  stress_plane_case c{};
  for (;;) {
    const bool far_origin = family == stress_family::cancelling;
    c.width_px = family == stress_family::wide_screen ? max_screen_px : far_origin ? 1024 + int(r.below(3073)) : any_side(r);
    c.height_px = family == stress_family::wide_screen && r.below(2) ? max_screen_px : far_origin ? 1024 + int(r.below(3073)) : any_side(r);
    sketch s;
    if (family == stress_family::extremes) {
      c.exact = extreme(r, c.width_px, c.height_px, s);
    } else {
      s = draw_sketch(family, r, c.width_px, c.height_px);
      c.exact = about(s);
    }
    c.x0 = s.x0;
    c.y0 = s.y0;
    if (make_plane(c.exact, {0, 0, c.width_px, c.height_px}, c.map) == status::ok) return c;
  }
}

span_list spans_to_visit(const stress_plane_case& c, uint64_t seed) {
  random_source r(seed ^ 0x5bd1e995);
  const int last_x = (c.width_px - 1) / span_side, last_y = (c.height_px - 1) / span_side;
  const int ax = c.x0 / span_side, ay = c.y0 / span_side;
  const plane& p = c.map;
  span_list list;
  const auto add = [&](int x, int y) {
    if (x >= 0 && y >= 0 && x <= last_x && y <= last_y) list.add(x, y);
  };
  list.add(ax, ay);
  add(ax - 1, ay);
  add(ax + 1, ay);
  add(ax, ay - 1);
  add(ax, ay + 1);
  int found = 0;
  for (int k = 0; k < 4; ++k) {  // where W passes zero, along the anchor's row and column and others
    const int row = k == 0 ? ay : int(r.below(uint32_t(last_y) + 1)), column = k == 0 ? ax : int(r.below(uint32_t(last_x) + 1));
    if (crossing(p.w.x, p.value(p.w, p.origin_x, centre(row)), p.origin_x, c.width_px, found)) list.add(found, row);
    if (crossing(p.w.y, p.value(p.w, centre(column), p.origin_y), p.origin_y, c.height_px, found)) list.add(column, found);
  }
  list.add(r.below(2) ? last_x : 0, r.below(2) ? last_y : 0);
  list.add(int(r.below(uint32_t(last_x) + 1)), int(r.below(uint32_t(last_y) + 1)));
  return list;
}

bool is_adverse(stress_family family, const plane& p, span_at s) {
  const int32_t hx = centre(s.x), hy = centre(s.y);
  const int64_t w = p.w_at(hx, hy);
  switch (family) {
    case stress_family::horizon:
      return int128(size_of(w)) <= 128 * int128(magnitude(p.w.x) + magnitude(p.w.y)) && (p.w.x | p.w.y) != 0;
    case stress_family::near_horizon:
      return w_changes_sign(p, s);
    case stress_family::edge_on:
      return is_flat(p, hx, hy);
    case stress_family::cancelling:
      return numerator_cancels(p, p.u, hx, hy) || numerator_cancels(p, p.v, hx, hy);
    case stress_family::far_coordinates:
      return has_far_corner(p, s);
    case stress_family::magnified:
      return w > 0 && exact_level(p, hx, hy) <= -std::log2(1000.0L);
    case stress_family::minified:
      return w > 0 && exact_level(p, hx, hy) >= 12;
    case stress_family::wide_screen:
      return is_outer(hx, p.origin_x) || is_outer(hy, p.origin_y);
    case stress_family::extremes:
      return is_at_an_end(p, hx, hy);
    default:
      return true;
  }
}

}  // namespace spantex::sim
