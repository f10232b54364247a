// SPDX-License-Identifier: Apache-2.0
// What a device takes from its wires: everything that the planner makes, nothing in which the datapath is not defined. Coefficients that were changed at
// random and are still accepted are computed here and, under the sanitizers with trusted widths checked, in `make sanitize` and `make fuzz`.
#include <cstring>
#include <functional>

#include "tests/engines.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

// A direct engine to which only coefficients within their ranges come; keeps some of them.
template <class Prof>
struct judging_engine {
  direct_engine<Prof> inner;
  uint64_t judged = 0;
  std::vector<span_coefficients> kept{};

  status load_coefficients(half h, const span_coefficients& c) {
    if (!bench::coefficients_in_range(Prof::value, c)) {
      fail_msg("the planner made coefficients out of range: filter %d, evaluation %d, exponent %d, slope %d", int(c.kind), int(c.how), c.exponent, c.slope_log2);
    }
    if (judged++ % 211 == 0) kept.push_back(c);
    return inner.load_coefficients(h, c);
  }
  status load_words(half h, int first, const uint64_t* words, int count) { return inner.load_words(h, first, words, count); }
  status start(half h, span_mask mask) { return inner.start(h, mask); }
  status take(half h, span_pixels& out) { return inner.take(h, out); }
  void mark(event) {}
};

template <class Prof>
judging_engine<Prof> judge;

template <profile P>
judging_engine<fixed_profile<P>>& planned() {
  using number = fixed_profile<P>;
  static picture shown;
  judging_engine<number>& engine = judge<number>;
  random_source r(7);
  const synthetic_map* const maps[] = {&photographic_map(64, 64), &photographic_map(100, 37), &photographic_map(1, 5), &photographic_map(512, 3)};
  for (const filter kind : all_filters)
    for (int k = 0; k < (short_run() ? 16 : 48); ++k) {
      plane p{};
      if (k >= sample_plane_count && !random_plane(r, {0, 0, 640, 480}, p)) continue;
      if (k < sample_plane_count) p = sample_plane(k);
      const texture_view t = maps[k % 4]->view(k % 3 == 0 ? wrap::repeat : wrap::clamp, wrap::mirror);
      shown.reset(32, 24);
      SPANTEX_ASSERT_OK(render_plane(number{}, engine, p, t, kind, shown));
    }
  return engine;
}

// use(engine) for the four profiles.
template <class Use>
void with_planned(Use use) {
  use(judge<fixed_profile<profiles::seed>>);
  use(judge<fixed_profile<profiles::compact>>);
  use(judge<fixed_profile<profiles::standard>>);
  use(judge<fixed_profile<profiles::exact>>);
}

}  // namespace

SPANTEX_CASE(what_the_planner_makes_is_in_range) {
  planned<profiles::seed>();
  planned<profiles::compact>();
  planned<profiles::standard>();
  planned<profiles::exact>();
  bool partial = false, centred = false, by[3] = {};
  with_planned([&](auto& engine) {
    print_message("%llu coefficients\n", static_cast<unsigned long long>(engine.judged));
    for (const span_coefficients& c : engine.kept) {
      partial = partial || c.axis.partial;
      centred = centred || c.centred;
      by[int(c.how)] = true;
    }
  });
  assert_true(partial && centred && by[0] && by[1] && by[2]);
}

// The last value that is accepted and the first that is not, of every number that has a range.
SPANTEX_CASE(every_range_ends_where_it_says) {
  using change = std::function<void(span_coefficients&)>;
  struct limit { const char* name; filter kind; change last, beyond; };
  constexpr int32_t n = 1 << 23;  // of seed's numerators
  constexpr int32_t half_w = 1 << 21;
  const limit limits[] = {
      {"base u", filter::nearest, [](auto& c) { c.base_u = 32768; }, [](auto& c) { c.base_u = 32769; }},
      {"base v", filter::nearest, [](auto& c) { c.base_v = -32768; }, [](auto& c) { c.base_v = -32769; }},
      {"exponent, below", filter::nearest, [](auto& c) { c.a_u = c.b_v = 0; c.exponent = 0; }, [](auto& c) { c.a_u = c.b_v = 0; c.exponent = -1; }},
      {"exponent, above", filter::nearest, [](auto& c) { c.exponent = 36; }, [](auto& c) { c.exponent = 37; }},
      {"numerator u", filter::nearest, [](auto& c) { c.a_u = 0; c.c_u = n - 1; }, [](auto& c) { c.a_u = 0; c.c_u = n; }},
      {"numerator v", filter::nearest, [](auto& c) { c.b_v = 1; c.c_v = -n + 8; }, [](auto& c) { c.b_v = 1; c.c_v = -n + 7; }},
      {"reach", filter::nearest, [](auto& c) { c.a_u = c.b_v = 0; c.exponent = 4; c.c_u = 65536 + 16; }, [](auto& c) { c.a_u = c.b_v = 0; c.exponent = 4; c.c_u = 65536 + 17; }},
      {"numerator of a series", filter::nearest, [](auto& c) { c.a_u = c.b_v = 0; c.c_u = n / 2 + 16; c.how = evaluation::series; c.terms = 4; c.slope_log2 = -2; },
       [](auto& c) { c.a_u = c.b_v = 0; c.c_u = n / 2 + 17; c.how = evaluation::series; c.terms = 4; c.slope_log2 = -2; }},
      {"w", filter::nearest, [](auto& c) { c.how = evaluation::divide; c.g = half_w / 7; c.slope_log2 = -1; },
       [](auto& c) { c.how = evaluation::divide; c.g = half_w / 7 + 1; c.slope_log2 = 0; }},
      {"slope of w", filter::nearest, [](auto& c) { c.h = 73; c.slope_log2 = -13; }, [](auto& c) { c.h = 74; c.slope_log2 = -13; }},
      {"slope_log2, below", filter::nearest, [](auto& c) { c.slope_log2 = -15; }, [](auto& c) { c.slope_log2 = -16; }},
      {"slope_log2, above", filter::nearest, [](auto& c) { c.slope_log2 = 0; }, [](auto& c) { c.slope_log2 = 1; }},
      {"slope of a series", filter::nearest, [](auto& c) { c.a_u = c.b_v = 1; c.how = evaluation::series; c.terms = 4; c.slope_log2 = -2; },
       [](auto& c) { c.a_u = c.b_v = 1; c.how = evaluation::series; c.terms = 4; c.slope_log2 = -1; }},
      {"terms, below", filter::nearest, [](auto& c) { c.a_u = c.b_v = 1; c.how = evaluation::series; c.slope_log2 = -4; c.terms = 1; },
       [](auto& c) { c.a_u = c.b_v = 1; c.how = evaluation::series; c.slope_log2 = -4; c.terms = 0; }},
      {"terms, above", filter::nearest, [](auto& c) { c.a_u = c.b_v = 1; c.how = evaluation::series; c.slope_log2 = -4; c.terms = 4; },
       [](auto& c) { c.a_u = c.b_v = 1; c.how = evaluation::series; c.slope_log2 = -4; c.terms = 5; }},
      {"origin u", filter::nearest, [](auto& c) { c.fine.origin_u = 1 << 17; }, [](auto& c) { c.fine.origin_u = (1 << 17) + 1; }},
      {"origin v", filter::nearest, [](auto& c) { c.coarse.origin_v = -(1 << 17); }, [](auto& c) { c.coarse.origin_v = -(1 << 17) - 1; }},
      {"ratio u", filter::nearest, [](auto& c) { c.coarse.ratio_u = 1u << 31; }, [](auto& c) { c.coarse.ratio_u = (1u << 31) + 1; }},
      {"ratio v", filter::nearest, [](auto& c) { c.fine.ratio_v = 1u << 31; }, [](auto& c) { c.fine.ratio_v = (1u << 31) + 1; }},
      {"level", filter::nearest, [](auto& c) { c.fine.level = 12; }, [](auto& c) { c.fine.level = 13; }},
      {"coarser level", filter::nearest, [](auto& c) { c.coarse.level = 12; }, [](auto& c) { c.coarse.level = 13; }},
      {"last level", filter::nearest, [](auto& c) { c.last_level = 12; }, [](auto& c) { c.last_level = 13; }},
      {"footprint's vector", filter::aniso, [](auto& c) { c.axis.exponent = 20; c.axis.b_v = 1; c.axis.c_v = n - 8; },
       [](auto& c) { c.axis.exponent = 20; c.axis.b_v = 1; c.axis.c_v = n - 7; }},
      {"footprint's exponent, below", filter::squares, [](auto& c) { c.axis.exponent = 8; }, [](auto& c) { c.axis.exponent = 7; }},
      {"footprint's exponent, above", filter::squares, [](auto& c) { c.axis.exponent = 60; }, [](auto& c) { c.axis.exponent = 61; }},
      {"contour's Jacobian", filter::contour, [](auto& c) { c.axis.a_u = INT32_MAX - 7; c.axis.b_u = 1; }, [](auto& c) { c.axis.a_u = INT32_MAX - 6; c.axis.b_u = 1; }},
      {"corners of a pixel", filter::hat, [](auto& c) { c.centred = true; c.a_u = 0; c.b_u = n / 2 - 1; }, [](auto& c) { c.centred = true; c.a_u = 0; c.b_u = n / 2; }},
      {"corners of a span", filter::step, [](auto& c) { c.a_u = 0; c.b_u = n / 9; }, [](auto& c) { c.a_u = 0; c.b_u = n / 9 + 1; }},
      {"part of a sum", filter::aniso, [](auto& c) { c.axis.exponent = 20; c.axis.partial = true; }, [](auto& c) { c.kind = filter::trilinear; c.axis.partial = true; }},
      {"one pixel", filter::step, [](auto& c) { c.centred = true; }, [](auto& c) { c.kind = filter::bilinear; c.centred = true; }},
  };
  for (const limit& l : limits) {
    span_coefficients last = reading(0), beyond = last;
    last.kind = beyond.kind = l.kind;
    l.last(last);
    l.beyond(beyond);
    if (!bench::coefficients_in_range(prof::value, last)) fail_msg("%s: the last value is refused", l.name);
    if (bench::coefficients_in_range(prof::value, beyond)) fail_msg("%s: the first value beyond is accepted", l.name);
  }
}

namespace {

// Some bits of some fields, or a field that is all ones or zeros.
void damage(uint8_t (&bytes)[bench::coefficient_bytes], random_source& r) {
  for (int64_t n = r.between(1, 4); n > 0; --n) {
    uint8_t& byte = bytes[r.between(0, bench::coefficient_bytes - 1)];
    const uint64_t how = r.next() % 8;
    byte = how == 0 ? uint8_t(r.next()) : uint8_t(byte ^ 1u << how);
  }
}

template <profile P>
void damaged_coefficients_are_survived(judging_engine<fixed_profile<P>>& planner) {
  static local_memory<P.fine_side> texels;
  random_source r(11);
  uint64_t accepted = 0, refused = 0;
  for (const span_coefficients& c : planner.kept)
    for (int k = 0; k < (short_run() ? 2 : 12); ++k) {
      uint8_t bytes[bench::coefficient_bytes];
      bench::field_writer out(bytes, sizeof bytes);
      span_coefficients copy = c;
      spantex::detail::archive(out, copy);
      assert_true(out.good() && out.size() == bench::coefficient_bytes);
      damage(bytes, r);
      bench::field_reader in(bytes, sizeof bytes);
      span_coefficients changed = c;
      spantex::detail::archive(in, changed);
      if (!in.at_end() || !bench::coefficients_in_range(P, changed)) {
        ++refused;
        continue;
      }
      ++accepted;
      span_pixels pixels{};
      compute_span(fixed_profile<P>{}, changed, uint64_t(0x8000000000000001) | uint64_t(1) << r.between(0, 63), texels, pixels, no_observer{});
    }
  assert_true(accepted > refused / 20 && refused > accepted / 20);
  print_message("%llu accepted, %llu refused\n", static_cast<unsigned long long>(accepted), static_cast<unsigned long long>(refused));
}

}  // namespace

SPANTEX_CASE(damaged_coefficients_that_are_accepted_are_computed) {
  with_planned([](auto& engine) { damaged_coefficients_are_survived(engine); });
}

// A sealed frame with coefficients out of range, or words beyond the memory, does not reach the engine, and the half is as before.
SPANTEX_CASE(the_device_refuses_and_its_half_stays_as_it_was) {
  static std::unique_ptr<simulated_bench<prof>> bench;
  bench = std::make_unique<simulated_bench<prof>>();
  bench_engine engine(*bench, prof::value);
  SPANTEX_ASSERT_OK(engine.load_words(half::first, 0, red.word, word_count));
  SPANTEX_ASSERT_OK(engine.load_coefficients(half::first, reading(0)));
  span_coefficients wild = reading(1);
  wild.exponent = 90;
  SPANTEX_ASSERT_STATUS(engine.load_coefficients(half::first, wild), device_error);
  assert_non_null(strstr(engine.trouble().c_str(), "outside the datapath's ranges"));
  SPANTEX_ASSERT_STATUS(engine.load_words(half::first, word_count, red.word, 1), bad_address);
  SPANTEX_ASSERT_STATUS(engine.load_words(half::first, -1, red.word, 1), bad_address);
  SPANTEX_ASSERT_STATUS(engine.load_words(half::first, INT32_MAX, red.word, INT32_MAX), bad_address);
  // Over the bare link, without the host engine that empties a half after an error: the half still computes what it held.
  bench_link link(*bench, {});
  SPANTEX_ASSERT_OK(link.reset());
  const auto say = [&](bench::command what, auto fill) {
    bench::field_writer out = link.payload();
    fill(out);
    SPANTEX_ASSERT_OK(link.exchange(what, what == bench::command::open ? 0 : 9, out.size()));
    return link.code();
  };
  const auto load = [&](span_coefficients c) {
    return say(bench::command::load_coefficients, [&](auto& out) { out(uint8_t(0)); spantex::detail::archive(out, c); });
  };
  say(bench::command::open, [](auto& out) {
    bench::profile_fields fields = bench::fields_of(prof::value);
    out(bench::protocol_version);
    out(uint32_t(9));
    bench::archive(out, fields);
  });
  assert_int_equal(int(load(wild)), int(bench::result::bad_coefficients));
  const auto start = [&] { return say(bench::command::start, [](auto& out) { out(uint8_t(0)); out(uint64_t(1)); }); };
  assert_int_equal(int(start()), int(bench::result::half_not_loaded));
  assert_int_equal(int(load(reading(0))), int(bench::result::ok));
  assert_int_equal(int(load(wild)), int(bench::result::bad_coefficients));
  assert_int_equal(int(start()), int(bench::result::ok));
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(what_the_planner_makes_is_in_range),
      cmocka_unit_test(every_range_ends_where_it_says),
      cmocka_unit_test(damaged_coefficients_that_are_accepted_are_computed),
      cmocka_unit_test(the_device_refuses_and_its_half_stays_as_it_was),
  };
  return run_suite("coefficient_ranges", tests);
}
