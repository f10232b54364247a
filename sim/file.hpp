// SPDX-License-Identifier: Apache-2.0
// Files, whole or not at all, and the one kind of error that host code throws: input_error, one line that names the file (or
// option) and the reason.
#pragma once
#include <stdint.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace spantex::sim {

struct input_error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

using bytes = std::vector<uint8_t>;

inline constexpr size_t max_file_bytes = size_t(512) << 20;

// Throws input_error: missing, a directory, unreadable, more than max_file_bytes (an endless device is read no further).
bytes read_file(const std::string& path);

// A file that a long computation will write. Construction checks that it can be written and leaves nothing behind, so that a bad
// path is reported before the work; write() goes to a temporary name beside the target and renames. Both throw input_error.
// Devices and pipes are written directly.
class output_file {
 public:
  output_file() = default;
  explicit output_file(std::string path);
  bool wanted() const { return !path_.empty(); }
  const std::string& path() const { return path_; }
  void write(const bytes& data) const;
  void write(std::string_view text) const;

 private:
  std::string path_;
};

// Files that belong together: all are written under temporary names before the first takes its own, and none is left where one cannot be written. Renaming them may still fail after the first.
class output_files {
 public:
  output_files() = default;
  output_files(const output_files&) = delete;
  output_files& operator=(const output_files&) = delete;
  ~output_files();
  void write(const output_file& file, const bytes& data) { write(file.path(), data.data(), data.size()); }
  void write(const output_file& file, std::string_view text) { write(file.path(), reinterpret_cast<const uint8_t*>(text.data()), text.size()); }
  void commit();  // they take their names; what was written to devices and pipes is there already

 private:
  void write(const std::string& path, const uint8_t* data, size_t size);

  struct waiting_file { std::string path, temporary, target; };
  std::vector<waiting_file> waiting_;
};

// A file's one name, after links and dots: what is written to one place replaces what was there. Empty for devices and pipes, which take any number.
std::string place_of(const std::string& path);

// ASCII letters as small ones: names whose case is ignored.
std::string lower(std::string name);

}  // namespace spantex::sim
