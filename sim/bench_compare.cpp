// SPDX-License-Identifier: Apache-2.0
#include "bench_compare.hpp"

#include <sim/random.hpp>
#include <spantex/filter.hpp>
#include <spantex/texture.hpp>

namespace spantex::sim {

const char* to_string(stage s) {
  switch (s) {
    case stage::answers: return "answers";
    case stage::finer_memory: return "finer local memory";
    case stage::finer_filter: return "bilinear filter";
    case stage::write_out: return "write-out";
    case stage::coordinates: return "coordinates or correction";
    case stage::level: return "level of detail";
    case stage::coarser_level: return "coarser level";
    case stage::footprint: return "the filter's own part";
    case stage::not_repeatable: return "not repeatable";
  }
  return "unknown";
}

namespace {

std::string colour(rgba8 c) {
  return std::to_string(c.r) + " " + std::to_string(c.g) + " " + std::to_string(c.b) + " " + std::to_string(c.a);
}

// Affine, one texel a pixel, on level 0; positions (x, y) + 1/2 + (fraction_u, fraction_v)/256 of the finer memory.
span_coefficients plain(int32_t x, int32_t y, filter kind, int fraction_u, int fraction_v) {
  span_coefficients c{};
  c.exponent = 11;  // within the shortest offsets
  c.base_u = x + 4;
  c.base_v = y + 4;
  c.a_u = c.b_v = 1 << 10;
  c.c_u = fraction_u << 3;
  c.c_v = fraction_v << 3;
  c.how = evaluation::affine;
  c.kind = kind;
  c.fine = {x, y, uint32_t(1) << 31, uint32_t(1) << 31, 0, false, false};
  return c;
}

// The span's own positions, one sample a pixel: where a pixel stands about its own centre, only that.
span_coefficients positions_of(span_coefficients c) {
  c.kind = filter::bilinear;
  c.two_levels = false;
  c.axis.partial = false;
  if (c.centred) c.a_u = c.b_u = c.a_v = c.b_v = c.g = c.h = 0;
  c.centred = false;
  return c;
}

constexpr int finer_words(int fine_side) { return fine_side * fine_side / 2; }

}  // namespace

std::string first_difference::text() const {
  const std::string at = "span (" + std::to_string(span_x) + ", " + std::to_string(span_y) + ")";
  const std::string op = "operation " + std::to_string(operation_index) + ", " + spantex::to_string(what) + " of half " + std::to_string(int(which)) + ", " + at;
  if (pixel < 0) return op + ": the simulator says '" + spantex::to_string(wanted_status) + "', the device '" + spantex::to_string(got_status) + "'";
  return op + ", pixel (" + std::to_string(pixel % span_side) + ", " + std::to_string(pixel / span_side) + "), stage: " + to_string(where) + ": the simulator has " +
         colour(wanted) + ", the device " + colour(got);
}

// The device's own failures pass; where only one of the two refuses, that is a difference.
status comparing_engine::both(half h, operation what, status tested, status wanted) {
  ++operations_;
  if (tested == status::device_error || tested == status::device_timeout || tested == wanted) return tested;
  if (!difference_) {
    first_difference d;
    d.what = what;
    d.which = h;
    const uint32_t span = what == operation::take ? memory_[int(h)].span : marked_;  // the other half may be further on
    d.span_x = int32_t(span & 0xFFFF);
    d.span_y = int32_t(span >> 16);
    d.wanted_status = wanted;
    d.got_status = tested;
    d.operation_index = operations_ - 1;
    difference_ = d;
  }
  return status::mismatch;
}

status comparing_engine::load_coefficients(half h, const span_coefficients& c) {
  memory_[int(h)].coefficients = c;
  return both(h, operation::load_coefficients, tested_.load_coefficients(h, c), wanted_.load_coefficients(h, c));
}

status comparing_engine::load_words(half h, int first, const uint64_t* words, int count) {
  for (int k = 0; first >= 0 && k < count && first + k < word_count(); ++k) memory_[int(h)].words[size_t(first + k)] = words[k];
  return both(h, operation::load_words, tested_.load_words(h, first, words, count), wanted_.load_words(h, first, words, count));
}

status comparing_engine::start(half h, span_mask mask) {
  memory_[int(h)].mask = mask;
  memory_[int(h)].span = marked_;
  return both(h, operation::start, tested_.start(h, mask), wanted_.start(h, mask));
}

void comparing_engine::mark(event what) {
  ++operations_;
  if (what.kind == event_kind::span) marked_ = what.value;
  tested_.mark(what);
  wanted_.mark(what);
}

status comparing_engine::take(half h, span_pixels& out) {
  span_pixels wanted{};
  const memory& m = memory_[int(h)];
  SPANTEX_TRY(both(h, operation::take, tested_.take(h, out), wanted_.take(h, wanted)));
  ++spans_;
  const bool partial = m.coefficients.axis.partial;
  int first = -1, count = 0;
  for (span_mask rest = m.mask; rest != 0; rest &= rest - 1) {
    const int k = __builtin_ctzll(rest);
    if (partial ? out.sums == wanted.sums : out.pixel[k] == wanted.pixel[k]) continue;
    if (first < 0) first = k;
    ++count;
  }
  if (count == 0) return status::ok;
  ++differing_spans_;
  differing_pixels_ += uint64_t(count);
  if (difference_) return status::ok;
  first_difference d;
  d.which = h;
  d.span_x = int32_t(m.span & 0xFFFF);
  d.span_y = int32_t(m.span >> 16);
  d.pixel = first;
  d.wanted = partial ? mean_colour(wanted.sums, rounding::nearest) : wanted.pixel[first];
  d.got = partial ? mean_colour(out.sums, rounding::nearest) : out.pixel[first];
  d.operation_index = operations_ - 1;
  d.where = find_stage(h);
  difference_ = d;
  return status::ok;
}

// --- which stage ---------------------------------------------------------------------------------------

// One span on both. A device that fails meanwhile counts as differing.
bool comparing_engine::differs(half h, const span_coefficients& c, const uint64_t* words, span_mask mask) {
  span_pixels pixels[2]{};
  any_engine* const engines[2] = {&tested_, &wanted_};
  for (int k = 0; k < 2; ++k) {
    any_engine& e = *engines[k];
    if (e.load_words(h, 0, words, word_count()) != status::ok || e.load_coefficients(h, c) != status::ok || e.start(h, mask) != status::ok ||
        e.take(h, pixels[k]) != status::ok)
      return true;
  }
  if (c.axis.partial) return !(pixels[0].sums == pixels[1].sums);
  for (; mask != 0; mask &= mask - 1)
    if (const int k = __builtin_ctzll(mask); !(pixels[0].pixel[k] == pixels[1].pixel[k])) return true;
  return false;
}

bool comparing_engine::memory_differs(half h) {
  for (int y = 0; y < fine_side_; y += span_side)
    for (int x = 0; x < fine_side_; x += span_side)
      if (differs(h, plain(x, y, filter::nearest, 0, 0), memory_[int(h)].words.data(), full_mask)) return true;
  return false;
}

// Seven pixels a row, as a section of 8 holds seven 2x2; the axes' weights differ, so that exchanged ones show. Not rounded: weights of whole
// quarters and texels of 16 times a whole number, so that every colour is whole.
bool comparing_engine::filter_differs(half h, bool rounded) {
  random_source random(1);
  std::array<uint64_t, 640> words;
  for (uint64_t& w : words) w = rounded ? random.next() : random.next() & 0xF0F0F0F0F0F0F0F0;
  const int step = rounded ? 17 : 64;
  for (int u = 0; u < 256; u += step)
    for (int v = 0; v < 256; v += rounded ? 3 * step : step)
      if (differs(h, plain(0, 0, filter::bilinear, u, v), words.data(), 0x007F7F7F7F7F7F7F)) return true;
  return false;
}

// All of one level black, all of the other white.
std::array<uint64_t, 640> comparing_engine::two_shades(bool finer_white) const {
  std::array<uint64_t, 640> words;
  for (int k = 0; k < word_count(); ++k) words[size_t(k)] = (k < finer_words(fine_side_)) == finer_white ? ~uint64_t(0) : 0;
  return words;
}

// A level of detail beyond every map gives the largest fraction whatever its error: bits of the coarser memory that are stuck then show on black or on
// white, a fraction that is wrong even so on both.
stage comparing_engine::level_or_memory(half h, span_coefficients c, span_mask mask) {
  for (int k = 0; k < span_side; ++k) c.level_row[k] = c.level_column[k] = INT16_MAX;
  c.last_level = max_levels - 1;
  const bool on_black = differs(h, c, two_shades(true).data(), mask), on_white = differs(h, c, two_shades(false).data(), mask);
  return on_black != on_white ? stage::coarser_level : stage::level;
}

// Leaves the half with the words that it held.
stage comparing_engine::find_stage(half h) {
  const memory m = memory_[int(h)];
  const auto decide = [&] {
    if (memory_differs(h)) return stage::finer_memory;
    if (filter_differs(h, false)) return stage::finer_filter;
    if (filter_differs(h, true)) return stage::write_out;
    span_coefficients c = positions_of(m.coefficients);
    std::array<uint64_t, 640> words;
    random_source random(2);
    for (uint64_t& w : words) w = random.next();
    if (differs(h, c, words.data(), m.mask)) return stage::coordinates;
    if (m.coefficients.two_levels) {
      c.kind = filter::trilinear;
      c.two_levels = true;
      if (differs(h, c, two_shades(false).data(), m.mask)) return level_or_memory(h, c, m.mask);
      if (differs(h, c, m.words.data(), m.mask)) return stage::coarser_level;
    }
    return differs(h, m.coefficients, m.words.data(), m.mask) ? stage::footprint : stage::not_repeatable;
  };
  const stage s = decide();
  (void)tested_.load_words(h, 0, m.words.data(), word_count());
  (void)wanted_.load_words(h, 0, m.words.data(), word_count());
  return s;
}

}  // namespace spantex::sim
