// SPDX-License-Identifier: Apache-2.0
// Traces of a simulated engine: what the loader, the pipeline and the two halves did in which cycles. The engine writes records into a
// sink; two writers turn them into a VCD waveform (GTKWave) and a Chrome/Perfetto timeline (JSON trace events). Both stream: what they
// hold is bounded by two jobs, not by the length of the run. One cycle is 1 ns in VCD and 1 us in JSON.
#pragma once
#include <stdint.h>

#include <iosfwd>
#include <map>
#include <utility>

#include <hal/engine.hpp>
#include <sim/timing.hpp>

namespace spantex::sim {

struct load_record {
  half target;
  bool coefficients;  // else texels
  int first_word;     // local address
  int words;
  interval time;
};

struct compute_record {
  half target;
  int pixels;
  interval issue;  // pixels enter the pipeline
  cycle end;       // the last one is written out
};

class trace_sink {
 public:
  virtual ~trace_sink() = default;
  virtual void load(const load_record&) = 0;
  virtual void compute(const compute_record&) = 0;
  virtual void stall(interval) = 0;
  virtual void mark(cycle, event) = 0;
  virtual void settled(cycle) = 0;  // no later record begins before this cycle
};

// Value change dump. Scopes loader, pipeline, half0, half1; state of a half: 0 empty, 1 loading, 2 loaded, 3 computing, 4 done.
class vcd_writer final : public trace_sink {
 public:
  explicit vcd_writer(std::ostream& out);
  ~vcd_writer() override { finish(); }
  vcd_writer(const vcd_writer&) = delete;
  vcd_writer& operator=(const vcd_writer&) = delete;

  void load(const load_record&) override;
  void compute(const compute_record&) override;
  void stall(interval) override;
  void mark(cycle, event) override;
  void settled(cycle) override;
  void finish();  // writes what is held; nothing may follow

  enum signal : uint8_t {
    loader_busy, loader_half, loader_coefficients, loader_address, pipeline_busy, pipeline_half, pipeline_stall, pipeline_span_pixels,
    pipeline_pixel_count, pipeline_span_x, pipeline_span_y, half0_state, half1_state, signal_count
  };

 private:
  void set(cycle at, int which, uint64_t value);
  void flush(cycle before);

  std::ostream& out_;
  std::map<std::pair<cycle, int>, uint64_t> pending_;  // by time, then signal; a later record for the same instant wins
  uint64_t current_[signal_count] = {};
  cycle now_ = 0;
  uint64_t pixels_ = 0;
  bool finished_ = false;
};

// Chrome trace events: tracks loader, pipeline, half 0, half 1. A half's bursts for one job are one slice.
class timeline_writer final : public trace_sink {
 public:
  explicit timeline_writer(std::ostream& out);
  ~timeline_writer() override { finish(); }
  timeline_writer(const timeline_writer&) = delete;
  timeline_writer& operator=(const timeline_writer&) = delete;

  void load(const load_record&) override;
  void compute(const compute_record&) override;
  void stall(interval) override;
  void mark(cycle, event) override;
  void settled(cycle) override {}
  void finish();  // closes the document; nothing may follow

 private:
  struct loading_slice {
    interval time;
    int words = 0;
    bool open = false;
  };
  void close_loading(half h);

  std::ostream& out_;
  loading_slice loading_[half_count];
  bool finished_ = false, first_ = true;

  template <class Json> void write(const Json& entry);
};

}  // namespace spantex::sim
