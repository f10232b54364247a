// SPDX-License-Identifier: Apache-2.0
#include "sweep_record.hpp"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>

#include <sim/file.hpp>

namespace spantex::tool {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) { throw sim::input_error(path + ": " + what); }

size_t column_count() { return 3 + sweep_axes().size() + size_t(sim::measure_count); }

struct row_place {
  uint64_t number;
  std::string text;  // without the line break
  int line;
};

// The point of a row of this study; the reason why it is none otherwise.
std::string number_of(const std::string& row, const sweep_spec& spec, uint64_t& number) {
  if (row.compare(0, 17, spec.study() + ",") != 0) return "a row of another study";
  if (size_t(std::count(row.begin(), row.end(), ',')) + 1 != column_count()) return "not " + std::to_string(column_count()) + " columns";
  const size_t part = row.find(',', 17);
  const char* const digits = row.c_str() + part + 1;
  char* end = nullptr;
  errno = 0;
  number = strtoull(digits, &end, 10);
  if (errno != 0 || end == digits || *end != ',' || number >= spec.points()) return "no point of this study";
  return {};
}

// What the write of a line that was cut short leaves: a beginning of the heading, or of a row of this study.
bool is_torn(const std::string& text, int line, const sweep_spec& spec) {
  const std::string begins = line == 1 ? sweep_heading() : spec.study() + ",";
  const size_t common = std::min(text.size(), begins.size());
  return (line > 1 || text.size() <= begins.size()) && text.compare(0, common, begins, 0, common) == 0;
}

// Calls row(row_place) for each whole row; returns the bytes up to the last whole line. A torn last line is none.
uint64_t read_record(const std::string& path, const sweep_spec& spec, const std::function<void(const row_place&)>& row) {
  struct stat about {};
  if (stat(path.c_str(), &about) == 0 && S_ISDIR(about.st_mode)) fail(path, strerror(EISDIR));
  std::ifstream in(path, std::ios::binary);
  if (!in) fail(path, strerror(errno));
  std::string text;
  uint64_t whole = 0;
  for (int line = 1; std::getline(in, text); ++line) {
    const auto refused = [&](const std::string& reason) { fail(path + ":" + std::to_string(line), reason); };
    if (in.eof()) {
      if (is_torn(text, line, spec)) break;
      refused(line == 1 ? "not a record of a sweep by this version" : "neither a row of this study nor the beginning of one");
    }
    if (line == 1) {
      if (text != sweep_heading()) refused("not a record of a sweep by this version");
    } else {
      row_place place{0, text, line};
      const std::string reason = number_of(text, spec, place.number);
      if (!reason.empty()) refused(reason);
      row(place);
    }
    whole += text.size() + 1;
  }
  return whole;
}

void write_all(int file, const std::string& path, const std::string& text) {
  const ssize_t written = write(file, text.data(), text.size());
  if (written != ssize_t(text.size())) fail(path, std::string("cannot be written: ") + strerror(written < 0 ? errno : ENOSPC));
}

std::string printed(double x, int decimals) {
  if (isnan(x)) return {};
  if (isinf(x)) return "inf";
  char text[64];
  snprintf(text, sizeof text, "%.*f", decimals, x);
  return strcmp(text, "-0") == 0 ? "0" : text;
}

}  // namespace

std::string point_heading() {
  std::string text = "study,part,point";
  for (const sweep_axis& a : sweep_axes()) text += "," + std::string(a.name);
  return text;
}

std::string point_columns(const sweep_spec& spec, uint64_t number, const numbered_point& p) {
  std::string text = spec.study() + "," + p.part->name + "," + std::to_string(number);
  for (const sweep_axis& a : sweep_axes()) text += "," + a.get(p.point);
  return text;
}

std::string sweep_heading() {
  std::string text = point_heading();
  for (const auto& c : sim::measure_columns) text += "," + std::string(c.name);
  return text;
}

std::string sweep_row(const sweep_spec& spec, uint64_t number, const numbered_point& p, const sim::sweep_result& r) {
  std::string text = point_columns(spec, number, p);
  for (size_t k = 0; k < sim::measure_columns.size(); ++k) text += "," + printed(r.value[k], sim::measure_columns[k].decimals);
  return text;
}

sweep_record::sweep_record(const std::string& path, const sweep_spec& spec) : path_(path), done_(size_t(spec.points())) {
  file_ = open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file_ < 0) fail(path, std::string("cannot be written: ") + strerror(errno));
  struct stat about {};
  const bool is_file = fstat(file_, &about) == 0 && S_ISREG(about.st_mode);
  try {
    if (!is_file) fail(path, "not a file that a run can go on with");
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) fail(path, "in use by another run");
    read_rows(spec);
  } catch (...) {
    close(file_);
    throw;
  }
}

sweep_record::~sweep_record() { close(file_); }

void sweep_record::read_rows(const sweep_spec& spec) {
  const uint64_t whole = read_record(path_, spec, [&](const row_place& row) {
    if (done_[size_t(row.number)]) fail(path_ + ":" + std::to_string(row.line), "point " + std::to_string(row.number) + " twice");
    done_[size_t(row.number)] = true;
    ordered_ = ordered_ && (!any_ || row.number > last_);
    last_ = row.number;
    any_ = true;
  });
  struct stat about {};
  const bool torn = fstat(file_, &about) != 0 || uint64_t(about.st_size) != whole;
  if (torn && ftruncate(file_, off_t(whole)) != 0) fail(path_, std::string("cannot be cut: ") + strerror(errno));
  if (whole == 0) write_all(file_, path_, sweep_heading() + "\n");
}

void sweep_record::append(uint64_t number, const std::string& row) {
  const std::lock_guard guard(lock_);
  write_all(file_, path_, row + "\n");
  ordered_ = ordered_ && (!any_ || number > last_);
  last_ = number;
  any_ = true;
}

void sweep_record::finish() {
  if (ordered_) return;
  std::vector<std::pair<uint64_t, std::string>> rows;
  std::ifstream in(path_, std::ios::binary);
  std::string text, all;
  std::getline(in, all);
  while (std::getline(in, text)) {
    const size_t comma = text.find(',', 17);
    rows.emplace_back(strtoull(text.c_str() + comma + 1, nullptr, 10), text);
  }
  std::sort(rows.begin(), rows.end());
  for (const auto& [number, row] : rows) all += "\n" + row;
  sim::output_file(path_).write(all + "\n");
  ordered_ = true;
}

void merge_records(const sweep_spec& spec, const std::vector<std::string>& paths, const std::string& out) {
  const sim::output_file merged(out);
  struct found_row { size_t file; int line; std::string text; };
  std::map<uint64_t, found_row> rows;
  for (size_t f = 0; f < paths.size(); ++f)
    read_record(paths[f], spec, [&](const row_place& row) {
      const auto [at, is_new] = rows.try_emplace(row.number, found_row{f, row.line, row.text});
      const found_row& o = at->second;
      const std::string here = paths[f] + ":" + std::to_string(row.line);
      if (!is_new) fail(here, "point " + std::to_string(row.number) + " is in " + paths[o.file] + ":" + std::to_string(o.line) + " already");
    });
  if (const uint64_t missing = spec.points() - rows.size(); missing != 0) {
    uint64_t first = 0;
    while (rows.contains(first)) ++first;
    fail(out, std::to_string(missing) + " of " + std::to_string(spec.points()) + " points are missing, the first is " + std::to_string(first) + ": nothing written");
  }
  std::string all = sweep_heading() + "\n";
  for (const auto& [number, row] : rows) all += row.text + "\n";
  merged.write(all);
}

}  // namespace spantex::tool
