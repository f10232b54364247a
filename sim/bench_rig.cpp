// SPDX-License-Identifier: Apache-2.0
#include "bench_rig.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <nlohmann/json.hpp>

#include "file.hpp"

namespace spantex::sim {
namespace {

using json = nlohmann::json;

[[noreturn]] void refuse(const std::string& path, const std::string& why) { throw input_error(path + ": " + why); }

// A number in a range, if the key is there.
template <class Int>
void number(const std::string& path, const json& from, const char* key, Int least, Int most, Int& value) {
  if (!from.contains(key)) return;
  const json& x = from.at(key);
  if (!x.is_number_integer() || x < least || x > most)
    refuse(path, std::string("'") + key + "' must be a whole number in " + std::to_string(least) + ".." + std::to_string(most));
  value = x.get<Int>();
}

void only_known(const std::string& path, const json& object, const std::set<std::string>& known, const std::string& where) {
  if (!object.is_object()) refuse(path, where + " must be an object");
  for (const auto& [key, value] : object.items())
    if (known.count(key) == 0) refuse(path, "unknown key '" + key + "' in " + where);
}

// Not JSON, or a key twice in one object, of which a parser would silently keep the last.
json parsed(const std::string& path, const bytes& text) {
  std::vector<std::set<std::string>> keys;
  const auto watch = [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second) refuse(path, "key '" + value.get<std::string>() + "' is there twice");
    return true;
  };
  try {
    return json::parse(text.begin(), text.end(), watch);
  } catch (const json::exception& e) {
    refuse(path, std::string("not JSON: ") + e.what());
  }
}

bool is_name(const json& x) {
  if (!x.is_string() || x.get<std::string>().empty()) return false;
  const std::string name = x;
  return std::none_of(name.begin(), name.end(), [](char c) { return uint8_t(c) < ' '; });
}

bool is_number(const std::string& name) { return name.find_first_not_of("0123456789") == std::string::npos; }

}  // namespace

bench_rig load_rig(const std::string& path) {
  const bytes text = read_file(path);
  const json top = parsed(path, text);
  only_known(path, top, {"chip", "lines", "data_bits", "limits", "settle_ns"}, "the rig");
  bench_rig rig;
  if (!top.contains("chip") || !is_name(top["chip"])) refuse(path, "'chip' must be a name, label or path");
  rig.gpio.chip = top["chip"];
  number(path, top, "data_bits", 4, 8, rig.gpio.data_bits);
  if (rig.gpio.data_bits != 4 && rig.gpio.data_bits != 8) refuse(path, "'data_bits' must be 8 or 4");

  std::map<std::string, std::string*> wanted;
  for (int k = 0; k < rig.gpio.data_bits; ++k) wanted["D" + std::to_string(k)] = &rig.gpio.data[size_t(k)];
  gpiod_rig& g = rig.gpio;
  for (const auto& [name, at] : {std::pair<const char*, std::string*>{"clock", &g.clock}, {"direction", &g.direction}, {"command", &g.command},
                                 {"reset", &g.reset}, {"ready", &g.ready}, {"busy", &g.busy}, {"error", &g.error}})
    wanted[name] = at;
  if (!top.contains("lines")) refuse(path, "'lines' is missing");
  std::set<std::string> known, used;
  for (const auto& [name, at] : wanted) known.insert(name);
  only_known(path, top["lines"], known, "'lines'");
  for (const auto& [name, at] : wanted) {
    if (!top["lines"].contains(name)) refuse(path, "line '" + name + "' is missing");
    const json& x = top["lines"][name];
    if (is_name(x) && !is_number(x)) *at = x;
    else if (x.is_number_integer() && x >= 0 && x <= 65535) *at = std::to_string(x.get<int>());
    else refuse(path, "line '" + name + "' must be a name, or an offset without quotes");
    if (!used.insert(*at).second) refuse(path, "line '" + name + "' is on '" + *at + "', which another line uses");
  }

  constexpr uint64_t hour_ns = 3'600'000'000'000;
  number<uint64_t>(path, top, "settle_ns", 1, hour_ns, rig.settle_ns);
  if (!top.contains("limits")) return rig;
  const json& limits = top["limits"];
  only_known(path, limits, {"step_ns", "exchange_ns", "compute_ns", "back_off_ns", "spin_ns", "patience_ns", "attempts", "recoveries"}, "'limits'");
  number<uint64_t>(path, limits, "step_ns", 1, hour_ns, rig.limits.step_ns);
  number<uint64_t>(path, limits, "exchange_ns", 1, hour_ns, rig.limits.exchange_ns);
  number<uint64_t>(path, limits, "compute_ns", 1, hour_ns, rig.limits.compute_ns);
  number<uint64_t>(path, limits, "back_off_ns", 1, hour_ns, rig.limits.back_off_ns);
  number<uint64_t>(path, limits, "spin_ns", 0, hour_ns, rig.limits.spin_ns);
  number<uint64_t>(path, limits, "patience_ns", 0, hour_ns, rig.limits.patience_ns);
  number(path, limits, "attempts", 1, 100, rig.limits.attempts);
  number(path, limits, "recoveries", 0, 100, rig.limits.recoveries);
  return rig;
}

}  // namespace spantex::sim
