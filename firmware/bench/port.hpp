// SPDX-License-Identifier: Apache-2.0
// The device's end of the wires (docs/BENCH.md): the four-phase handshake, one byte or half a byte a clock, and the echo that answers while reset
// is high. Knows nothing of frames: bytes go to and come from a responder. Nothing here waits: poll() looks at the lines once, does what they ask
// for and returns.
//
//   not in reset:   clock rises, to device    data -> responder, ready rises            clock falls: ready falls
//                   clock rises, to host      responder -> data driven, ready rises     clock falls: data released, ready falls
//   in reset:       ready = clock, busy = command, error = direction; data latched while the clock is high to the device, and driven, each bit on
//                   the next line, the last on the first, complemented unless command is high, while the clock is high to the host: so that
//                   exchanged lines show
//
// The data lines are driven only while clock and direction are high, so that a host that lets go of its lines (all fall) ends it.
#pragma once
#include <stdint.h>

#include <firmware/bench/wire.hpp>

namespace spantex::bench {

template <class T, class U> inline constexpr bool same = false;
template <class T> inline constexpr bool same<T, T> = true;
template <class T, class U> concept exactly = same<T, U>;

// The pins of a microcontroller, a simulation, or files of gpio-sim. control() must be read at one instant; data() may be read after it. drive() makes
// the data pins outputs with this value, release() inputs. On narrow wires the lower four bits count.
template <class P>
concept device_pins = requires(P& p, uint8_t byte, const status_lines& lines) {
  { p.control() } -> exactly<control_lines>;
  { p.data() } -> exactly<uint8_t>;
  { p.drive(byte) } -> exactly<void>;
  { p.release() } -> exactly<void>;
  { p.show(lines) } -> exactly<void>;
};

// receive: a byte arrived, `first` of a frame. answer: the next byte to send; `first` begins the answer again. work: something to do while the wires
// rest; true if it did. reset: as after power-on.
template <class R>
concept byte_responder = requires(R& r, const R& seen, uint8_t byte, bool first) {
  { r.receive(byte, first) } -> exactly<void>;
  { r.answer(first) } -> exactly<uint8_t>;
  { r.work() } -> exactly<bool>;
  { r.reset() } -> exactly<void>;
  { seen.busy() } -> exactly<bool>;
  { seen.error() } -> exactly<bool>;
};

// DataBits: 8, or 4 for narrow wires, whose bytes come in two clocks, lower half first.
template <device_pins Pins, byte_responder Responder, int DataBits = 8>
class port {
 public:
  static_assert(DataBits == 8 || DataBits == 4, "spantex: the bench has 8 data lines or 4");

  // Both must outlive the port.
  constexpr port(Pins& pins, Responder& responder) : pins_(pins), responder_(responder) {
    pins_.release();
    show({});
  }

  // One step. True if anything happened: false says that nothing will until the lines change.
  constexpr bool poll() {
    const control_lines c = pins_.control();
    if (c.reset) return echo(c);
    if (echoing_) return leave_echo();
    if (driving_ && !(c.clock && c.to_host)) let_go();
    if (c.clock != shown_.ready) {
      if (c.clock) serve(c);
      show({c.clock, responder_.busy(), responder_.error()});
      return true;
    }
    const bool worked = !c.clock && responder_.work();
    const status_lines now{shown_.ready, responder_.busy(), responder_.error()};
    if (now == shown_) return worked;
    show(now);
    return true;
  }

 private:
  static constexpr uint8_t data_mask = DataBits == 8 ? 0xFF : 0x0F;

  constexpr void serve(const control_lines& c) {
    if (c.to_host) drive(next_out(c.command));
    else take_in(uint8_t(pins_.data() & data_mask), c.command);
  }

  constexpr void take_in(uint8_t data, bool first) {
    if constexpr (DataBits == 8) {
      responder_.receive(data, first);
    } else {
      if (first) upper_half_ = false;
      if (upper_half_) responder_.receive(uint8_t(held_ | data << 4), first_held_);
      held_ = data;
      first_held_ = first;
      upper_half_ = !upper_half_;
    }
  }

  constexpr uint8_t next_out(bool first) {
    if constexpr (DataBits == 8) {
      return responder_.answer(first);
    } else {
      if (first) upper_out_ = false;
      upper_half_ = false;  // a frame that stopped half-way through a byte is over
      if (!upper_out_) held_out_ = responder_.answer(first);
      upper_out_ = !upper_out_;
      return uint8_t(upper_out_ ? held_out_ & 15 : held_out_ >> 4);
    }
  }

  constexpr bool echo(const control_lines& c) {
    if (!echoing_) {
      responder_.reset();
      latched_ = 0;
      upper_half_ = upper_out_ = false;
      if (driving_) let_go();
    }
    const bool entered = !echoing_;
    echoing_ = true;
    if (c.clock && !c.to_host) latched_ = uint8_t(pins_.data() & data_mask);
    const int turned = latched_ << 1 | latched_ >> (DataBits - 1);
    const uint8_t back = uint8_t((c.command ? turned : ~turned) & data_mask);
    const bool drives = c.clock && c.to_host, changes = drives != driving_ || (drives && back != driven_);
    if (changes && drives) drive(back);
    if (changes && !drives) let_go();
    const status_lines now{c.clock, c.command, c.to_host};
    if (!changes && now == shown_) return entered;
    show(now);
    return true;
  }

  constexpr bool leave_echo() {
    echoing_ = false;
    if (driving_) let_go();
    show({false, responder_.busy(), responder_.error()});
    return true;
  }

  constexpr void drive(uint8_t value) {
    pins_.drive(value);
    driven_ = value;
    driving_ = true;
  }
  constexpr void let_go() {
    pins_.release();
    driving_ = false;
  }
  constexpr void show(const status_lines& lines) {
    pins_.show(lines);
    shown_ = lines;
  }

  Pins& pins_;
  Responder& responder_;
  status_lines shown_{};
  bool driving_ = false, echoing_ = false;
  uint8_t driven_ = 0, latched_ = 0;
  uint8_t held_ = 0, held_out_ = 0;          // narrow wires: the half byte that waits for the other
  bool upper_half_ = false, upper_out_ = false, first_held_ = false;
};

}  // namespace spantex::bench
