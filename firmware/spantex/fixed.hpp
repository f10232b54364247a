// SPDX-License-Identifier: Apache-2.0
// Fixed point whose format is its type.
//
//   s<I, F>   signed,   I integer bits (without the sign), F fraction bits: value = raw / 2^F, |value| <= 2^I
//   u<I, F>   unsigned, I integer bits, F fraction bits
//
// Widths grow inside expressions by the table below; only widening is implicit. Every loss of bits is a named
// function: floor_to, round_to, sat_to, wrap_to, trust_to. A result of more than 64 bits is a compile error.
//
//   a + b     max(Ia, Ib) + 1, max(Fa, Fb)         signed if either is
//   a - b     max(Ia, Ib) + 1, max(Fa, Fb)         signed
//   -a        Ia + 1, Fa                           signed
//   a * b     Ia + Ib (+ 1 if both are signed), Fa + Fb
//
// I or F may be negative (a format whose top or bottom bits are known to be absent); I + F must be positive.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>

namespace spantex {
namespace detail {
template <bool Signed, bool Wide> struct rep;
template <> struct rep<true, false> { using type = int32_t; };
template <> struct rep<true, true> { using type = int64_t; };
template <> struct rep<false, false> { using type = uint32_t; };
template <> struct rep<false, true> { using type = uint64_t; };
}  // namespace detail

template <bool Signed, int I, int F>
class fixed {
 public:
  static constexpr bool is_signed = Signed;
  static constexpr int integer_bits = I;
  static constexpr int fraction_bits = F;
  static constexpr int bits = I + F + (Signed ? 1 : 0);
  static_assert(I + F >= 1, "spantex: a format needs at least one bit");
  static_assert(bits <= 64, "spantex: a format of more than 64 bits; narrow an operand by name first");
  using rep = typename detail::rep<Signed, (bits > 32)>::type;

  constexpr fixed() = default;

  // Widening: every value of the source is a value of this format.
  template <bool S2, int I2, int F2>
  constexpr fixed(fixed<S2, I2, F2> x) : raw_(rep(x.raw()) * (rep(1) << (F - F2))) {
    static_assert(I2 <= I && F2 <= F && (Signed || !S2),
                  "spantex: implicit conversion would lose bits; use floor_to, round_to, sat_to or wrap_to");
  }

  static constexpr fixed from_raw(rep raw) { fixed x; x.raw_ = raw; return x; }
  static constexpr rep raw_min() { return Signed ? rep(-raw_max() - 1) : rep(0); }
  static constexpr rep raw_max() {
    if constexpr (Signed) return rep((uint64_t(1) << (I + F)) - 1);
    else return I + F == 64 ? rep(~uint64_t(0)) : rep((uint64_t(1) << ((I + F) & 63)) - 1);
  }
  constexpr rep raw() const { return raw_; }

 private:
  rep raw_ = 0;
};

template <int I, int F> using s = fixed<true, I, F>;
template <int I, int F> using u = fixed<false, I, F>;

// An integer constant in the smallest format that holds it.
template <int64_t N>
constexpr auto constant() {
  constexpr int width = max_of(1, bit_length(magnitude(N)));
  if constexpr (N < 0) return s<width, 0>::from_raw(N);
  else return u<width, 0>::from_raw(N);
}

template <bool Sa, int Ia, int Fa, bool Sb, int Ib, int Fb>
constexpr auto operator+(fixed<Sa, Ia, Fa> a, fixed<Sb, Ib, Fb> b) {
  using sum = fixed<(Sa || Sb), max_of(Ia, Ib) + 1, max_of(Fa, Fb)>;
  return sum::from_raw(sum(a).raw() + sum(b).raw());
}

template <bool Sa, int Ia, int Fa, bool Sb, int Ib, int Fb>
constexpr auto operator-(fixed<Sa, Ia, Fa> a, fixed<Sb, Ib, Fb> b) {
  using difference = fixed<true, max_of(Ia, Ib) + 1, max_of(Fa, Fb)>;
  return difference::from_raw(difference(a).raw() - difference(b).raw());
}

template <bool S, int I, int F>
constexpr auto operator-(fixed<S, I, F> a) {
  using negated = fixed<true, I + 1, F>;
  return negated::from_raw(-negated(a).raw());
}

template <bool Sa, int Ia, int Fa, bool Sb, int Ib, int Fb>
constexpr auto operator*(fixed<Sa, Ia, Fa> a, fixed<Sb, Ib, Fb> b) {
  using product = fixed<(Sa || Sb), Ia + Ib + (Sa && Sb ? 1 : 0), Fa + Fb>;
  using rep = typename product::rep;
  return product::from_raw(rep(a.raw()) * rep(b.raw()));
}

// Comparison is exact, whatever the two formats.
template <bool Sa, int Ia, int Fa, bool Sb, int Ib, int Fb>
constexpr bool operator<(fixed<Sa, Ia, Fa> a, fixed<Sb, Ib, Fb> b) { return (a - b).raw() < 0; }
template <bool Sa, int Ia, int Fa, bool Sb, int Ib, int Fb>
constexpr bool operator>(fixed<Sa, Ia, Fa> a, fixed<Sb, Ib, Fb> b) { return b < a; }
template <bool Sa, int Ia, int Fa, bool Sb, int Ib, int Fb>
constexpr bool operator==(fixed<Sa, Ia, Fa> a, fixed<Sb, Ib, Fb> b) { return (a - b).raw() == 0; }

// --- named losses -------------------------------------------------------------------------------------

// Drops fraction bits towards minus infinity.
template <int NewF, bool S, int I, int F>
constexpr fixed<S, I, NewF> floor_to(fixed<S, I, F> x) {
  static_assert(NewF <= F, "spantex: floor_to widens; a plain conversion does that");
  return fixed<S, I, NewF>::from_raw(typename fixed<S, I, NewF>::rep(x.raw() >> (F - NewF)));
}

// Drops fraction bits to nearest, halves up: one more integer bit, for the carry.
template <int NewF, bool S, int I, int F>
constexpr fixed<S, I + 1, NewF> round_to(fixed<S, I, F> x) {
  static_assert(NewF <= F, "spantex: round_to widens; a plain conversion does that");
  if constexpr (NewF == F) return x;
  else {
    const fixed<S, I + 1, F> wide = x;
    using rep = typename fixed<S, I + 1, NewF>::rep;
    return fixed<S, I + 1, NewF>::from_raw(
        rep((wide.raw() + (typename fixed<S, I + 1, F>::rep(1) << (F - NewF - 1))) >> (F - NewF)));
  }
}

// To the nearest end of the target's range.
template <class Target, bool S, int I, int F>
constexpr Target sat_to(fixed<S, I, F> x) {
  static_assert(Target::fraction_bits == F, "spantex: sat_to changes the range only; round first");
  using wide = fixed<true, max_of(I, Target::integer_bits) + (S && Target::is_signed ? 0 : 1), F>;
  const auto v = wide(x).raw();
  const auto low = typename wide::rep(Target::raw_min()), high = typename wide::rep(Target::raw_max());
  return Target::from_raw(typename Target::rep(v < low ? low : v > high ? high : v));
}

// Modulo the target's range (two's complement).
template <class Target, bool S, int I, int F>
constexpr Target wrap_to(fixed<S, I, F> x) {
  static_assert(Target::fraction_bits == F, "spantex: wrap_to changes the range only; round first");
  constexpr int drop = int(sizeof(typename Target::rep)) * 8 - Target::bits;
  using unsigned_rep = typename detail::rep<false, (Target::bits > 32)>::type;
  const auto top = typename Target::rep(unsigned_rep(x.raw()) << drop);
  return Target::from_raw(typename Target::rep(top >> drop));
}

// Where a proof (named at the call) says that the value fits. Checked in debug builds.
template <class Target, bool S, int I, int F>
constexpr Target trust_to(fixed<S, I, F> x) {
  static_assert(Target::fraction_bits == F, "spantex: trust_to changes the range only; round first");
#ifdef SPANTEX_CHECK_TRUST
  if (!(sat_to<Target>(x).raw() == typename Target::rep(x.raw()))) __builtin_trap();
#endif
  return Target::from_raw(typename Target::rep(x.raw()));
}

}  // namespace spantex
