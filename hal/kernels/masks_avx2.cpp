// SPDX-License-Identifier: Apache-2.0
// AVX2: four spans at once that edges or depths leave out; of others a row of eight pixels at once.
#include "masks.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include "targets/avx2.hpp"

namespace spantex::kernels {
namespace {

uint32_t signs_of(__m256i lanes_of_64) { return uint32_t(_mm256_movemask_pd(_mm256_castsi256_pd(lanes_of_64))); }

constexpr int spans_at_once = 8;

uint32_t empty(const masked_polygon& p, const masked_row& row, int k) {
  __m256i outside[2] = {};
  for (int e = 0; e < p.edge_count; ++e) {
    const int64_t step = int64_t(p.edges[e].a) * span_side;
    const __m256i first = _mm256_add_epi64(_mm256_set1_epi64x(row.edge_at(p, e, k) + p.edges[e].most), _mm256_mul_epi32(_mm256_set1_epi64x(step), _mm256_setr_epi64x(0, 1, 2, 3)));
    outside[0] = _mm256_or_si256(outside[0], first);
    outside[1] = _mm256_or_si256(outside[1], _mm256_add_epi64(first, _mm256_set1_epi64x(4 * step)));
  }
  return signs_of(outside[0]) | signs_of(outside[1]) << 4;
}

SPANTEX_WRAPS uint32_t hidden(const masked_polygon& p, const masked_row& row, int k, int count) {
  if (row.floors == nullptr) return 0;
  const uint64_t step = p.depth_step();
  uint32_t bits = 0;
  for (int n = 0; n < count; n += 4) {
    const uint64_t at = uint64_t(row.nearest_of(p, k + n));
    const __m256i nearest = _mm256_setr_epi64x(int64_t(at), int64_t(at + step), int64_t(at + 2 * step), int64_t(at + 3 * step));
    const __m128i there = _mm_cmpgt_epi32(_mm_set1_epi32(count - n), _mm_setr_epi32(0, 1, 2, 3));
    const __m256i floors = _mm256_cvtepu32_epi64(_mm_maskload_epi32(reinterpret_cast<const int*>(row.floors + k + n), there));
    // nearest >> guard <= floor, where there is a floor
    const __m256i above = _mm256_slli_epi64(_mm256_add_epi64(floors, _mm256_set1_epi64x(1)), depth_guard_bits);
    bits |= signs_of(_mm256_andnot_si256(_mm256_cmpeq_epi64(floors, _mm256_setzero_si256()), _mm256_cmpgt_epi64(above, nearest))) << n;
  }
  return bits;
}

// Edges' values and depths in a row of pixels, less those of the first one.
class pixel_lanes {
 public:
  SPANTEX_WRAPS void prepare(const masked_polygon& p) {
    if (prepared_) return;
    prepared_ = true;
    const uint64_t right = 2 * uint64_t(p.shape.depth.x);
    const auto pixel = [&](uint64_t k) SPANTEX_WRAPS { return int64_t(right * k); };
    some_depths_ = _mm256_setr_epi64x(pixel(0), pixel(1), pixel(4), pixel(5));  // as shuffles take them
    other_depths_ = _mm256_setr_epi64x(pixel(2), pixel(3), pixel(6), pixel(7));
    for (int e = 0; e < p.edge_count; ++e) of_[e] = _mm256_mullo_epi32(_mm256_set1_epi32(p.edges[e].a), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  }
  __m256i of(int e) const { return of_[e]; }
  __m256i some_depths() const { return some_depths_; }
  __m256i other_depths() const { return other_depths_; }

 private:
  bool prepared_ = false;
  __m256i of_[max_edges], some_depths_, other_depths_;
};

span_mask covered(const masked_polygon& p, const masked_row& row, const pixel_lanes& lanes, int k) {
  __m256i outside[span_side] = {};
  for (int e = 0; e < p.edge_count; ++e) {
    const __m256i down = _mm256_set1_epi32(p.edges[e].b);
    __m256i value = _mm256_add_epi32(lanes.of(e), _mm256_set1_epi32(row.near_edge(p, e, k)));
    for (int j = 0; j < span_side; ++j, value = _mm256_add_epi32(value, down)) outside[j] = _mm256_or_si256(outside[j], value);
  }
  span_mask bits = 0;
  for (int j = 0; j < span_side; ++j) bits |= span_mask(uint32_t(_mm256_movemask_ps(_mm256_castsi256_ps(outside[j])))) << (span_side * j);
  return ~bits;
}

SPANTEX_WRAPS span_mask nearer(const masked_polygon& p, const pixel_lanes& lanes, int64_t depth, int32_t sx, int32_t sy, span_mask mask) {
  const __m256i down = _mm256_set1_epi64x(int64_t(2 * uint64_t(p.shape.depth.y))), pixels = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  __m256i some = _mm256_add_epi64(_mm256_set1_epi64x(depth), lanes.some_depths()), others = _mm256_add_epi64(_mm256_set1_epi64x(depth), lanes.other_depths());
  uint32_t* row = p.depths_of(sx, sy);
  const __m256i stores = _mm256_set1_epi32(p.stores ? -1 : 0);
  __m256i farthest = _mm256_set1_epi32(-1);
  span_mask visible = 0;
  for (int j = 0; j < span_side; ++j, row += p.frame_width, some = _mm256_add_epi64(some, down), others = _mm256_add_epi64(others, down)) {
    const __m256i z = _mm256_castps_si256(_mm256_shuffle_ps(_mm256_castsi256_ps(_mm256_srli_epi64(some, depth_guard_bits)), _mm256_castsi256_ps(_mm256_srli_epi64(others, depth_guard_bits)), 0x88));
    const __m256i stored = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row));
    const __m256i covered = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(int(mask >> (span_side * j) & 0xFF)), pixels), pixels);
    const __m256i seen = _mm256_andnot_si256(_mm256_cmpeq_epi32(_mm256_min_epu32(z, stored), z), covered);
    const __m256i now = _mm256_blendv_epi8(stored, z, _mm256_and_si256(seen, stores));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(row), now);
    farthest = _mm256_min_epu32(farthest, now);
    visible |= span_mask(uint32_t(_mm256_movemask_ps(_mm256_castsi256_ps(seen)))) << (span_side * j);
  }
  __m128i least = _mm_min_epu32(_mm256_castsi256_si128(farthest), _mm256_extracti128_si256(farthest, 1));
  least = _mm_min_epu32(least, _mm_shuffle_epi32(least, 0x4E));
  p.raise_floor(sx, sy, uint32_t(_mm_cvtsi128_si32(_mm_min_epu32(least, _mm_shuffle_epi32(least, 0xB1)))));
  return visible;
}

#include "vectors/masks.hpp"

}  // namespace
}  // namespace spantex::kernels

#include "targets/end.hpp"

namespace spantex::kernels {
row_cover avx2_cover() { return avx2_kernel() != nullptr ? cover_row : nullptr; }
}  // namespace spantex::kernels
#else
namespace spantex::kernels {
row_cover avx2_cover() { return nullptr; }
}  // namespace spantex::kernels
#endif
