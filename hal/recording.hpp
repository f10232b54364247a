// SPDX-License-Identifier: Apache-2.0
// A recording: every operation an engine was given, its arguments and its answer, in memory and as a stream of bytes. Host only.
//
// Stream, little-endian on every machine:
//
//   "STXREC\r\n"  version u32  operations u64  body length u64  body  CRC-32 of all before it u32
//
//   operation in the body: what u8, half u8, status u8, then
//     load_coefficients  the fields in their order          start  mask u64
//     load_words         first i32, count i32, words u64    take   mask u64, partial u8, R G B A of each of its pixels; if partial sums u32 x 5
//     mark               kind u8, value u32
//
// A damaged stream is refused with a reason: nothing of it is used.
#pragma once
#include <stdint.h>

#include <istream>
#include <iterator>
#include <ostream>
#include <string>
#include <vector>

#include <hal/engine.hpp>
#include <hal/operation.hpp>
#include <hal/span_archive.hpp>
#include <spantex/pack.hpp>

namespace spantex {

struct recorded_operation {
  operation what = operation::mark;
  half which = half::first;
  status result = status::ok;
  int32_t first = 0, count = 0;  // load_words
  size_t at = 0;                 // index of the first element in the pool of its kind
  span_mask mask = 0;            // start: as given; take: pixels held
  bool partial = false;          // take: sums instead of pixels
  event note{};                  // mark
};

struct recording {
  std::vector<recorded_operation> operations;
  std::vector<span_coefficients> coefficients;  // pools, in the order of the operations
  std::vector<uint64_t> words;
  std::vector<rgba8> pixels;
  std::vector<footprint_sums> sums;
};

namespace detail {

inline uint32_t crc_of(const std::string& bytes, size_t count) { return crc32(reinterpret_cast<const uint8_t*>(bytes.data()), count); }

// One field at a time, in either direction; a class of bytes to write and one of bytes to read.
class byte_writer {
 public:
  std::string bytes;
  template <class Int>
  void operator()(const Int& value) {
    for (size_t k = 0; k < sizeof(Int); ++k) bytes.push_back(char(uint64_t(value) >> (8 * k)));
  }
  template <class Enum>
  void one_of(const Enum& value, Enum) { (*this)(uint8_t(value)); }
};

class byte_reader {
 public:
  byte_reader(const std::string& bytes, size_t begin, size_t end) : bytes_(bytes), at_(begin), end_(end) {}

  template <class Int>
  void operator()(Int& value) {
    uint64_t sum = 0;
    if (end_ - at_ < sizeof(Int)) good_ = false;
    if (!good_) return;
    for (size_t k = 0; k < sizeof(Int); ++k) sum |= uint64_t(uint8_t(bytes_[at_++])) << (8 * k);
    value = Int(sum);
  }
  void operator()(bool& value) {
    uint8_t byte = 0;
    (*this)(byte);
    if (byte > 1) good_ = false;
    value = byte == 1;
  }
  // Values up to `last` exist.
  template <class Enum>
  void one_of(Enum& value, Enum last) {
    uint8_t byte = 0;
    (*this)(byte);
    if (byte > uint8_t(last)) good_ = false;
    if (good_) value = Enum(byte);
  }

  void refuse() { good_ = false; }
  bool good() const { return good_; }
  size_t left() const { return end_ - at_; }
  size_t at() const { return at_; }

 private:
  const std::string& bytes_;
  size_t at_, end_;
  bool good_ = true;
};

inline constexpr char recording_magic[] = "STXREC\r\n";
inline constexpr size_t magic_length = sizeof recording_magic - 1;
inline constexpr uint32_t recording_version = 5;
inline constexpr size_t header_length = magic_length + 4 + 8 + 8, checksum_length = 4;

inline void write_operation(byte_writer& out, const recording& log, const recorded_operation& op) {
  out(uint8_t(op.what));
  out(uint8_t(op.which));
  out(uint8_t(op.result));
  switch (op.what) {
    case operation::load_coefficients: {
      span_coefficients c = log.coefficients[op.at];
      archive(out, c);
      break;
    }
    case operation::load_words:
      out(op.first);
      out(op.count);
      for (int32_t k = 0; k < op.count; ++k) out(log.words[op.at + size_t(k)]);
      break;
    case operation::start: out(op.mask); break;
    case operation::take: {
      out(op.mask);
      out(op.partial);
      if (op.partial) {
        footprint_sums sums = log.sums[op.at];
        archive(out, sums);
        break;
      }
      const size_t count = size_t(__builtin_popcountll(op.mask));
      for (size_t k = 0; k < count; ++k) {
        const rgba8 p = log.pixels[op.at + k];
        out(p.r); out(p.g); out(p.b); out(p.a);
      }
      break;
    }
    case operation::mark:
      out(uint8_t(op.note.kind));
      out(op.note.value);
      break;
  }
}

inline void read_words(byte_reader& in, recording& log, recorded_operation& op) {
  in(op.first);
  in(op.count);
  op.at = log.words.size();
  if (op.count > 0 && in.left() / 8 < size_t(op.count)) in.refuse();
  for (int32_t k = 0; in.good() && k < op.count; ++k) in(log.words.emplace_back());
}

inline void read_pixels(byte_reader& in, recording& log, recorded_operation& op) {
  in(op.mask);
  in(op.partial);
  if (op.partial) {
    op.at = log.sums.size();
    archive(in, log.sums.emplace_back());
    return;
  }
  op.at = log.pixels.size();
  for (span_mask rest = op.mask; in.good() && rest != 0; rest &= rest - 1) {
    rgba8& p = log.pixels.emplace_back();
    in(p.r); in(p.g); in(p.b); in(p.a);
  }
}

inline void read_operation(byte_reader& in, recording& log) {
  recorded_operation op;
  in.one_of(op.what, operation::mark);
  in.one_of(op.which, half::second);
  in.one_of(op.result, status::mismatch);
  switch (op.what) {
    case operation::load_coefficients:
      op.at = log.coefficients.size();
      archive(in, log.coefficients.emplace_back());
      break;
    case operation::load_words: read_words(in, log, op); break;
    case operation::start: in(op.mask); break;
    case operation::take: read_pixels(in, log, op); break;
    case operation::mark:
      in.one_of(op.note.kind, event_kind::write);
      in(op.note.value);
      break;
  }
  log.operations.push_back(op);
}

}  // namespace detail

// False if the stream does not take it.
inline bool save(std::ostream& out, const recording& log) {
  detail::byte_writer body, file;
  for (const recorded_operation& op : log.operations) detail::write_operation(body, log, op);
  file.bytes.assign(detail::recording_magic, detail::magic_length);
  file(detail::recording_version);
  file(uint64_t(log.operations.size()));
  file(uint64_t(body.bytes.size()));
  file.bytes += body.bytes;
  file(detail::crc_of(file.bytes, file.bytes.size()));
  out.write(file.bytes.data(), std::streamsize(file.bytes.size()));
  return bool(out.flush());
}

// Why the stream is refused, or an empty string; `out` is set only then.
inline std::string load(std::istream& in, recording& out) {
  using namespace detail;
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (bytes.compare(0, magic_length, recording_magic) != 0) return "not a recording: it does not begin with STXREC";
  if (bytes.size() < header_length + checksum_length) return "recording is cut off in its header";
  byte_reader header(bytes, magic_length, header_length);
  uint32_t version = 0;
  uint64_t operations = 0, length = 0;
  header(version);
  header(operations);
  header(length);
  if (version != recording_version)
    return "recording has version " + std::to_string(version) + ", known is " + std::to_string(recording_version);
  const size_t held = bytes.size() - header_length - checksum_length;
  if (held < length) return "recording is cut off: " + std::to_string(held) + " of " + std::to_string(length) + " bytes";
  if (held > length) return "recording is followed by " + std::to_string(held - length) + " bytes that are not part of it";
  uint32_t checksum = 0;
  byte_reader(bytes, bytes.size() - checksum_length, bytes.size())(checksum);
  if (checksum != crc_of(bytes, bytes.size() - checksum_length)) return "recording is damaged: its checksum does not match";
  recording log;
  byte_reader body(bytes, header_length, bytes.size() - checksum_length);
  for (uint64_t k = 0; k < operations; ++k) {
    read_operation(body, log);
    if (!body.good()) return "recording is malformed at operation " + std::to_string(k) + ", before byte " + std::to_string(body.at());
  }
  if (body.left() != 0) return "recording is malformed: " + std::to_string(body.left()) + " bytes after its last operation";
  out = std::move(log);
  return {};
}

}  // namespace spantex
