// SPDX-License-Identifier: Apache-2.0
// AVX-512: eight spans at once that edges or depths leave out; of others sixteen pixels at once, eight where depths are compared.
#include "masks.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include "targets/avx512.hpp"

namespace spantex::kernels {
namespace {

constexpr int spans_at_once = 8;

// 0, step, 2 step, ... 7 step
__m512i steps_of(uint64_t step) { return _mm512_mullo_epi64(_mm512_set1_epi64(int64_t(step)), _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7)); }

uint32_t empty(const masked_polygon& p, const masked_row& row, int k) {
  __m512i outside = _mm512_setzero_si512();
  for (int e = 0; e < p.edge_count; ++e)
    outside = _mm512_or_si512(outside, _mm512_add_epi64(_mm512_set1_epi64(row.edge_at(p, e, k) + p.edges[e].most), steps_of(uint64_t(int64_t(p.edges[e].a) * span_side))));
  return _mm512_movepi64_mask(outside);
}

uint32_t hidden(const masked_polygon& p, const masked_row& row, int k, int count) {
  if (row.floors == nullptr) return 0;
  const __m512i nearest = _mm512_add_epi64(_mm512_set1_epi64(row.nearest_of(p, k)), steps_of(p.depth_step()));
  const __m512i floors = _mm512_cvtepu32_epi64(_mm256_maskz_loadu_epi32(uint8_t((1 << count) - 1), row.floors + k));
  return _mm512_mask_cmpge_epi64_mask(_mm512_test_epi64_mask(floors, floors), floors, _mm512_srai_epi64(nearest, depth_guard_bits));
}

// Edges' values in two rows of pixels, and depths in one, less those of the first pixel.
class pixel_lanes {
 public:
  SPANTEX_WRAPS void prepare(const masked_polygon& p) {
    if (prepared_) return;
    prepared_ = true;
    depths_ = steps_of(2 * uint64_t(p.shape.depth.x));
    const __m512i columns = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7), second_row = _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, -1, -1, -1, -1, -1, -1, -1, -1);
    for (int e = 0; e < p.edge_count; ++e)
      of_[e] = _mm512_add_epi32(_mm512_mullo_epi32(_mm512_set1_epi32(p.edges[e].a), columns), _mm512_and_si512(_mm512_set1_epi32(p.edges[e].b), second_row));
  }
  __m512i of(int e) const { return of_[e]; }
  __m512i depths() const { return depths_; }

 private:
  bool prepared_ = false;
  __m512i of_[max_edges], depths_;
};

span_mask covered(const masked_polygon& p, const masked_row& row, const pixel_lanes& lanes, int k) {
  __m512i outside[4] = {};
  for (int e = 0; e < p.edge_count; ++e) {
    const __m512i upper = _mm512_add_epi32(lanes.of(e), _mm512_set1_epi32(row.near_edge(p, e, k)));
    for (int q = 0; q < 4; ++q) outside[q] = _mm512_or_si512(outside[q], _mm512_add_epi32(upper, _mm512_set1_epi32(2 * q * p.edges[e].b)));
  }
  span_mask bits = 0;
  for (int q = 0; q < 4; ++q) bits |= span_mask(_mm512_movepi32_mask(outside[q])) << (16 * q);
  return ~bits;
}

SPANTEX_WRAPS span_mask nearer(const masked_polygon& p, const pixel_lanes& lanes, int64_t depth, int32_t sx, int32_t sy, span_mask mask) {
  const __m512i down = _mm512_set1_epi64(int64_t(2 * uint64_t(p.shape.depth.y)));
  __m512i across = _mm512_add_epi64(_mm512_set1_epi64(depth), lanes.depths());
  uint32_t* row = p.depths_of(sx, sy);
  const __mmask8 stores = p.stores ? 0xFF : 0;
  __m256i farthest = _mm256_set1_epi32(-1);
  span_mask visible = 0;
  for (int j = 0; j < span_side; ++j, row += p.frame_width, across = _mm512_add_epi64(across, down)) {
    const __m256i z = _mm512_cvtepi64_epi32(_mm512_srli_epi64(across, depth_guard_bits)), stored = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row));
    const __mmask8 seen = _mm256_mask_cmpgt_epu32_mask(uint8_t(mask >> (span_side * j)), z, stored);
    const __m256i now = _mm256_mask_mov_epi32(stored, seen & stores, z);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(row), now);
    farthest = _mm256_min_epu32(farthest, now);
    visible |= span_mask(seen) << (span_side * j);
  }
  p.raise_floor(sx, sy, _mm512_mask_reduce_min_epu32(0xFF, _mm512_castsi256_si512(farthest)));
  return visible;
}

#include "vectors/masks.hpp"

}  // namespace
}  // namespace spantex::kernels

#include "targets/end.hpp"

namespace spantex::kernels {
row_cover avx512_cover() { return avx512_loads_kernel() != nullptr ? cover_row : nullptr; }
}  // namespace spantex::kernels
#else
namespace spantex::kernels {
row_cover avx512_cover() { return nullptr; }
}  // namespace spantex::kernels
#endif
