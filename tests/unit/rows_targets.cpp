// SPDX-License-Identifier: Apache-2.0
// Targets of rows: every format, clip, strip, tile and stream gives the pixels of a plain RGB565 frame; buffers are sent and waited for in an order that a
// DMA channel can keep.
#include <tests/support.hpp>

#include <algorithm>

#include <firmware/apps/rows_scenes.hpp>
#include <spantex/rows/targets.hpp>

using namespace spantex;
using namespace spantex::sim;
using namespace spantex::rows;

namespace {

constexpr int32_t width = 100, height = 75;
constexpr rectangle screen{0, 0, width, height};
rows::state memory_of_rows;
uint16_t plain[width * height];
alignas(4) uint8_t bytes[8 * width * height], expected[8 * width * height];
app::map_texels texels;
plane tilted;
polygon triangle;

texture_view make_scene() {
  texels.make();
  texture_view t;
  SPANTEX_ASSERT_OK(texels.view(wrap::repeat, t));
  SPANTEX_ASSERT_OK(make_plane(app::scaled_to(app::scenes[3].map, 3), screen, tilted));
  constexpr int32_t one = 1 << 16;
  const vertex corners[] = {{-2 * one, -one, 4 * one, 0, 0}, {3 * one, -one / 2, 3 * one, 200 * one, 0}, {0, 2 * one, 5 * one, 90 * one, 150 * one}};
  SPANTEX_ASSERT_OK(make_polygon(corners, 3, {80 * one, 80 * one, 50 * one, 37 * one, one / 8}, screen, triangle));
  return t;
}

// A plane and over it, in part, a triangle.
template <class Target>
status draw_scene(const Target& target, const texture_view& t) {
  SPANTEX_TRY(rows::draw<filter::bilinear>(memory_of_rows, target, tilted, t, screen));
  return rows::draw<filter::nearest>(memory_of_rows, target, triangle, t);
}

template <class Target>
Target in(const pixel_memory& m) {
  Target t;
  SPANTEX_ASSERT_OK(Target::make(m, t));
  return t;
}

// What the frame should hold: the plain picture written pixel by pixel into memory that held `background`, for pixels of `clip`.
void expect_frame(pixel_format f, const pixel_memory& m, rectangle clip, const blending& mix) {
  for (int32_t y = clip.y0; y < clip.y1; ++y)
    for (int32_t x = clip.x0; x < clip.x1; ++x) write_run(f, m, x, y, &plain[y * width + x], 1, mix);
}

template <pixel_format F>
void check_format(const texture_view& t) {
  using target = memory_target<fixed_format<F>>;
  const int32_t stride = pixel_row_bytes(F, width) + 6;
  const rectangle clips[] = {screen, {9, 5, 83, 66}, {31, 31, 33, 65}};
  for (const rectangle& clip : clips)
    for (const blending& mix : {blending{}, blending{100, -1}, blending{255, plain[37 * width + 50]}}) {
      for (int k = 0; k < int(sizeof bytes); ++k) bytes[k] = expected[k] = uint8_t(k * 37);
      expect_frame(F, {expected, stride, screen}, clip, mix);
      const target whole = in<target>({bytes, stride, screen}).clipped(clip).with(mix);
      SPANTEX_ASSERT_OK(rows::draw<filter::bilinear>(memory_of_rows, whole, tilted, t, screen));
      assert_memory_equal(bytes, expected, sizeof bytes);
      memory_target<any_format> any;
      SPANTEX_ASSERT_OK(memory_target<any_format>::make({bytes, stride, screen}, any, {F}));
      for (int k = 0; k < int(sizeof bytes); ++k) bytes[k] = uint8_t(k * 37);
      SPANTEX_ASSERT_OK(rows::draw<filter::bilinear>(memory_of_rows, any.clipped(clip).with(mix), tilted, t, screen));
      assert_memory_equal(bytes, expected, sizeof bytes);
    }
}

SPANTEX_CASE(every_format_clip_and_blend_equals_the_plain_frame_converted) {
  const texture_view t = make_scene();
  SPANTEX_ASSERT_OK(rows::draw<filter::bilinear>(memory_of_rows, frame565{plain, width, height, width}, tilted, t, screen));
  check_format<pixel_format::rgb565>(t);
  check_format<pixel_format::rgb565_swapped>(t);
  check_format<pixel_format::rgb888>(t);
  check_format<pixel_format::bgr888>(t);
  check_format<pixel_format::rgba8888>(t);
  check_format<pixel_format::bgra8888>(t);
  check_format<pixel_format::grey8>(t);
  check_format<pixel_format::grey4>(t);
  check_format<pixel_format::mono1>(t);
  check_format<pixel_format::mono1_pages>(t);
}

SPANTEX_CASE(strips_hold_the_frame_s_rows) {
  const texture_view t = make_scene();
  SPANTEX_ASSERT_OK(draw_scene(frame565{plain, width, height, width}, t));
  static uint16_t strip[width * 8];
  for (int32_t y = 0; y < height; y += 8) {
    const rectangle held{0, y, width, std::min(y + 8, height)};
    SPANTEX_ASSERT_OK(draw_scene(in<memory_target<fixed_format<pixel_format::rgb565>>>({reinterpret_cast<uint8_t*>(strip), 2 * width, held}), t));
    assert_memory_equal(strip, plain + y * width, size_t(2 * width * (held.y1 - held.y0)));
  }
}

SPANTEX_CASE(a_filled_target_has_one_colour_inside_its_clip) {
  const auto whole = in<memory_target<fixed_format<pixel_format::grey8>>>({bytes, width, screen});
  whole.fill(0);
  whole.clipped({-5, 70, 12, 400}).fill(0xFFFF);
  for (int32_t y = 0; y < height; ++y)
    for (int32_t x = 0; x < width; ++x) assert_int_equal(bytes[y * width + x], x < 12 && y >= 70 ? 255 : 0);
  SPANTEX_ASSERT_OK(rows::draw<filter::nearest>(memory_of_rows, whole.clipped({50, 50, 40, 60}), tilted, make_scene(), screen));  // an empty clip
  assert_int_equal(bytes[55 * width + 45], 0);
}

// A display behind one DMA channel: a transfer takes place when it is waited for, and not before, so that whatever is written too early shows.
struct display {
  pixel_format format;
  pixel_memory held;
  struct transfer { rectangle window; const uint8_t* bytes; uint32_t count; bool pending; } slots[2] = {};
  int transfers = 0, overlaps = 0, faults = 0, last = 1;

  void start(const rectangle& window, const uint8_t* from, uint32_t count, int buffer) {
    if (slots[buffer].pending || buffer == last) ++faults;  // not waited for; not in turn
    if (slots[buffer ^ 1].pending) ++overlaps;
    if (slots[buffer ^ 1].pending && slots[buffer ^ 1].bytes == from) ++faults;
    slots[buffer] = {window, from, count, true};
    last = buffer;
    ++transfers;
  }
  void wait(int buffer) {
    transfer& s = slots[buffer];
    if (!s.pending) ++faults;
    const int32_t row = pixel_row_bytes(format, s.window.x1 - s.window.x0);
    if (uint32_t(row * ((s.window.y1 - s.window.y0 + rows_together(format) - 1) / rows_together(format))) != s.count) ++faults;
    for (int32_t y = s.window.y0, j = 0; y < s.window.y1; y += rows_together(format), ++j)
      std::copy_n(s.bytes + j * row, row, held.bytes + y / rows_together(format) * held.stride_bytes + pixel_row_bytes(format, s.window.x0));
    s.pending = false;
  }
  bool quiet() const { return !slots[0].pending && !slots[1].pending; }
};

alignas(4) uint8_t tiles[2][8 * 1024];

template <pixel_format F>
void check_tiles(const texture_view& t, int32_t tile_width, int32_t tile_height) {
  const int32_t stride = pixel_row_bytes(F, width);
  for (int k = 0; k < int(sizeof bytes); ++k) bytes[k] = expected[k] = 0;
  const auto whole = in<memory_target<fixed_format<F>>>({expected, stride, screen});
  whole.fill(0x1234);
  SPANTEX_ASSERT_OK(rows::draw<filter::nearest>(memory_of_rows, whole.with({77, -1}), triangle, t));
  display d{F, {bytes, stride, screen}};
  SPANTEX_ASSERT_OK(draw_tiles(d, screen, tile_width, tile_height, {{tiles[0], tiles[1]}, sizeof tiles[0]}, [&](const auto& target) {
    target.fill(0x1234);
    return rows::draw<filter::nearest>(memory_of_rows, target.with({77, -1}), triangle, t);
  }, fixed_format<F>{}));
  const int count = ((width + tile_width - 1) / tile_width) * ((height + tile_height - 1) / tile_height);
  assert_int_equal(d.transfers, count);
  assert_int_equal(d.overlaps, count - 1);  // every tile but the first is drawn while the one before is on its way
  assert_int_equal(d.faults, 0);
  assert_true(d.quiet());
  // Bits beyond the last pixel of a row, or column, are nobody's.
  if (F == pixel_format::mono1)
    for (int32_t y = 0; y < height; ++y) bytes[y * stride + stride - 1] = uint8_t(bytes[y * stride + stride - 1] & 0xFF << (-width & 7));
  if (F == pixel_format::mono1_pages)
    for (int32_t x = 0; x < width; ++x) bytes[height / 8 * stride + x] = uint8_t(bytes[height / 8 * stride + x] & ((1 << height % 8) - 1));
  assert_memory_equal(bytes, expected, sizeof bytes);
}

SPANTEX_CASE(tiles_equal_the_whole_frame_through_two_buffers_in_turn) {
  const texture_view t = make_scene();
  check_tiles<pixel_format::rgb565>(t, width, 8);
  check_tiles<pixel_format::rgb565_swapped>(t, 32, 32);
  check_tiles<pixel_format::rgb888>(t, 17, 5);
  check_tiles<pixel_format::grey8>(t, 1, 1);
  check_tiles<pixel_format::grey4>(t, 30, 20);
  check_tiles<pixel_format::mono1>(t, 48, 48);
  check_tiles<pixel_format::mono1_pages>(t, 50, 16);
}

SPANTEX_CASE(tiles_that_cannot_be_are_refused_and_nothing_stays_under_way) {
  display d{pixel_format::mono1, {bytes, pixel_row_bytes(pixel_format::mono1, width), screen}};
  const tile_buffers buffers{{tiles[0], tiles[1]}, sizeof tiles[0]};
  const auto nothing = [](const auto& target) { target.fill(0); return status::ok; };
  SPANTEX_ASSERT_STATUS(draw_tiles(d, {0, 0, 0, 5}, 8, 8, buffers, nothing, fixed_format<pixel_format::mono1>{}), bad_size);
  SPANTEX_ASSERT_STATUS(draw_tiles(d, screen, 0, 8, buffers, nothing, fixed_format<pixel_format::mono1>{}), bad_size);
  SPANTEX_ASSERT_STATUS(draw_tiles(d, screen, 8, 8, {{tiles[0], tiles[1]}, 7}, nothing, fixed_format<pixel_format::mono1>{}), bad_size);
  assert_int_equal(d.transfers, 0);
  SPANTEX_ASSERT_STATUS(draw_tiles(d, screen, 12, 8, buffers, nothing, fixed_format<pixel_format::mono1>{}), bad_alignment);
  SPANTEX_ASSERT_STATUS(draw_tiles(d, screen, 8, 8, {{tiles[0], nullptr}, 100}, nothing, fixed_format<pixel_format::mono1>{}), bad_pointer);
  int calls = 0;
  SPANTEX_ASSERT_STATUS(draw_tiles(d, screen, 8, 8, buffers, [&](const auto&) { return ++calls == 4 ? status::degenerate : status::ok; }, fixed_format<pixel_format::mono1>{}),
                        degenerate);
  assert_int_equal(calls, 4);
  assert_true(d.quiet());
}

template <pixel_format F>
void check_runs(const texture_view& t) {
  const int32_t stride = pixel_row_bytes(F, width);
  for (int k = 0; k < int(sizeof bytes); ++k) bytes[k] = expected[k] = uint8_t(k * 5);
  SPANTEX_ASSERT_OK(draw_scene(in<memory_target<fixed_format<F>>>({expected, stride, screen}), t));
  display d{F, {bytes, stride, screen}};
  run_stream<F, display> stream(d, screen);
  SPANTEX_ASSERT_OK(draw_scene(stream, t));
  stream.finish();
  assert_int_equal(d.faults, 0);
  assert_int_equal(d.overlaps, d.transfers - 1);
  assert_true(d.transfers > 2 * height && d.quiet());
  assert_memory_equal(bytes, expected, sizeof bytes);
}

SPANTEX_CASE(runs_sent_as_they_are_drawn_equal_the_whole_frame) {
  const texture_view t = make_scene();
  check_runs<pixel_format::rgb565>(t);
  check_runs<pixel_format::rgb565_swapped>(t);
  check_runs<pixel_format::rgb888>(t);
  check_runs<pixel_format::bgra8888>(t);
  check_runs<pixel_format::grey8>(t);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_format_clip_and_blend_equals_the_plain_frame_converted),
      cmocka_unit_test(strips_hold_the_frame_s_rows),
      cmocka_unit_test(a_filled_target_has_one_colour_inside_its_clip),
      cmocka_unit_test(tiles_equal_the_whole_frame_through_two_buffers_in_turn),
      cmocka_unit_test(tiles_that_cannot_be_are_refused_and_nothing_stays_under_way),
      cmocka_unit_test(runs_sent_as_they_are_drawn_equal_the_whole_frame),
  };
  return run_suite("rows_targets", tests);
}
