// SPDX-License-Identifier: Apache-2.0
// The record of a sweep: a CSV file to which rows are appended as points are judged, one write a row, so that whatever ends the program leaves whole rows
// and at most one torn one, which the next run cuts off. Rows of points that are there are not made again.
#pragma once
#include <stdint.h>

#include <mutex>
#include <string>
#include <vector>

#include <sim/sweep_point.hpp>
#include "sweep_spec.hpp"

namespace spantex::tool {

// What a point is: study, part, number and every axis. Without a line break, as all of these.
std::string point_heading();
std::string point_columns(const sweep_spec& spec, uint64_t number, const numbered_point& p);
// The same, then what it is worth.
std::string sweep_heading();
std::string sweep_row(const sweep_spec& spec, uint64_t number, const numbered_point& p, const sim::sweep_result& r);

class sweep_record {
 public:
  // Opens or makes the file. Throws sim::input_error: not writable, in use by another run, another study's, a row that is none of this study's.
  sweep_record(const std::string& path, const sweep_spec& spec);
  ~sweep_record();
  sweep_record(const sweep_record&) = delete;
  sweep_record& operator=(const sweep_record&) = delete;

  bool has(uint64_t number) const { return done_[size_t(number)]; }
  void append(uint64_t number, const std::string& row);  // from any thread
  // Rows in the order of their points, whatever the order they came in.
  void finish();

 private:
  void read_rows(const sweep_spec& spec);

  std::string path_;
  int file_ = -1;
  std::vector<bool> done_;
  uint64_t last_ = 0;
  bool ordered_ = true, any_ = false;
  std::mutex lock_;
};

// Rows of several records into one, in the order of their points. Throws sim::input_error, naming file and line: not this study's, a point twice; or, naming the first
// of them, points that are missing. Nothing is written then.
void merge_records(const sweep_spec& spec, const std::vector<std::string>& paths, const std::string& out);

}  // namespace spantex::tool
