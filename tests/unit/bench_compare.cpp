// SPDX-License-Identifier: Apache-2.0
// A device with one part of its engine broken, at the end of the simulated wires, against the simulator: the first difference is named with the span, pixel
// and stage, and the recorded operations give the simulator the same difference again.
#include "tests/engines.hpp"

#include <sim/bench_compare.hpp>
#include <sim/broken_engine.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

struct taken {
  uint32_t span;
  span_mask mask;
  bool partial;
  span_pixels pixels;
};

// An engine that writes down what it computes, in order: where the two first differ is then found without the code that is tested.
template <class Engine>
struct listing_engine {
  Engine inner;
  std::vector<taken> list{};
  uint32_t marked = 0;
  taken now[half_count] = {};

  status load_coefficients(half h, const span_coefficients& c) { now[int(h)].partial = c.axis.partial; return inner.load_coefficients(h, c); }
  status load_words(half h, int first, const uint64_t* words, int count) { return inner.load_words(h, first, words, count); }
  status start(half h, span_mask mask) { now[int(h)].mask = mask; now[int(h)].span = marked; return inner.start(h, mask); }
  status take(half h, span_pixels& out) {
    const status s = inner.take(h, out);
    list.push_back(now[int(h)]);
    list.back().pixels = out;
    return s;
  }
  void mark(event what) { if (what.kind == event_kind::span) marked = what.value; }
};

// Pixel -1: none differs.
struct place { uint32_t span = 0; int pixel = -1; rgba8 right{}, wrong{}; };

place first_difference_of(const std::vector<taken>& right, const std::vector<taken>& wrong) {
  for (size_t n = 0; n < right.size() && n < wrong.size(); ++n)
    for (int k = 0; k < span_pixel_count; ++k) {
      const taken &a = right[n], &b = wrong[n];
      if ((a.mask >> k & 1) == 0) continue;
      if (a.partial ? a.pixels.sums == b.pixels.sums : a.pixels.pixel[k] == b.pixels.pixel[k]) continue;
      if (a.partial) return {a.span, k, mean_colour(a.pixels.sums, rounding::nearest), mean_colour(b.pixels.sums, rounding::nearest)};
      return {a.span, k, a.pixels.pixel[k], b.pixels.pixel[k]};
    }
  return {};
}

struct broken_case {
  broken_part part;
  filter kind;
  int plane;
  stage named;
};
constexpr broken_case cases[] = {
    {broken_part::fetch, filter::nearest, 1, stage::finer_memory},        {broken_part::fetch, filter::trilinear, 1, stage::finer_memory},
    {broken_part::filter, filter::bilinear, 1, stage::finer_filter},      {broken_part::filter, filter::aniso, 2, stage::finer_filter},
    {broken_part::write_out, filter::bilinear, 0, stage::write_out},      {broken_part::write_out, filter::hat, 1, stage::write_out},
    {broken_part::coordinates, filter::nearest, 1, stage::coordinates},   {broken_part::coordinates, filter::trilinear, 1, stage::coordinates},
    {broken_part::level, filter::trilinear, 0, stage::level},             {broken_part::level, filter::trilinear3, 0, stage::level},
    {broken_part::coarse_fetch, filter::trilinear, 1, stage::coarser_level},
    {broken_part::footprint, filter::aniso, 2, stage::footprint},         {broken_part::memory_cell, filter::trilinear, 1, stage::not_repeatable},
};

template <profile P>
struct setup {
  using number = fixed_profile<P>;
  simulated_bench<number, 8, broken_engine<number>> wires;
  any_engine_of<bench_engine> device{wires, P};
  recording log;
  any_engine_of<recording_engine<any_engine>> recorded{device, log};
  any_engine_of<sim_engine<number>> reference, again;
  comparing_engine both{recorded, reference, P.fine_side};
  listing_engine<direct_engine<number>> right;
  listing_engine<broken_engine<number>> wrong;
};

// One of each profile at a time: failing assertions leave by longjmp.
template <profile P>
setup<P>& fresh_setup(broken_part part, uint64_t from) {
  static std::unique_ptr<setup<P>> kept;
  kept = std::make_unique<setup<P>>();
  kept->wires.engine().break_at(part, from);
  kept->wrong.inner.break_at(part, from);
  return *kept;
}

constexpr rectangle area{0, 0, 24, 16};
picture shown;

template <profile P, class Engine>
status draw(Engine& engine, const broken_case& c) {
  shown.reset(area.x1, area.y1);
  return render_plane(fixed_profile<P>{}, engine, sample_plane(c.plane), photographic_map(64, 64).view(wrap::repeat, wrap::repeat), c.kind, shown);
}

template <profile P>
void replays_to_the_same(setup<P>& s, const first_difference& d) {
  static recording loaded;
  std::stringstream file;
  assert_true(save(file, s.log));
  loaded = {};
  assert_true(load(file, loaded).empty());
  const replay_result r = replay(loaded, s.again);
  assert_int_equal(int(r.result), int(status::mismatch));
  assert_int_equal(r.operation_index, d.operation_index);
  assert_int_equal(int(r.what), int(d.what));
  assert_int_equal(int(r.which), int(d.which));
  assert_int_equal(r.span_x, d.span_x);
  assert_int_equal(r.span_y, d.span_y);
  assert_int_equal(r.pixel, d.pixel);
  if (d.pixel >= 0) assert_true(r.expected == d.got && r.got == d.wanted);
  else assert_true(r.expected_status == d.got_status && r.got_status == d.wanted_status);
}

// False if no pixel of the picture shows it.
template <profile P>
bool named_where_it_shows(const broken_case& c, uint64_t from) {
  setup<P>& s = fresh_setup<P>(c.part, from);
  SPANTEX_ASSERT_OK(draw<P>(s.right, c));
  SPANTEX_ASSERT_OK(draw<P>(s.wrong, c));
  const place expected = first_difference_of(s.right.list, s.wrong.list);
  if (expected.pixel < 0) return false;
  SPANTEX_ASSERT_OK((draw<P, any_engine>(s.both, c)));
  const auto& d = s.both.difference();
  if (!d) fail_msg("part %d, filter %d: no difference found", int(c.part), int(c.kind));
  if (d->where != c.named) fail_msg("part %d, filter %d: %s", int(c.part), int(c.kind), d->text().c_str());
  assert_int_equal(d->span_x, expected.span & 0xFFFF);
  assert_int_equal(d->span_y, expected.span >> 16);
  assert_int_equal(d->pixel, expected.pixel);
  assert_true(d->wanted == expected.right && d->got == expected.wrong);
  assert_true(s.both.differing_spans() > 0);
  replays_to_the_same(s, *d);
  return true;
}

template <profile P>
void every_broken_part_is_named(void**) {
  for (const broken_case& wanted : cases)
    for (const uint64_t from : {0, 3}) {
      if (from == 0 && P.fine_side != 8) continue;  // once in the larger memories is enough
      broken_case c = wanted;
      bool shown_once = named_where_it_shows<P>(c, from);
      for (c.plane = 0; !shown_once && c.plane < sample_plane_count; ++c.plane) shown_once = named_where_it_shows<P>(c, from);
      // Where a section that does not fit is taken from the coarser level, a plane's spans have no fraction of a level.
      const bool never = P.overflow == overflow_policy::coarser && (c.part == broken_part::level || c.part == broken_part::coarse_fetch);
      if (shown_once == never) fail_msg("part %d, filter %d: %s", int(c.part), int(c.kind), never ? "a picture shows it" : "no picture shows it");
    }
}

template <profile P>
void a_sound_device_has_no_difference(void**) {
  for (const filter kind : {filter::nearest, filter::trilinear, filter::aniso, filter::hat}) {
    setup<P>& s = fresh_setup<P>(broken_part::none, 0);
    SPANTEX_ASSERT_OK((draw<P, any_engine>(s.both, {broken_part::none, kind, 1, stage::answers})));
    assert_false(s.both.difference().has_value());
    assert_int_equal(s.both.differing_spans(), 0);
    assert_true(s.both.spans() > 0);
    assert_int_equal(int(replay(s.log, s.again).result), int(status::ok));
  }
}

void another_answer_is_named(void**) {
  constexpr profile p = profiles::seed;
  setup<p>& s = fresh_setup<p>(broken_part::answers, 3);
  const status drawn = draw<p, any_engine>(s.both, {broken_part::answers, filter::trilinear, 1, stage::answers});
  assert_true(drawn != status::ok);
  const auto& d = s.both.difference();
  assert_true(d.has_value() && d->where == stage::answers && d->what == operation::take && d->pixel == -1);
  assert_true(d->wanted_status == status::ok && d->got_status == status::half_not_started);
  replays_to_the_same(s, *d);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_sound_device_has_no_difference<profiles::seed>),    cmocka_unit_test(a_sound_device_has_no_difference<profiles::compact>),
      cmocka_unit_test(a_sound_device_has_no_difference<profiles::standard>), cmocka_unit_test(a_sound_device_has_no_difference<profiles::exact>),
      cmocka_unit_test(every_broken_part_is_named<profiles::seed>),          cmocka_unit_test(every_broken_part_is_named<profiles::compact>),
      cmocka_unit_test(every_broken_part_is_named<profiles::standard>),      cmocka_unit_test(every_broken_part_is_named<profiles::exact>),
      cmocka_unit_test(another_answer_is_named),
  };
  return run_suite("bench_compare", tests);
}
