// SPDX-License-Identifier: Apache-2.0
// Targets of rows beside frame565: every format of pixels.hpp, parts of frames, clip rectangles, blending; and displays that cannot hold a frame, which
// get tiles or single runs through two small buffers in turn while the other is being drawn into.
//
//   memory_target   pixels in memory: a frame, a strip, a tile (pixel_memory)
//   draw_tiles      a picture of any number of surfaces, tile by tile
//   run_stream      one surface straight to the display, runs of at most 32 pixels; what it does not cover is not touched
//
// A display is any type with
//   void start(const rectangle& window, const uint8_t* bytes, uint32_t count, int buffer)   begin to send the window's pixels, row by row, and return
//   void wait(int buffer)                                                                    return when that buffer's bytes have been sent
// start() typically sets the window of the display's memory and starts DMA, wait() looks at its flag. Each buffer (0, 1) is started and then waited for before
// it is written again; before start() of one the other may still be on its way: a display with one channel waits for it there.
#pragma once
#include <stdint.h>

#include <spantex/pixels.hpp>
#include <spantex/plane.hpp>
#include <spantex/rows/draw.hpp>
#include <spantex/status.hpp>

namespace spantex::rows {

// A format as a type: of which only this one's code is linked; or one chosen at run time.
template <pixel_format F>
struct fixed_format { static constexpr pixel_format value = F; };
struct any_format { pixel_format value; };

namespace detail {

// Pixels of the run being drawn: nothing of it is copied with a target.
struct run_line {
  uint16_t pixel[longest_run];
  run_line() {}
  run_line(const run_line&) {}
  run_line& operator=(const run_line&) { return *this; }
};

}  // namespace detail

template <class Format>
class memory_target {
 public:
  memory_target() = default;

  // Errors: those of check(pixel_format, pixel_memory).
  static status make(const pixel_memory& memory, memory_target& out, Format format = {}) {
    SPANTEX_TRY(check(format.value, memory));
    out.memory_ = memory;
    out.area_ = out.screen_ = memory.held;
    out.mix_ = {};
    out.format_ = format;
    return status::ok;
  }

  // The same memory, written only within `clip` (in place of an earlier one); with another blending; as part of a larger screen, for which what is drawn is set up (pictures.hpp), so that
  // every strip or tile of it gets the pixels of the whole.
  memory_target clipped(rectangle clip) const {
    memory_target t = *this;
    t.area_ = intersection(memory_.held, clip);
    return t;
  }
  memory_target with(const blending& mix) const {
    memory_target t = *this;
    t.mix_ = mix;
    return t;
  }
  memory_target of(rectangle screen) const {
    memory_target t = *this;
    t.set_screen(screen);
    return t;
  }
  void set_screen(const rectangle& screen) { screen_ = screen; }

  // One colour everywhere, blended as set.
  void fill(uint16_t rgb565) const {
    for (int32_t y = area_.y0; y < area_.y1; ++y)
      for (int32_t x = area_.x0; x < area_.x1; ++x) write_run(format_.value, memory_, x, y, &rgb565, 1, mix_);
  }

  const pixel_memory& memory() const { return memory_; }

  // What rows ask for. RGB565 that is stored as it comes is drawn where it shall lie.
  rectangle area() const { return area_; }
  rectangle screen() const { return screen_; }
  texel565* row(int32_t x, int32_t y, int32_t) const {
    if (direct()) return reinterpret_cast<texel565*>(memory_.bytes + (y - memory_.held.y0) * memory_.stride_bytes) + (x - memory_.held.x0);
    return line_.pixel;
  }
  void done(int32_t x, int32_t y, int32_t count) const {
    if (!direct()) write_run(format_.value, memory_, x, y, line_.pixel, int(count), mix_);
  }

 private:
  bool direct() const { return format_.value == pixel_format::rgb565 && mix_.stores(); }

  pixel_memory memory_{};
  rectangle area_{}, screen_{};
  blending mix_{};
  [[no_unique_address]] Format format_{};
  mutable detail::run_line line_;
};

// The display's two buffers; both of `bytes` bytes, 2-byte aligned for RGB565.
struct tile_buffers {
  uint8_t* memory[2];
  uint32_t bytes;
};

namespace detail {

// `target` is the one tile after tile.
template <class Format, class Display, class Draw>
status draw_tiles(Display& display, const rectangle& screen, int32_t tile_width, int32_t tile_height, const tile_buffers& buffers, const Draw& draw, Format format,
                  memory_target<Format>& target) {
  if (!on_screen(screen) || tile_width <= 0 || tile_height <= 0 || tile_width > max_screen_px || tile_height > max_screen_px) return status::bad_size;
  bool started[2] = {};
  int buffer = 0;
  const auto each = [&](const rectangle& tile) {
    if (started[buffer]) display.wait(buffer);
    started[buffer] = false;
    const int32_t width = tile.x1 - tile.x0, bytes = pixel_bytes(format.value, width, tile.y1 - tile.y0);
    if (uint32_t(bytes) > buffers.bytes) return status::bad_size;
    SPANTEX_TRY(memory_target<Format>::make({buffers.memory[buffer], pixel_row_bytes(format.value, width), tile}, target, format));
    target.set_screen(screen);
    SPANTEX_TRY(draw(target));
    display.start(tile, buffers.memory[buffer], uint32_t(bytes), buffer);
    started[buffer] = true;
    buffer ^= 1;
    return status::ok;
  };
  status result = status::ok;
  for (int32_t y = screen.y0; y < screen.y1 && result == status::ok; y += tile_height)
    for (int32_t x = screen.x0; x < screen.x1 && result == status::ok; x += tile_width)
      result = each(intersection(screen, {x, y, x + tile_width, y + tile_height}));
  for (int n = 0; n < 2; ++n, buffer ^= 1)
    if (started[buffer]) display.wait(buffer);
  return result;
}

}  // namespace detail

// Draws a screen that is nowhere held, tile by tile: `draw(target)` is called once a tile and draws everything into that memory_target, whose area is the
// tile; then the tile is sent. The same pixels as drawing the whole frame. Tiles that begin at multiples of 32 pixels cut no block: they cost no more
// instructions than the frame. Errors: bad_size (screen, or a tile larger than a buffer), bad_alignment, bad_pointer, out_of_range, those of `draw`; at
// any end both buffers have been waited for.
template <class Format, class Display, class Draw>
status draw_tiles(Display& display, rectangle screen, int32_t tile_width, int32_t tile_height, const tile_buffers& buffers, const Draw& draw, Format format = {}) {
  memory_target<Format> target;
  return detail::draw_tiles(display, screen, tile_width, tile_height, buffers, draw, format, target);
}

// Runs as they are drawn, one window each. Formats of whole bytes; nothing is blended, for nothing can be read back. Must outlive the last transfer:
// finish() waits for it.
template <pixel_format Format, class Display>
class run_stream {
  static_assert(pixel_bits(Format) >= 8, "spantex: a run of a stream begins at a whole byte");

 public:
  run_stream(Display& display, rectangle screen) : display_(display), screen_(screen) {}

  rectangle area() const { return screen_; }
  texel565* row(int32_t, int32_t, int32_t) const {
    if (started_[next_]) display_.wait(next_);
    started_[next_] = false;
    return direct ? reinterpret_cast<texel565*>(sent_[next_].bytes) : line_;
  }
  void done(int32_t x, int32_t y, int32_t count) const {
    uint8_t* const bytes = sent_[next_].bytes;
    const rectangle window{x, y, x + count, y + 1};
    if constexpr (!direct) write_run(Format, {bytes, sizeof sent_[0].bytes, window}, x, y, line_, int(count));
    display_.start(window, bytes, uint32_t(pixel_row_bytes(Format, count)), next_);
    started_[next_] = true;
    next_ ^= 1;
  }

  // Waits for what is still being sent.
  void finish() const {
    for (int n = 0; n < 2; ++n, next_ ^= 1) {
      if (started_[next_]) display_.wait(next_);
      started_[next_] = false;
    }
  }

 private:
  static constexpr bool direct = Format == pixel_format::rgb565;
  struct alignas(4) run_bytes { uint8_t bytes[longest_run * pixel_bits(Format) / 8]; };

  Display& display_;
  rectangle screen_;
  mutable run_bytes sent_[2];
  mutable uint16_t line_[direct ? 1 : longest_run];
  mutable bool started_[2] = {};
  mutable int next_ = 0;
};

}  // namespace spantex::rows
