// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include <stdio.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace spantex::tool {

progress_bar::progress_bar(std::string label, int total)
    : label_(std::move(label)), total_(std::max(1, total)), on_terminal_(isatty(2) != 0) {}

progress_bar::~progress_bar() {
  if (shown_) fputs("\r\033[K", stderr);
}

void progress_bar::advance(int parts) {
  using namespace std::chrono_literals;
  if (!on_terminal_) return;
  const std::lock_guard guard(lock_);
  done_ = std::min(total_, done_ + parts);
  const clock::time_point now = clock::now();
  if (now - begun_ < 400ms || now - drawn_ < 80ms) return;
  constexpr int width = 40;
  const int full = int(int64_t(width) * done_ / total_), percent = int(int64_t(100) * done_ / total_);
  const std::string bar = std::string(size_t(full), '#') + std::string(size_t(width - full), '.');
  const double spent_s = std::chrono::duration<double>(now - begun_).count();
  const auto left_s = int64_t(spent_s * (total_ - done_) / std::max(1, done_) + 0.5);
  char left[48];
  if (left_s < 100) snprintf(left, sizeof left, "%lld s", static_cast<long long>(left_s));
  else snprintf(left, sizeof left, "%lld min", static_cast<long long>((left_s + 30) / 60));
  fprintf(stderr, "\r\033[K%s [%s] %d %%, %s left", label_.c_str(), bar.c_str(), percent, left);
  drawn_ = now;
  shown_ = true;
}

sim::progress_callback progress_bar::callback() {
  if (!on_terminal_) return {};
  return [this](int parts) { advance(parts); };
}

}  // namespace spantex::tool
