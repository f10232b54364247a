// SPDX-License-Identifier: Apache-2.0
// Vector kernels: nearest of planes that face the viewer, of maps whose texels a mask wraps (affine_numbers.hpp). Included by the machines' files alone.
#pragma once

// affine_numbers, and the offsets from a span's centre to its first row of pixels.
struct affine_plane : affine_numbers {
  alignas(sizeof(v)) int32_t first_u[most_scales][span_side], first_v[most_scales][span_side];
  affine_step step_u, step_v;  // from one span to the next
};

// False: the plane is drawn otherwise.
inline bool begin_affine(const plane& p, affine_plane& a) {
  if (!find_affine(p, a)) return false;
  for (int n = 0; n < a.scales; ++n)
    for (int part = 0; part < parts; ++part) {
      const auto put_first = [&](int32_t (&to)[span_side], int32_t x, int32_t y) { put(to + width * part, form(1 << (a.most_fraction - n - q.coordinate_bits - 1), x, y, part).at); };
      put_first(a.first_u[n], a.u_x[n], a.u_y[n]);
      put_first(a.first_v[n], a.v_x[n], a.v_y[n]);
    }
  a.step_u = affine_step(p.u, a.w, 1);
  a.step_v = affine_step(p.v, a.w, 1);
  return true;
}

// Centres of a row's spans, one after the other, in general registers: a processor finds them while vectors still draw the span before.
class affine_centres {
 public:
  affine_centres(const row_work& work, const affine_plane& of) : numbers_(of), u_(work, work.map->u, of.step_u, of), v_(work, work.map->v, of.step_v, of) {}

  // An offset from a texel each.
  struct centre {
    int32_t u, v, base_u, base_v;
    int scale;
  };
  SPANTEX_INLINE centre next() {
    u_.settle(numbers_);
    v_.settle(numbers_);
    const uint64_t extent_u = u_.far + uint64_t(numbers_.reach_u), extent_v = v_.far + uint64_t(numbers_.reach_v);
    const int scale = 64 - numbers_.least_bits - __builtin_clzll(extent_u > extent_v ? extent_u : extent_v), drop = numbers_.least_bits + scale - 31;
    const centre of{u_.offset(numbers_, drop), v_.offset(numbers_, drop), u_.base, v_.base, scale};
    u_.advance(numbers_.w);
    v_.advance(numbers_.w);
    return of;
  }

 private:
  // No branch asks for a sign, which nothing foretells.
  struct axis {
    int64_t c;     // numerator less base W
    uint64_t far;  // |c|
    int32_t base;
    affine_step step;

    axis(const row_work& work, const linear_form& f, const affine_step& to_next, const affine_numbers& n) : step(to_next) {
      divide(work.map->value(f, 2 * span_side * work.sx + span_side, 2 * span_side * work.sy + span_side), n);
    }
    void divide(int64_t numerator, const affine_numbers& n) {
      bool in_range = true;
      base = detail::whole_quotient(numerator, n.w, n.w_inverse, in_range);
      take(numerator - base * n.w);
    }
    SPANTEX_INLINE void take(int64_t x) {
      c = x;
      far = uint64_t((x ^ x >> 63) - (x >> 63));
    }
    SPANTEX_INLINE void settle(const affine_numbers& n) {
      if (far > uint64_t(most_certain(n))) [[unlikely]] divide(c + base * n.w, n);
    }
    // quotient()
    SPANTEX_INLINE int32_t offset(const affine_numbers& n, int drop) const {
      const auto size = int32_t(((far >> drop) * n.w_inverse.y + (uint64_t(1) << (affine_shift - 1))) >> affine_shift), sign = int32_t(c >> 63);
      return (size ^ sign) - sign;
    }
    SPANTEX_INLINE void advance(int64_t w) {
      const int64_t next = c + step.rest, beyond = (w / 2 - next) >> 63;  // all ones: the next texel is nearer
      take(next - (w & beyond));
      base += step.texels - int32_t(beyond);
    }
  };

  const affine_numbers& numbers_;
  axis u_, v_;
};

// False: the row is drawn otherwise.
SPANTEX_INLINE bool draw_affine_row(const row_work& work) {
  const affine_plane* const found = work.memory->kept<affine_plane>([&](affine_plane& a) { return begin_affine(*work.map, a); });
  if (found == nullptr || !is_near(work)) return false;
  const affine_plane& common = *found;
  const row_levels& map = work.texels->levels_in_rows();
  on_level<int32_t> l;
  for (int k = 0; k < row_levels::field_count; ++k) l.field[k] = set(map.value(row_levels::field(k), 0));
  affine_centres centres(work, common);
  for (int k = 0; k < work.count; ++k) {
    const affine_centres::centre c = centres.next();
    if (work.masks[k] == 0) continue;
    const int fraction = common.most_fraction - c.scale;
    const v base = halves(set(c.base_u), set(c.base_v << 16)), down_u = set(2 * common.u_y[c.scale]), down_v = set(2 * common.v_y[c.scale]);
    alignas(sizeof(v)) int32_t places[span_pixel_count];
    v u[parts], w[parts];
    for (int part = 0; part < parts; ++part) {
      u[part] = get(common.first_u[c.scale] + width * part) + c.u;
      w[part] = get(common.first_v[c.scale] + width * part) + c.v;
    }
#pragma GCC unroll 2
    for (int n = 0; n < groups; ++n) {
      const int part = n / span_side;
      const v texels = halves(down_by(u[part], fraction), down_by(w[part], fraction - 16));
      put(places + n * width, places_of<true>(add16(base, texels), l));
      u[part] += down_u;
      w[part] += down_v;
    }
    write_texels(work, work.sx + k, work.masks[k], map.texels(), places);
  }
  return true;
}
