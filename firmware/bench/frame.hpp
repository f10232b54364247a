// SPDX-License-Identifier: Apache-2.0
// A frame of the bench (docs/BENCH.md), in constant memory: built whole, received a byte at a time. Both ends use it.
//
//   0         1         2        4            4 + n       8 + n     10 + n
//   command   sequence  n u16    payload      seal u32    CRC-16
//
// Little-endian, but for the CRC-16: its high byte goes first, as its polynomial has it. It covers everything before it and finds what wires do, in frames below
// 4096 bytes: any error of up to three bits, any burst of up to 16, so any damage to two bytes in a row (tests/unit/bench_frames.cpp). The seal is
// the CRC-32 of the session's number (u32) and everything before it: what passes the CRC by chance, or belongs to another session, fails it.
#pragma once
#include <stdint.h>

#include <firmware/bench/wire.hpp>

namespace spantex::bench {

inline constexpr int frame_header_bytes = 4, seal_bytes = 4, crc_bytes = 2;
inline constexpr int frame_overhead_bytes = frame_header_bytes + seal_bytes + crc_bytes;

// Builds a frame in place: payload first, then finish().
template <int MostPayload>
class frame_builder {
 public:
  constexpr field_writer payload() { return field_writer(bytes_ + frame_header_bytes, MostPayload); }

  constexpr void finish(uint8_t command, uint8_t sequence, uint32_t session, int payload_bytes) {
    bytes_[0] = command;
    bytes_[1] = sequence;
    bytes_[2] = uint8_t(payload_bytes);
    bytes_[3] = uint8_t(payload_bytes >> 8);
    size_ = frame_header_bytes + payload_bytes;
    crc32 seal;
    seal.add_u32(session);
    for (int k = 0; k < size_; ++k) seal.add(bytes_[k]);
    for (int k = 0; k < seal_bytes; ++k) bytes_[size_++] = uint8_t(seal.value() >> (8 * k));
    crc16 crc;
    for (int k = 0; k < size_; ++k) crc.add(bytes_[k]);
    bytes_[size_++] = uint8_t(crc.value >> 8);
    bytes_[size_++] = uint8_t(crc.value);
  }
  constexpr void clear() { size_ = 0; }

  constexpr int size() const { return size_; }
  constexpr uint8_t byte(int k) const { return bytes_[k]; }

 private:
  uint8_t bytes_[frame_overhead_bytes + MostPayload] = {};
  int size_ = 0;
};

enum class frame_state : uint8_t { idle, receiving, complete, bad };

// Parses a frame: begin(), then take() each byte until it is complete or bad. Never reads or writes beyond its memory, whatever arrives.
template <int MostPayload>
class frame_receiver {
 public:
  constexpr void begin() {
    size_ = 0;
    state_ = frame_state::receiving;
    crc_ = {};
    fault_ = result::incomplete;
  }
  constexpr void forget() {
    state_ = frame_state::idle;
    fault_ = result::incomplete;
  }

  constexpr frame_state take(uint8_t byte) {
    if (state_ != frame_state::receiving) return state_;
    bytes_[size_++] = byte;
    if (size_ <= frame_header_bytes || size_ <= whole_size() - crc_bytes) crc_.add(byte);
    if (size_ < frame_header_bytes) return state_;
    if (payload_bytes() > MostPayload) return refuse(result::bad_length);
    if (size_ < whole_size()) return state_;
    if (crc_.value != uint32_t(bytes_[size_ - 2] << 8 | bytes_[size_ - 1])) return refuse(result::bad_crc);
    return state_ = frame_state::complete;
  }

  constexpr frame_state state() const { return state_; }
  constexpr result fault() const { return fault_; }  // why it is not complete

  // Of a complete frame.
  constexpr uint8_t command() const { return bytes_[0]; }
  constexpr uint8_t sequence() const { return bytes_[1]; }
  constexpr int payload_bytes() const { return bytes_[2] | bytes_[3] << 8; }
  constexpr const uint8_t* payload() const { return bytes_ + frame_header_bytes; }
  constexpr field_reader fields() const { return field_reader(payload(), payload_bytes()); }
  constexpr uint32_t seal() const {
    const uint8_t* at = bytes_ + frame_header_bytes + payload_bytes();
    return at[0] | uint32_t(at[1]) << 8 | uint32_t(at[2]) << 16 | uint32_t(at[3]) << 24;
  }
  constexpr bool sealed_with(uint32_t session) const {
    crc32 seal_of;
    seal_of.add_u32(session);
    for (int k = 0; k < frame_header_bytes + payload_bytes(); ++k) seal_of.add(bytes_[k]);
    return seal_of.value() == seal();
  }

 private:
  constexpr int whole_size() const { return frame_overhead_bytes + payload_bytes(); }
  constexpr frame_state refuse(result why) {
    fault_ = why;
    return state_ = frame_state::bad;
  }

  uint8_t bytes_[frame_overhead_bytes + MostPayload] = {};
  int size_ = 0;
  crc16 crc_{};
  frame_state state_ = frame_state::idle;
  result fault_ = result::incomplete;
};

}  // namespace spantex::bench
