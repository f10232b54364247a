// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: nearest of planes that face the viewer (../vectors/affine_numbers.hpp). Included by ../avx512.cpp alone.
#pragma once

// Of spans with so many sections.
constexpr cut quads_of(int sections) { return sections == quads ? cut::square : cut::flat; }

// affine_numbers, what pixels add to their span's centre, and where sections begin.
struct affine_plane : affine_numbers {
  int sections, section_rows;              // sections of 8x8 texels: one of a span, two of its upper and lower half, four of its quads, or none; rows of texels that are taken of each
  alignas(64) int32_t u[most_scales][quads][16], v[most_scales][quads][16];
  alignas(64) int32_t least[quads][16];    // of a section: u of every scale in the lower half, v in the upper
  affine_step step_u, step_v;              // from one batch to the next
};

// False: the plane is drawn otherwise.
inline bool begin_affine(const plane& p, affine_plane& a) {
  if (!find_affine(p, a)) return false;
  // Texels side by side that width x height pixels need at most.
  const auto texels = [&](const int32_t* x, const int32_t* y, int width, int height) {
    int most = 0;
    for (int n = 0; n < a.scales; ++n) {
      const uint64_t apart = 2 * (magnitude(x[n]) * uint64_t(width - 1) + magnitude(y[n]) * uint64_t(height - 1)), below_one = (uint64_t(1) << (a.most_fraction - n)) - 1;
      most = max_of(most, int((apart + below_one) >> (a.most_fraction - n)) + 1);
    }
    return most;
  };
  const auto hold = [&](int width, int height) {
    a.section_rows = texels(a.v_x, a.v_y, width, height);
    return a.section_rows <= block_side && texels(a.u_x, a.u_y, width, height) <= block_side;
  };
  a.sections = hold(span_side, span_side) ? 1 : hold(span_side, span_side / 2) ? 2 : hold(quad_side, quad_side) ? quads : 0;
  const quad_cut& quad = cut_of(quads_of(a.sections));
  const auto lanes = [](const int32_t (&across)[quad_side], const int32_t (&down)[quad_side]) {
    const v16 rows = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
    return _mm512_add_epi32(_mm512_broadcast_i32x4(four(across)), _mm512_permutexvar_epi32(rows, _mm512_castsi128_si512(four(down))));
  };
  const v16 hx = lanes(quad.across.x, quad.down.x), hy = lanes(quad.across.y, quad.down.y);
  const auto spread = [&](int32_t x, int32_t y, int32_t (&to)[quads][16], int lane) {
    const auto along = [&](v16 steps_x, v16 steps_y) { return _mm512_add_epi32(_mm512_mullo_epi32(set32(x), steps_x), _mm512_mullo_epi32(set32(y), steps_y)); };
    v16 of[quads];
    of[0] = along(hx, hy);
    of[1] = _mm512_add_epi32(of[0], along(set32(quad.right_x), set32(quad.right_y)));
    const v16 below = along(set32(quad.below_x), set32(quad.below_y));
    of[2] = _mm512_add_epi32(of[0], below);
    of[3] = _mm512_add_epi32(of[1], below);
    for (int k = 0; k < quads; ++k) _mm512_store_si512(to[k], of[k]);
    for (int g = 0; g < a.sections; ++g) {
      v16 least = of[g * quads / a.sections];
      for (int k = g * quads / a.sections + 1; k < (g + 1) * quads / a.sections; ++k) least = _mm512_min_epi32(least, of[k]);
      a.least[g][lane] = _mm512_reduce_min_epi32(least);
    }
  };
  for (int n = 0; n < a.scales; ++n) {
    spread(a.u_x[n], a.u_y[n], a.u[n], n);
    spread(a.v_x[n], a.v_y[n], a.v[n], batch_size + n);
  }
  a.step_u = affine_step(p.u, a.w, batch_size);
  a.step_v = affine_step(p.v, a.w, batch_size);
  return true;
}

// Eight spans.
struct alignas(64) affine_batch {
  int32_t centre[2][batch_size], base[2][batch_size];  // u and v of the span's centre, counted from a texel; the texel, modulo the map's period
  int32_t fraction[batch_size], scale[batch_size];
  int32_t from[quads][2][batch_size];                  // leads from a pixel's offset to its texel in a section, rounding included
  int32_t row_at[quads][batch_size];                   // the section's first texel, in the map's rows
  uint32_t placed;                                     // bit k: the map holds the sections
};

// Plans of a row's batches, one after the other. Numerators are counted from the texels that are nearest the spans' centres, from batch to batch by an addition.
class affine_planner {
 public:
  SPANTEX_INLINE affine_planner(const row_work& work, const affine_plane& of) : map_(*work.texels), plane_(of) {
    const plane& p = *work.map;
    const int32_t cx = 2 * span_side * work.sx + span_side, cy = 2 * span_side * work.sy + span_side;
    const auto begin = [&](const linear_form& f, const affine_step& step, axis& a) SPANTEX_INLINED {
      const v8 spans = _mm512_mullo_epi64(_mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7), set(2 * span_side * f.x));
      divide(_mm512_add_epi64(set(p.value(f, cx, cy)), spans), a);
      a.texels = _mm256_set1_epi32(step.texels);
      a.step = set(step.rest);
    };
    begin(p.u, of.step_u, u_);
    begin(p.v, of.step_v, v_);
  }

  template <int Sections>
  SPANTEX_INLINE SPANTEX_WRAPS void next(affine_batch& b) {
    settle(u_);
    settle(v_);
    const v8 far_u = _mm512_abs_epi64(u_.c), far_v = _mm512_abs_epi64(v_.c);
    const v8 zeros = _mm512_lzcnt_epi64(_mm512_max_epu64(_mm512_add_epi64(far_u, set(plane_.reach_u)), _mm512_add_epi64(far_v, set(plane_.reach_v))));
    // quotient8()
    const v8 drop = _mm512_sub_epi64(of64<64 - 31>(), zeros);
    const auto mantissa = [&](v8 c, v8 far) SPANTEX_INLINED {
      const v8 product = _mm512_mul_epu32(_mm512_srlv_epi64(far, drop), set(plane_.w_inverse.y)), rounded = _mm512_srli_epi64(_mm512_add_epi64(product, of64<int64_t(1) << (affine_shift - 1)>()), affine_shift);
      return _mm512_mask_sub_epi64(rounded, _mm512_movepi64_mask(c), _mm512_setzero_si512(), rounded);
    };
    const v16 lower = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    const v16 centre = _mm512_permutex2var_epi32(mantissa(u_.c, far_u), lower, mantissa(v_.c, far_v));
    const v16 scale = _mm512_sub_epi32(set32(64 - plane_.least_bits), _mm512_permutex2var_epi32(zeros, lower, zeros)), fraction = _mm512_sub_epi32(set32(plane_.most_fraction), scale);
    const v16 start = _mm512_add_epi32(centre, _mm512_sllv_epi32(of32<1>(), _mm512_sub_epi32(fraction, of32<q.coordinate_bits + 1>()))), base = bases();
    _mm512_store_si512(b.centre, centre);
    _mm512_store_si512(b.base, base);
    put(b.fraction, _mm512_castsi512_si256(fraction));
    put(b.scale, _mm512_castsi512_si256(scale));
    const v16 of_axis = _mm512_add_epi32(scale, both_axes<0, batch_size>()), first = of32<-texel_apron>(), last = both_axes(map_.rows_across() + texel_apron - block_side, map_.rows_down() + texel_apron - block_side);
    __mmask16 held = Sections > 0 ? 0xFFFF : 0;
#pragma GCC unroll 4
    for (int g = 0; g < Sections; ++g) {
      const v16 texel = _mm512_srav_epi32(_mm512_add_epi32(start, _mm512_permutexvar_epi32(of_axis, _mm512_load_si512(plane_.least[g]))), fraction), at = _mm512_add_epi32(base, texel);
      held = __mmask16(held & _mm512_cmpge_epi32_mask(at, first) & _mm512_cmple_epi32_mask(at, last));
      _mm512_store_si512(b.from[g], _mm512_sub_epi32(start, _mm512_sllv_epi32(texel, fraction)));
      put(b.row_at[g], _mm256_add_epi32(_mm512_castsi512_si256(at), _mm256_mullo_epi32(_mm512_extracti64x4_epi64(at, 1), _mm256_set1_epi32(map_.row_stride()))));
    }
    b.placed = __mmask8(held & held >> batch_size);
    advance(u_);
    advance(v_);
  }

 private:
  struct axis {
    v8 c, step;            // numerators less base W; what is added for the next batch
    __m256i base, texels;  // and whole texels
  };

  SPANTEX_INLINE void divide(v8 n, axis& a) const {
    const inverse8 inverse{set(plane_.w_inverse.y), set(plane_.w_inverse.exponent)};
    __mmask8 near = 0xFF;
    const v8 base = whole_quotient8(n, set(spantex::bit_length(uint64_t(plane_.w))), inverse, near);
    a.c = _mm512_sub_epi64(n, _mm512_mullo_epi64(base, set(plane_.w)));
    a.base = narrowed(base);
  }
  SPANTEX_INLINE void settle(axis& a) const {
    if (_mm512_cmpgt_epu64_mask(_mm512_abs_epi64(a.c), set(most_certain(plane_))) == 0) [[likely]] return;
    divide(_mm512_add_epi64(a.c, _mm512_mullo_epi64(_mm512_cvtepi32_epi64(a.base), set(plane_.w))), a);
  }
  SPANTEX_INLINE void advance(axis& a) const {
    a.c = _mm512_add_epi64(a.c, a.step);
    a.base = _mm256_add_epi32(a.base, a.texels);
    const __mmask8 next = _mm512_cmpgt_epi64_mask(a.c, set(plane_.w / 2));
    a.c = _mm512_mask_sub_epi64(a.c, next, a.c, set(plane_.w));
    a.base = _mm256_mask_add_epi32(a.base, next, a.base, _mm256_set1_epi32(1));
  }
  SPANTEX_INLINE v16 bases() const {
    const int32_t across = map_.period_u(), down = map_.period_v();
    if ((across & (across - 1)) == 0 && (down & (down - 1)) == 0) [[likely]] {  // of 0, all bits
      return _mm512_and_si512(both_axes(u_.base, v_.base), both_axes(across - 1, down - 1));
    }
    return both_axes(narrowed(modulo(_mm512_cvtepi32_epi64(u_.base), across)), narrowed(modulo(_mm512_cvtepi32_epi64(v_.base), down)));
  }

  const planar_map& map_;
  const affine_plane& plane_;
  axis u_, v_;
};

SPANTEX_INLINE v16 moved(const int32_t (&offsets)[16], int32_t by) { return _mm512_add_epi32(_mm512_load_si512(offsets), set32(by)); }

// A span whose sections the map does not hold. Apart, so that what does the others keeps its registers.
template <bool Gathers, cut How>
[[gnu::noinline]] void draw_affine_beyond(const row_work& work, const affine_plane& of, const affine_batch& b, int k, int span) {
  const int scale = b.scale[k], bits = b.fraction[k];
  draw_beyond<Gathers, How>(work, work.sx + span, work.masks[span], [&](int n) SPANTEX_INLINED {
    return positions{moved(of.u[scale][n], b.centre[0][k]), moved(of.v[scale][n], b.centre[1][k]), b.base[0][k], b.base[1][k], bits, half_of(bits)};
  });
}

template <bool Gathers, int Sections, int TexelRows>
void draw_affine(const row_work& work, const affine_plane& of) {
  constexpr int pair = 2;  // batches, so that one's plan fills the gaps of the other's
  constexpr cut how = quads_of(Sections);
  constexpr int each = quads / max_of(Sections, 1);  // quads a section
  const planar_map& map = *work.texels;
  affine_planner plan(work, of);
  affine_batch two[pair];
  for (int first = 0; first < work.count; first += pair * batch_size) {
    for (affine_batch& b : two) plan.next<Sections>(b);
    for (int span = first; span < min_of(first + pair * batch_size, work.count); ++span) {
      if (work.masks[span] == 0) continue;
      const affine_batch& b = two[(span - first) / batch_size];
      const int k = (span - first) % batch_size;
      if (!(b.placed >> k & 1)) {
        draw_affine_beyond<Gathers, how>(work, of, b, k, span);
        continue;
      }
      const auto& u = of.u[b.scale[k]];
      const auto& v = of.v[b.scale[k]];
      v16 out[quads];
#pragma GCC unroll 4
      for (int g = 0; g < Sections; ++g) {
        const texel_rows<TexelRows> texels(map.row(0) + b.row_at[g][k], map.row_stride());
#pragma GCC unroll 4
        for (int n = g * each; n < (g + 1) * each; ++n)
          out[n] = texels.at(place_in_rows(moved(u[n], b.from[g][0][k]), moved(v[n], b.from[g][1][k]), set32(b.fraction[k]), set32(b.fraction[k] - 3)));
      }
      write(work, work.sx + span, work.masks[span], out, how);
    }
  }
}

// False: the row is drawn otherwise.
template <bool Gathers>
bool draw_affine_row(const row_work& work) {
  const affine_plane* const kept = work.memory->kept<affine_plane>([&](affine_plane& a) { return begin_affine(*work.map, a); });
  if (kept == nullptr || !is_near(work)) return false;
  const affine_plane& of = *kept;
  const auto by_rows = [&]<int Sections>() {
    if (of.section_rows <= 4) draw_affine<Gathers, Sections, 4>(work, of);
    else if (of.section_rows == 5) draw_affine<Gathers, Sections, 5>(work, of);
    else if (of.section_rows == 6) draw_affine<Gathers, Sections, 6>(work, of);
    else draw_affine<Gathers, Sections, 8>(work, of);
  };
  switch (of.sections) {
    case 1: by_rows.template operator()<1>(); break;
    case 2: by_rows.template operator()<2>(); break;
    case quads: by_rows.template operator()<quads>(); break;
    default: draw_affine<Gathers, 0, block_side>(work, of);
  }
  return true;
}
