// SPDX-License-Identifier: Apache-2.0
#include "sweep_json.hpp"

#include <algorithm>
#include <iterator>

#include <nlohmann/json.hpp>

#include <sim/file.hpp>

namespace spantex::tool {
namespace {

// Lines up to the last character but one: the parser looks one character ahead behind a number.
struct line_count { int line = 1, before_last = 1; };

class counting_iterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  counting_iterator(const char* at, line_count* lines) : at_(at), lines_(lines) {}
  reference operator*() const { return *at_; }
  counting_iterator& operator++() {
    lines_->before_last = lines_->line;
    lines_->line += *at_ == '\n';
    ++at_;
    return *this;
  }
  counting_iterator operator++(int) {
    const counting_iterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const counting_iterator& other) const { return at_ == other.at_; }
  bool operator!=(const counting_iterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  line_count* lines_;
};

class spec_reader final : public nlohmann::json::json_sax_t {
 public:
  spec_reader(const std::string& file, const line_count& lines) : file_(file), lines_(lines) {}

  bool null() override { return add({}); }
  bool boolean(bool x) override { return add({.what = spec_node::kind::truth, .truth = x}); }
  bool number_integer(number_integer_t x) override { return add({.what = spec_node::kind::integer, .integer = x}); }
  bool number_unsigned(number_unsigned_t x) override {
    if (x > uint64_t(INT64_MAX)) return add({.what = spec_node::kind::real, .real = double(x)});
    return add({.what = spec_node::kind::integer, .integer = int64_t(x)});
  }
  bool number_float(number_float_t x, const string_t&) override { return add({.what = spec_node::kind::real, .real = x}); }
  bool string(string_t& x) override { return add({.what = spec_node::kind::text, .text = x}); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(spec_node::kind::object); }
  bool start_array(std::size_t) override { return open(spec_node::kind::list); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    const auto& members = open_.back()->members;
    if (std::any_of(members.begin(), members.end(), [&](const auto& m) { return m.first == name; })) {
      spec_node here;
      here.line = lines_.before_last;
      refuse(file_, here, "'" + name + "' twice");
    }
    key_ = name;
    return true;
  }
  bool parse_error(std::size_t, const std::string& last, const nlohmann::detail::exception&) override {
    spec_node here;
    here.line = lines_.before_last;
    constexpr size_t most = 40;  // of nested brackets it names all
    refuse(file_, here, "not JSON at '" + (last.size() > most ? "..." + last.substr(last.size() - most) : last) + "'");
  }

  spec_node take() { return std::move(root_); }

 private:
  bool add(spec_node node) {
    node.line = lines_.before_last;
    put(std::move(node));
    return true;
  }
  bool open(spec_node::kind what) {
    constexpr size_t most = 64;  // a specification needs five; what is nested is destroyed by recursion
    spec_node node;
    node.what = what;
    node.line = lines_.before_last;
    if (open_.size() == most) refuse(file_, node, "brackets deeper than " + std::to_string(most));
    open_.push_back(put(std::move(node)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }
  // A container's last item stays where it is until the container is closed: nothing is added before that.
  spec_node* put(spec_node node) {
    if (open_.empty()) return &(root_ = std::move(node));
    spec_node& parent = *open_.back();
    if (parent.what == spec_node::kind::list) return &parent.items.emplace_back(std::move(node));
    return &parent.members.emplace_back(std::move(key_), std::move(node)).second;
  }

  const std::string& file_;
  const line_count& lines_;
  spec_node root_;
  std::vector<spec_node*> open_;
  std::string key_;
};

}  // namespace

const spec_node* spec_node::find(const std::string& name) const {
  for (const auto& m : members)
    if (m.first == name) return &m.second;
  return nullptr;
}

spec_node parse_spec(const std::string& file, const std::string& text) {
  line_count lines;
  spec_reader reader(file, lines);
  nlohmann::json::sax_parse(counting_iterator(text.data(), &lines), counting_iterator(text.data() + text.size(), &lines), &reader);
  return reader.take();
}

void refuse(const std::string& file, const spec_node& at, const std::string& reason) {
  std::string line = reason;  // one, whatever it quotes
  std::replace_if(line.begin(), line.end(), [](char c) { return uint8_t(c) < ' '; }, '?');
  throw sim::input_error(file + ":" + std::to_string(at.line) + ": " + line);
}

}  // namespace spantex::tool
