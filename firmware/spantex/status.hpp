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
  bad_levels,       // mip levels whose sizes do not follow floor(size / 2^L)
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
};

constexpr const char* to_string(status s) {
  switch (s) {
    case status::ok: return "ok";
    case status::bad_size: return "size out of range";
    case status::bad_pointer: return "null pointer";
    case status::bad_levels: return "mip level sizes are not floor(size / 2^L)";
    case status::out_of_range: return "number out of range";
    case status::degenerate: return "degenerate: nothing to draw";
    case status::half_busy: return "half is busy";
    case status::half_not_loaded: return "half is not loaded";
    case status::half_not_started: return "half was not started";
    case status::bad_address: return "word address beyond local texture memory";
    case status::device_error: return "engine failed";
    case status::device_timeout: return "engine did not answer in time";
    case status::mismatch: return "operation differs from the recording";
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
