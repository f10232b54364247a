// SPDX-License-Identifier: Apache-2.0
// Kernels: planes that face the viewer, turned and scaled as they like. W is constant: pixels lie as far from their span's centre as in any other span, and nothing is divided
// from one span to the next. Included by the machines' files alone.
#pragma once

// What the spans of a plane have in common. The farther a span reaches from the texel that is nearest its centre, the fewer bits of fraction its offsets have: on scale n its
// numerators have least_bits + n bits.
struct affine_numbers {
  static constexpr int most_scales = 3;  // extents are W/8 or more, and W/2 more at most

  int64_t w;
  inverse w_inverse;
  int64_t reach_u, reach_v;                // numerators of pixels lie so far from their span's centre at most
  int least_bits, most_fraction, scales;   // bits of fraction on scale 0
  int32_t u_x[most_scales], u_y[most_scales], v_x[most_scales], v_y[most_scales];  // mantissas: steps of half a pixel
};

// Whether W is constant, and texels are neither too near each other nor too far for 32 bits.
inline bool is_affine(const plane& p, uint64_t reach) {
  if (p.w.x != 0 || p.w.y != 0 || p.w.c <= 0) return false;
  const int w_bits = spantex::bit_length(uint64_t(p.w.c)), reach_bits = spantex::bit_length(reach);
  // With 31 bits of fraction, the most, a section of two texels fits 32 bits, and no offset reaches farther. Set-up leaves extents more than 31 bits.
  return reach_bits >= max_of(31, w_bits - 2) && reach_bits <= w_bits + max_extent_log2 - 2 && rounding_is_small(p, p.w.c, 15);
}

// Whether bases of all spans have 15 bits.
inline bool is_near(const row_work& work) {
  const plane& p = *work.map;
  const auto is_near_at = [&](int32_t sx) {
    const int32_t cx = 2 * span_side * sx + span_side, cy = 2 * span_side * work.sy + span_side;
    return magnitude(p.value(p.u, cx, cy)) >> 14 < uint64_t(p.w.c) && magnitude(p.value(p.v, cx, cy)) >> 14 < uint64_t(p.w.c);
  };
  return is_near_at(work.sx) && is_near_at(work.sx + work.count - 1);
}

// False: the plane is drawn otherwise.
inline bool find_affine(const plane& p, affine_numbers& a) {
  const auto reach_of = [](const linear_form& f) { return 7 * (magnitude(f.x) + magnitude(f.y)); };
  const uint64_t reach_u = reach_of(p.u), reach_v = reach_of(p.v), reach = reach_u > reach_v ? reach_u : reach_v;
  if (!is_affine(p, reach)) return false;
  a.w = p.w.c;
  a.w_inverse = invert(a.w);
  a.reach_u = int64_t(reach_u);
  a.reach_v = int64_t(reach_v);
  a.least_bits = spantex::bit_length(reach);
  a.most_fraction = q.offset_bits - 2 + spantex::bit_length(uint64_t(a.w)) - a.least_bits;
  a.scales = spantex::bit_length(reach + uint64_t(a.w / 2 + a.w / 1024)) - a.least_bits + 1;
  for (int n = 0; n < a.scales; ++n) {
    const auto mantissa = [&](int64_t of) { return quotient(of, a.least_bits + n - 31, a.w_inverse, a.most_fraction - n); };
    a.u_x[n] = mantissa(p.u.x);
    a.u_y[n] = mantissa(p.u.y);
    a.v_x[n] = mantissa(p.v.x);
    a.v_y[n] = mantissa(p.v.y);
  }
  return true;
}

// quotient()'s shift of an offset's mantissa, on any scale.
constexpr int affine_shift = 64 - q.offset_bits;

// How far apart spans' centres lie that lie so many spans apart: whole texels, and the rest of the numerator.
struct affine_step {
  int32_t texels = 0;
  int64_t rest = 0;
  affine_step() = default;
  affine_step(const linear_form& f, int64_t w, int spans) {
    const int64_t step = f.x * (2 * span_side * spans), whole = step / w - (step % w < 0);
    texels = int32_t(whole);
    rest = step - whole * w;
  }
};

// Where two texels are as near as each other, or nearly, it takes the division to tell which is the nearest: numerators farther than this from one.
inline int64_t most_certain(const affine_numbers& a) { return a.w / 2 - a.w / 4096; }
