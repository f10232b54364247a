// SPDX-License-Identifier: Apache-2.0
#include "file.hpp"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

namespace spantex::sim {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const char* what, int error) {
  throw input_error(path + ": " + what + ": " + strerror(error));
}

[[noreturn]] void too_large(const std::string& path) {
  throw input_error(path + ": cannot read: larger than " + std::to_string(max_file_bytes >> 20) + " MiB");
}

// An open file that closes itself, and removes its path unless kept.
class descriptor {
 public:
  descriptor(std::string path, int flags, bool temporary) : path_(std::move(path)), temporary_(temporary) {
    fd_ = open(path_.c_str(), flags | O_CLOEXEC, 0666);
    error_ = fd_ < 0 ? errno : 0;
  }
  descriptor(const descriptor&) = delete;
  descriptor& operator=(const descriptor&) = delete;
  ~descriptor() {
    if (fd_ < 0) return;
    close(fd_);
    if (temporary_) unlink(path_.c_str());
  }
  bool good() const { return fd_ >= 0; }
  int error() const { return error_; }
  int number() const { return fd_; }
  const std::string& path() const { return path_; }
  void keep() { temporary_ = false; }

 private:
  std::string path_;
  int fd_ = -1, error_ = 0;
  bool temporary_;
};

// 0 for what has no size before it is read: pipes, devices.
size_t regular_size(const descriptor& in) {
  struct stat about;
  if (fstat(in.number(), &about) != 0) fail(in.path(), "cannot read", errno);
  if (!S_ISREG(about.st_mode)) return 0;
  if (about.st_size > off_t(max_file_bytes)) too_large(in.path());
  return size_t(about.st_size);
}

// Where a path leads: links followed, so that a link stays a link when its target is replaced.
fs::path resolved(const std::string& path) {
  std::error_code ignored;
  const fs::path p = fs::is_symlink(path, ignored) ? fs::canonical(path, ignored) : fs::path(path);
  return p.empty() ? fs::path(path) : p;
}

std::string temporary_beside(const fs::path& target) {
  return (target.parent_path() / ("." + target.filename().string() + "." + std::to_string(getpid()) + ".tmp")).string();
}

bool is_special(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_regular_file(path, ignored) && !fs::is_directory(path, ignored);
}

void write_all(int fd, const uint8_t* data, size_t size, const std::string& path) {
  while (size > 0) {
    const ssize_t n = ::write(fd, data, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail(path, "cannot write", n < 0 ? errno : ENOSPC);
    data += n;
    size -= size_t(n);
  }
}

}  // namespace

std::string lower(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
  return name;
}

std::string place_of(const std::string& path) {
  const fs::path target = resolved(path);
  if (is_special(target)) return {};
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(target, error);
  return fs::absolute(whole.empty() ? target : whole, error).string();
}

bytes read_file(const std::string& path) {
  const descriptor in(path, O_RDONLY, false);
  if (!in.good()) fail(path, "cannot read", in.error());
  bytes data;
  data.reserve(regular_size(in));
  uint8_t block[65536];
  for (;;) {
    const ssize_t n = ::read(in.number(), block, sizeof block);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(path, "cannot read", errno);
    if (n == 0) return data;
    if (data.size() + size_t(n) > max_file_bytes) too_large(path);
    data.insert(data.end(), block, block + n);
  }
}

output_file::output_file(std::string path) : path_(std::move(path)) {
  if (path_.empty()) throw input_error("output file: empty name");
  std::error_code ignored;
  if (fs::is_directory(path_, ignored)) throw input_error(path_ + ": cannot write: is a directory");
  const fs::path target = resolved(path_);
  if (is_special(target)) return;
  const descriptor trial(temporary_beside(target), O_WRONLY | O_CREAT | O_EXCL, true);
  if (!trial.good()) fail(path_, "cannot write", trial.error());
}

void output_file::write(const bytes& data) const {
  output_files alone;
  alone.write(*this, data);
  alone.commit();
}

void output_file::write(std::string_view text) const {
  output_files alone;
  alone.write(*this, text);
  alone.commit();
}

output_files::~output_files() {
  for (const waiting_file& w : waiting_) unlink(w.temporary.c_str());
}

void output_files::write(const std::string& path, const uint8_t* data, size_t size) {
  const fs::path target = resolved(path);
  const bool special = is_special(target);
  descriptor out(special ? target.string() : temporary_beside(target), special ? O_WRONLY : O_WRONLY | O_CREAT | O_EXCL, !special);
  if (!out.good()) fail(path, "cannot write", out.error());
  write_all(out.number(), data, size, path);
  if (special) return;
  waiting_.push_back({path, out.path(), target.string()});
  out.keep();
}

void output_files::commit() {
  for (; !waiting_.empty(); waiting_.erase(waiting_.begin())) {
    const waiting_file& w = waiting_.front();
    if (rename(w.temporary.c_str(), w.target.c_str()) != 0) fail(w.path, "cannot write", errno);
  }
}

}  // namespace spantex::sim
