// SPDX-License-Identifier: Apache-2.0
#include "archive.hpp"

#include <zip.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace spantex::sim {

namespace fs = std::filesystem;

void archive::closed::operator()(zip* z) const { zip_discard(z); }

archive::archive(std::string path) : path_(std::move(path)) {
  int code = 0;
  zip_.reset(zip_open(path_.c_str(), ZIP_RDONLY, &code));
  if (zip_) return;
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string why = zip_error_strerror(&error);
  zip_error_fini(&error);
  throw input_error(path_ + ": cannot read archive: " + why);
}

std::vector<std::string> archive::names() const {
  std::vector<std::string> all;
  for (zip_int64_t k = 0; k < zip_get_num_entries(zip_.get(), 0); ++k)
    if (const char* name = zip_get_name(zip_.get(), zip_uint64_t(k), 0)) all.emplace_back(name);
  return all;
}

std::optional<bytes> archive::read(const std::string& name) const {
  const zip_int64_t at = zip_name_locate(zip_.get(), name.c_str(), ZIP_FL_NOCASE);
  if (at < 0) return {};
  const auto bad = [&](const char* why) { return input_error(path_ + ": " + name + ": " + why); };
  zip_stat_t about;
  if (zip_stat_index(zip_.get(), zip_uint64_t(at), 0, &about) != 0 || (about.valid & ZIP_STAT_SIZE) == 0) throw bad("damaged");
  if (about.size > max_file_bytes) throw bad("too large");
  const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(zip_fopen_index(zip_.get(), zip_uint64_t(at), 0), zip_fclose);
  if (!file) throw bad("damaged or encrypted");
  bytes data(about.size);
  uint8_t beyond = 0;  // there is none; where the end is read the checksum is compared
  if (zip_fread(file.get(), data.data(), data.size()) != zip_int64_t(data.size()) || zip_fread(file.get(), &beyond, 1) != 0) throw bad("damaged: not of the size or checksum that it has in the archive");
  return data;
}

search_path::search_path(const std::string& folder) : folder_(folder) {
  std::vector<std::string> found;
  std::error_code ignored;
  for (const fs::directory_entry& e : fs::directory_iterator(folder, ignored))
    if (lower(e.path().extension().string()) == ".pk3") found.push_back(e.path().string());
  std::sort(found.begin(), found.end());
  for (std::string& path : found) {
    try {
      archives_.emplace_back(std::move(path));
    } catch (const input_error&) {  // what happens to lie beside the file asked for
    }
  }
}

std::vector<std::string> search_path::archives() const {
  std::vector<std::string> paths;
  for (const std::vector<archive>* some : {&preferred_, &archives_})
    for (const archive& a : *some) paths.push_back(a.path());
  return paths;
}

namespace {

std::optional<found_file> found_in(const std::vector<archive>& archives, const std::string& name) {
  for (const archive& a : archives)
    if (std::optional<bytes> data = a.read(name)) return found_file{std::move(*data), a.path() + ": " + name};
  return {};
}

}  // namespace

std::optional<found_file> search_path::read(const std::string& name) const {
  const fs::path wanted(name);
  if (wanted.is_absolute() || std::find(wanted.begin(), wanted.end(), "..") != wanted.end()) return {};
  if (std::optional<found_file> f = found_in(preferred_, name)) return f;
  std::error_code ignored;
  const std::string path = (fs::path(folder_) / wanted).string();
  if (fs::is_regular_file(path, ignored)) return found_file{read_file(path), path, true};
  return found_in(archives_, name);
}

}  // namespace spantex::sim
