// SPDX-License-Identifier: Apache-2.0
// Integer primitives below the fixed-point types: bit lengths, rounded shifts, magnitudes.
// None can overflow on its documented domain; none has undefined behaviour.
#pragma once
#if __cplusplus < 201709L
#error spantex needs C++20: compile with -std=c++20 or -std=gnu++20
#endif
#include <stdint.h>

// Marks functions whose unsigned arithmetic is meant to wrap, for sanitizers that report it otherwise.
#if defined(__clang__)
#define SPANTEX_WRAPS __attribute__((no_sanitize("unsigned-integer-overflow")))
#else
#define SPANTEX_WRAPS
#endif
// A function whose frame is not to lie under what its caller calls next, where code and stack are to be small.
#ifdef __OPTIMIZE_SIZE__
#define SPANTEX_FRAME_APART [[gnu::noinline]]
#define SPANTEX_FRAME_MERGED [[gnu::always_inline]]  // and one that is to be part of its caller's
#else
#define SPANTEX_FRAME_APART
#define SPANTEX_FRAME_MERGED
#endif

namespace spantex {

// Of this translation unit, so not the same in all of a program: what depends on it is to have another type.
#ifdef __OPTIMIZE_SIZE__
constexpr bool optimised_for_size = true;
#else
constexpr bool optimised_for_size = false;
#endif

// How a stage drops bits. `floor` is towards minus infinity, `nearest` rounds halves up (towards plus
// infinity), `even` rounds halves to the even neighbour.
enum class rounding : uint8_t { floor, nearest, even };

// Number of bits needed to write x: 0 for 0, otherwise floor(log2 x) + 1.
constexpr int bit_length(uint64_t x) { return x == 0 ? 0 : 64 - __builtin_clzll(x); }

SPANTEX_WRAPS constexpr uint64_t magnitude(int64_t x) { return x < 0 ? 0 - uint64_t(x) : uint64_t(x); }

// ARMv6-M has products of 32 bits only; compilers call one of 64 bits there.
#if defined(__ARM_ARCH_6M__)
constexpr bool products_are_calls = true;
#else
constexpr bool products_are_calls = false;
#endif

// 32 x 32 -> 64.
constexpr uint64_t multiply_32(uint32_t a, uint32_t b) {
#if defined(__ARM_ARCH_6M__)
  const uint32_t a0 = a & 0xFFFF, a1 = a >> 16, b0 = b & 0xFFFF, b1 = b >> 16;
  const uint32_t low = a0 * b0, first = a0 * b1 + (low >> 16), second = a1 * b0 + (first & 0xFFFF);
  return uint64_t(a1 * b1 + (first >> 16) + (second >> 16)) << 32 | (second << 16 | (low & 0xFFFF));
#else
  return uint64_t(a) * b;
#endif
}

// a b, which fits, in products of 32 bits.
SPANTEX_WRAPS constexpr int64_t multiply_in_pieces(int64_t a, int32_t b) {
  const uint32_t low = uint32_t(a), a0 = low & 0xFFFF, a1 = low >> 16, b0 = uint32_t(b) & 0xFFFF;
  const int32_t b1 = b >> 16;
  const uint32_t bottom = a0 * b0, first = a1 * b0 + (bottom >> 16);
  const int32_t second = int32_t(a0) * b1 + int32_t(first & 0xFFFF);
  const uint32_t top = uint32_t(int32_t(a1) * b1) + (first >> 16) + uint32_t(second >> 16) + uint32_t(a >> 32) * uint32_t(b);
  return int64_t(uint64_t(top) << 32 | (uint32_t(second) << 16 | (bottom & 0xFFFF)));
}
// a b, which fits. ARMv6-M's compilers call a product of two numbers of 64 bits for it.
#if defined(__ARM_ARCH_6M__) && !defined(__OPTIMIZE_SIZE__)
[[gnu::noinline]] constexpr int64_t multiply_by_32(int64_t a, int32_t b) { return a == 0 ? 0 : multiply_in_pieces(a, b); }
constexpr uint64_t multiply_by_31(uint64_t a, int32_t b) { return uint64_t(multiply_by_32(int64_t(a), b)); }
#else
constexpr int64_t multiply_by_32(int64_t a, int32_t b) { return a * b; }
constexpr uint64_t multiply_by_31(uint64_t a, int32_t b) { return a * uint32_t(b); }  // b >= 0
#endif

constexpr int max_of(int a, int b) { return a > b ? a : b; }
constexpr int min_of(int a, int b) { return a < b ? a : b; }

// The bounds take the type of x: int32_t is int on some targets and long on others.
template <class T> struct type_of_value { using type = T; };
template <class T>
constexpr T clamp_to(T x, typename type_of_value<T>::type low, typename type_of_value<T>::type high) {
  return x < low ? low : x > high ? high : x;
}

// x / 2^shift, rounded. Domain: 0 <= shift <= 62, |x| <= 2^63 - 2^(shift-1) - 1 (the addend must fit).
template <class Int>
constexpr Int shift_right(Int x, int shift, rounding mode = rounding::nearest) {
  if (shift <= 0) return x;
  if (mode == rounding::floor) return Int(x >> shift);
  const Int half = Int(Int(1) << (shift - 1));
  if (mode == rounding::nearest) return Int((x + half) >> shift);
  const Int odd = Int((x >> shift) & 1);
  return Int((x + half - 1 + odd) >> shift);
}

// To nearest, halves away from zero: f(-x) = -f(x), so that a mirrored plane gives the mirrored picture.
template <class Int>
constexpr Int shift_right_symmetric(Int x, int shift) {
  return x < 0 ? Int(-shift_right(Int(-x), shift)) : shift_right(x, shift);
}

// As shift_right for any sign of shift; a negative one scales up. The caller guarantees that the result fits.
template <class Int>
constexpr Int scale_down(Int x, int shift, rounding mode = rounding::nearest) {
  return shift >= 0 ? shift_right(x, shift, mode) : Int(x * (Int(1) << -shift));
}

// round(x / 255) for x <= 65535 - 128, which 255 * 255 is; no halves occur, 255 is odd.
constexpr uint32_t over_255(uint32_t x) {
  x += 128;
  return (x + (x >> 8)) >> 8;
}

}  // namespace spantex
