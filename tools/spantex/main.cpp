// SPDX-License-Identifier: Apache-2.0
// The command. Exit code 0 on success, 1 where a check found what it looks for, 2 on bad usage or bad input, with one line on stderr that
// says what and why.
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include <algorithm>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <sim/file.hpp>
#include <spantex/version.h>
#include "commands.hpp"
#include "options.hpp"

namespace {

constexpr int exit_bad_input = 2;

int refuse(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  fprintf(stderr, "spantex: %s\n", message.c_str());
  return exit_bad_input;
}

// Why a word is not what must stand there, a subcommand of this one; nothing where it is one, or asks for help.
std::string trouble_with_subcommand(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) names.push_back(sub->get_name());
  if (names.empty() || app.get_option_no_throw(word) != nullptr || std::find(names.begin(), names.end(), word) != names.end()) return {};
  const std::string known = " (known: " + spantex::tool::joined(names) + ")";
  if (word.empty()) return "a subcommand is needed" + known;
  return (word[0] == '-' ? "unknown option '" + word + "' before a subcommand" : "unknown subcommand '" + word + "'") + known;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Fixed-point texture mapping in spans of 8x8 pixels", "spantex");
  app.require_subcommand(1);
  app.set_version_flag("--version", "spantex " SPANTEX_VERSION);
  spantex::tool::add_plane_command(app);
  spantex::tool::add_render_command(app);
  spantex::tool::add_texture_command(app);
  spantex::tool::add_prefilters_command(app);
  spantex::tool::add_compare_command(app);
  spantex::tool::add_trace_command(app);
  spantex::tool::add_stress_command(app);
  spantex::tool::add_chessboard_command(app);
  spantex::tool::add_demo_command(app);
  spantex::tool::add_bench_command(app);
  spantex::tool::add_bench_rig_command(app);
  spantex::tool::add_sweep_command(app);

  const auto word = [&](int k) { return std::string(k < argc ? argv[k] : ""); };
  if (const std::string trouble = trouble_with_subcommand(app, word(1)); !trouble.empty()) return refuse(trouble);
  if (word(1)[0] != '-')
    if (const std::string trouble = trouble_with_subcommand(*app.get_subcommand(word(1)), word(2)); !trouble.empty()) return refuse(word(1) + ": " + trouble);
  try {
    app.parse(argc, argv);
    if (fflush(stdout) != 0 || ferror(stdout) != 0) return refuse(std::string("standard output: cannot write: ") + strerror(errno));
    return 0;
  } catch (const CLI::RuntimeError& e) {  // a subcommand's own verdict, already told
    return e.get_exit_code();
  } catch (const CLI::ParseError& e) {
    return e.get_exit_code() == 0 ? app.exit(e) : refuse(e.what());
  } catch (const std::bad_alloc&) {
    return refuse("not enough memory for the picture, maps, model or trace asked for");
  } catch (const std::exception& e) {
    return refuse(e.what());
  }
}
