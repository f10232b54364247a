// SPDX-License-Identifier: Apache-2.0
// The language of the bench's wires (docs/BENCH.md): lines, commands, result codes, checksums, fields. Both ends include it.
#pragma once
#include <stddef.h>
#include <stdint.h>

#include <hal/span_archive.hpp>
#include <spantex/local_memory.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>
#include <spantex/status.hpp>

namespace spantex::bench {

inline constexpr uint16_t protocol_version = 1;
inline constexpr uint32_t identity_magic = 0x42585453;  // "STXB"

// What the host drives beside the data lines, and what the device drives. All lines are high for true.
struct control_lines {
  bool clock = false;      // a byte, or half of one on narrow wires, is asked for or offered
  bool to_host = false;    // direction: the device drives the data lines while it answers a clock
  bool command = false;    // the first byte of a frame
  bool reset = false;
  friend constexpr bool operator==(const control_lines&, const control_lines&) = default;
};
struct status_lines {
  bool ready = false;      // the clock has been seen
  bool busy = false;       // a half computes
  bool error = false;      // the last frame was refused; the answer says why
  friend constexpr bool operator==(const status_lines&, const status_lines&) = default;
};

enum class command : uint8_t {
  identify = 0x01,           // -> identity
  open = 0x02,               // version u16, session u32, profile
  close = 0x03,
  load_coefficients = 0x10,  // half u8, coefficients
  load_words = 0x11,         // half u8, first i32, count i32, offset u16, words u64: those of [first, first + count) from `offset` on
  start = 0x12,              // half u8, mask u64
  read_status = 0x13,        // -> device_status
  read_span = 0x14,          // half u8 -> mask u64, partial u8, pixels of the mask r g b a; if partial, sums u32 x 5
  loop_back = 0x15,          // any bytes -> their complements
  abort = 0x16,              // halves u8, bit h for half h: emptied
};
inline constexpr uint8_t answer_bit = 0x80;
inline constexpr uint8_t refusal = 0xFF;  // in place of a command: the frame was not understood

enum class result : uint8_t {
  ok,
  half_busy, half_not_loaded, half_not_started, bad_address, engine_error, engine_timeout,  // of the engine
  pending,                                                                                  // read_span: still computing
  unknown_command, bad_payload, bad_coefficients, other_version, other_profile,
  // in refusals
  incomplete, bad_length, bad_crc, bad_seal,
};
inline constexpr result last_result = result::bad_seal;

constexpr result to_result(status s) {
  switch (s) {
    case status::ok: return result::ok;
    case status::half_busy: return result::half_busy;
    case status::half_not_loaded: return result::half_not_loaded;
    case status::half_not_started: return result::half_not_started;
    case status::bad_address: return result::bad_address;
    case status::device_timeout: return result::engine_timeout;
    default: return result::engine_error;
  }
}

constexpr status to_status(result r) {
  switch (r) {
    case result::ok: return status::ok;
    case result::half_busy: return status::half_busy;
    case result::half_not_loaded: return status::half_not_loaded;
    case result::half_not_started: return status::half_not_started;
    case result::bad_address: return status::bad_address;
    case result::engine_timeout: return status::device_timeout;
    case result::other_version: case result::other_profile: return status::mismatch;
    default: return status::device_error;
  }
}

constexpr const char* to_string(result r) {
  switch (r) {
    case result::ok: return "ok";
    case result::half_busy: return "half is busy";
    case result::half_not_loaded: return "half is not loaded";
    case result::half_not_started: return "half was not started";
    case result::bad_address: return "word address beyond local texture memory";
    case result::engine_error: return "engine failed";
    case result::engine_timeout: return "engine did not answer in time";
    case result::pending: return "still computing";
    case result::unknown_command: return "unknown command";
    case result::bad_payload: return "payload not as the command wants it";
    case result::bad_coefficients: return "coefficients outside the datapath's ranges";
    case result::other_version: return "another version of the protocol";
    case result::other_profile: return "another profile";
    case result::incomplete: return "frame incomplete";
    case result::bad_length: return "frame too long";
    case result::bad_crc: return "CRC-16 does not match";
    case result::bad_seal: return "seal does not match: damaged, or of another session";
  }
  return "unknown result";
}

// --- checksums -----------------------------------------------------------------------------------------

namespace detail {

struct crc_tables {
  uint16_t crc16[16] = {};
  uint32_t crc32[16] = {};
  constexpr crc_tables() {
    for (uint32_t n = 0; n < 16; ++n) {
      uint32_t high = n << 12, low = n;
      for (int bit = 0; bit < 4; ++bit) {
        high = ((high << 1) ^ ((high & 0x8000u) != 0 ? 0x1021u : 0u)) & 0xFFFFu;
        low = (low >> 1) ^ ((low & 1u) != 0 ? 0xEDB88320u : 0u);
      }
      crc16[n] = uint16_t(high);
      crc32[n] = low;
    }
  }
};
inline constexpr crc_tables crc_table;

}  // namespace detail

// CRC-16/IBM-3740 ("CCITT-FALSE"): polynomial 0x1021, from 0xFFFF, not reflected. "123456789" gives 0x29B1.
struct crc16 {
  uint16_t value = 0xFFFF;
  constexpr void add(uint8_t byte) {
    step(uint32_t(byte) >> 4);
    step(uint32_t(byte) & 15u);
  }

 private:
  constexpr void step(uint32_t nibble) {
    value = uint16_t(((uint32_t(value) << 4) & 0xFFFFu) ^ detail::crc_table.crc16[(uint32_t(value) >> 12) ^ nibble]);
  }
};

// CRC-32/ISO-HDLC. "123456789" gives 0xCBF43926.
struct crc32 {
  uint32_t state = 0xFFFFFFFFu;
  constexpr void add(uint8_t byte) {
    state ^= byte;
    state = (state >> 4) ^ detail::crc_table.crc32[state & 15u];
    state = (state >> 4) ^ detail::crc_table.crc32[state & 15u];
  }
  constexpr void add_u32(uint32_t x) {
    for (int k = 0; k < 4; ++k) add(uint8_t(x >> (8 * k)));
  }
  constexpr uint32_t value() const { return ~state; }
};

// --- fields --------------------------------------------------------------------------------------------

// Writes fields into bytes of fixed room; what does not fit makes it not good.
class field_writer {
 public:
  constexpr field_writer(uint8_t* bytes, int room) : bytes_(bytes), room_(room) {}
  template <class Int>
  constexpr void operator()(const Int& value) {
    if (room_ - size_ < int(sizeof(Int))) good_ = false;
    if (!good_) return;
    for (size_t k = 0; k < sizeof(Int); ++k) bytes_[size_++] = uint8_t(uint64_t(value) >> (8 * k));
  }
  template <class Enum>
  constexpr void one_of(const Enum& value, Enum) { (*this)(uint8_t(value)); }
  constexpr bool good() const { return good_; }
  constexpr int size() const { return size_; }

 private:
  uint8_t* bytes_;
  int room_, size_ = 0;
  bool good_ = true;
};

// Reads fields; bytes that are missing, or values that do not exist, make it not good and leave the field as it is.
class field_reader {
 public:
  constexpr field_reader(const uint8_t* bytes, int size) : bytes_(bytes), size_(size) {}
  template <class Int>
  constexpr void operator()(Int& value) {
    uint64_t sum = 0;
    if (left() < int(sizeof(Int))) good_ = false;
    if (!good_) return;
    for (size_t k = 0; k < sizeof(Int); ++k) sum |= uint64_t(bytes_[at_++]) << (8 * k);
    value = Int(sum);
  }
  constexpr void operator()(bool& value) {
    uint8_t byte = 0;
    (*this)(byte);
    if (byte > 1) good_ = false;
    if (good_) value = byte == 1;
  }
  template <class Enum>
  constexpr void one_of(Enum& value, Enum last) {
    uint8_t byte = 0;
    (*this)(byte);
    if (byte > uint8_t(last)) good_ = false;
    if (good_) value = Enum(byte);
  }
  constexpr bool good() const { return good_; }
  constexpr int left() const { return size_ - at_; }
  constexpr bool at_end() const { return good_ && at_ == size_; }

 private:
  const uint8_t* bytes_;
  int size_, at_ = 0;
  bool good_ = true;
};

namespace detail {

// Counts what an archive would write.
struct field_counter {
  int size = 0;
  template <class Int>
  constexpr void operator()(const Int&) { size += int(sizeof(Int)); }
  template <class Enum>
  constexpr void one_of(const Enum&, Enum) { size += 1; }
};

template <class Record>
constexpr int archived_bytes() {
  Record r{};
  field_counter counter;
  spantex::detail::archive(counter, r);
  return counter.size;
}

}  // namespace detail

inline constexpr int coefficient_bytes = detail::archived_bytes<span_coefficients>();
inline constexpr int most_pixel_bytes = 8 + 1 + span_pixel_count * channel_count;

// --- records -------------------------------------------------------------------------------------------

inline constexpr int profile_field_count = [] {
  int n = 0;
  spantex::detail::for_each_field(profile{}, [&](const char*, int) { ++n; });
  return n;
}();

struct profile_fields { int16_t value[profile_field_count]; };

constexpr profile_fields fields_of(const profile& p) {
  profile_fields f{};
  int n = 0;
  spantex::detail::for_each_field(p, [&](const char*, int value) { f.value[n++] = int16_t(value); });
  return f;
}

template <class Archive>
constexpr void archive(Archive& a, profile_fields& f) {
  for (int16_t& v : f.value) a(v);
}

// What a device says about itself. `coefficient_bytes` tells apart libraries whose coefficients have other fields.
struct identity {
  uint32_t magic = identity_magic;
  uint16_t version = protocol_version;
  uint16_t coefficient_bytes = bench::coefficient_bytes;
  uint16_t word_count = 0;   // of one half's local memory
  uint16_t burst_words = 0;  // most words in one load_words
  profile_fields profile{};
};

template <class Archive>
constexpr void archive(Archive& a, identity& d) {
  a(d.magic); a(d.version); a(d.coefficient_bytes); a(d.word_count); a(d.burst_words);
  archive(a, d.profile);
}

struct device_status {
  bool started[2] = {}, computed[2] = {};  // by half
  uint32_t frames_accepted = 0, frames_refused = 0, frames_repeated = 0;
};

template <class Archive>
constexpr void archive(Archive& a, device_status& s) {
  for (bool& b : s.started) a(b);
  for (bool& b : s.computed) a(b);
  a(s.frames_accepted); a(s.frames_refused); a(s.frames_repeated);
}

}  // namespace spantex::bench
