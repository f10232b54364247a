// SPDX-License-Identifier: Apache-2.0
// Files by name from an archive (.pk3, .zip; libzip), from a folder, and from archives beside it, in this order. Case is ignored in archives.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "file.hpp"

struct zip;

namespace spantex::sim {

class archive {
 public:
  explicit archive(std::string path);  // throws input_error: unreadable, no archive
  const std::string& path() const { return path_; }
  std::vector<std::string> names() const;
  // Empty if there is none of this name. Throws input_error: damaged (its checksum is compared), larger than max_file_bytes.
  std::optional<bytes> read(const std::string& name) const;

 private:
  struct closed { void operator()(zip* z) const; };
  std::string path_;
  std::unique_ptr<zip, closed> zip_;
};

struct found_file {
  bytes data;
  std::string name;       // with that of the archive or folder that holds it
  bool is_loose = false;  // in the folder: the name is its path
};

class search_path {
 public:
  explicit search_path(const std::string& folder);  // the folder and every readable .pk3 in it, by name
  void prefer(archive a) { preferred_.push_back(std::move(a)); }  // before the folder
  std::vector<std::string> archives() const;
  // Empty if nowhere. A name with ".." or from the root is nowhere.
  std::optional<found_file> read(const std::string& name) const;

 private:
  std::string folder_;
  std::vector<archive> preferred_, archives_;
};

}  // namespace spantex::sim
