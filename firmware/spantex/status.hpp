// SPDX-License-Identifier: Apache-2.0
// Errors that the world causes, without exceptions. A function lists the codes it can return.
#pragma once
#include <stdint.h>

namespace spantex {

enum class [[nodiscard]] status : uint8_t {
  ok,
  // what a caller handed over
  bad_size,         // a width, height or level count outside the supported range
  bad_pointer,      // a null pointer where texels or pixels are needed
  bad_alignment,    // texels at an address that their format does not allow
  out_of_memory,    // more than the caller's memory holds
  bad_levels,       // mip levels: none, more than the size has, or of sizes that a call does not take
  out_of_range,     // a number outside its documented range
  degenerate,       // nothing to draw: edge-on plane, zero area, singular set-up
  // what an engine reports
  half_busy,        // a half was loaded while it computes, or started twice
  half_not_loaded,  // a half was started before coefficients and texels were loaded
  half_not_started, // pixels were taken from a half that was never started
  bad_address,      // words beyond the end of local texture memory
  device_error,     // the engine failed
  device_timeout,   // the engine did not answer in time
  mismatch,         // a replayed operation differs from the recorded one
  // what is wrong with a texture pack
  pack_misaligned,  // its bytes are not at a multiple of 8
  pack_truncated,   // fewer bytes than it says it has
  pack_not_a_pack,  // it does not begin as one
  pack_bad_version, // made for another version of the library
  pack_bad_header,  // the header's checksum is wrong
  pack_bad_field,   // a header field holds what is not defined
  pack_bad_layout,  // levels are not where, or as long as, format and size say
  pack_byte_order,  // 16-bit texels of the other byte order
  pack_bad_payload, // the checksum of the texels is wrong
};

constexpr const char* to_string(status s) {
  switch (s) {
    case status::ok: return "ok";
    case status::bad_size: return "size out of range";
    case status::bad_pointer: return "null pointer";
    case status::bad_alignment: return "texels at an odd address";
    case status::out_of_memory: return "out of texture memory";
    case status::bad_levels: return "mip levels of a number or size not taken";
    case status::out_of_range: return "number out of range";
    case status::degenerate: return "degenerate: nothing to draw";
    case status::half_busy: return "half is busy";
    case status::half_not_loaded: return "half is not loaded";
    case status::half_not_started: return "half was not started";
    case status::bad_address: return "word address beyond local texture memory";
    case status::device_error: return "engine failed";
    case status::device_timeout: return "engine did not answer in time";
    case status::mismatch: return "operation differs from the recording";
    case status::pack_misaligned: return "texture pack is not at a multiple of 8 bytes";
    case status::pack_truncated: return "texture pack is truncated";
    case status::pack_not_a_pack: return "not a texture pack";
    case status::pack_bad_version: return "texture pack of an unknown version";
    case status::pack_bad_header: return "texture pack is damaged: checksum of its header";
    case status::pack_bad_field: return "texture pack has an undefined header field";
    case status::pack_bad_layout: return "texture pack has levels that do not fit its format and size";
    case status::pack_byte_order: return "texture pack has 16-bit texels of the other byte order";
    case status::pack_bad_payload: return "texture pack is damaged: checksum of its texels";
  }
  return "unknown status";
}

}  // namespace spantex

// Passes a failure up: the one way errors travel.
#define SPANTEX_TRY(expression)                                              \
  do {                                                                       \
    if (const ::spantex::status spantex_try_status = (expression);           \
        spantex_try_status != ::spantex::status::ok)                         \
      return spantex_try_status;                                             \
  } while (0)
