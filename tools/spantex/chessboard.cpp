// SPDX-License-Identifier: Apache-2.0
// spantex chessboard: GCK09's experiment. Filters step and hat, each convolved on the screen in double precision and weighted on the map by the
// engine: four pictures of a chessboard to its horizon, and how far each is from the board. Two judges, since a box is step's own original.
#include <stdio.h>

#include <filesystem>
#include <memory>
#include <utility>

#include <sim/figures.hpp>
#include <sim/quality.hpp>
#include <sim/screen_filter.hpp>
#include "commands.hpp"
#include "options.hpp"
#include "progress.hpp"

namespace spantex::tool {
namespace {

struct chessboard_options {
  std::string out, size = "640x480", profile = "default";
};

sim::ideal_image convolved(const sim::scene& s, rgba8 background, sim::screen_kernel kernel, int samples) {
  const auto board = [](double u, double v) { return sim::chessboard_at(u, v, sim::chessboard_texels); };
  return sim::filter_on_screen(s.items[0].plane_matrix, s.size, board, kernel, sim::kernel_plane::screen, samples, background, sim::hardware_threads());
}

void run(const chessboard_options& o) {
  sim::draw_options how;
  how.profile = value_of(sim::profile_names, o.profile, "profile");
  sim::scene_request request;
  request.size = parse_size(o.size);
  make_folder(o.out);
  chessboard_experiment(sim::make_named_scene("chessboard", request), how, o.out);
}

}  // namespace

void chessboard_experiment(const sim::scene& s, sim::draw_options how, const std::string& folder) {
  constexpr int judge_samples = 48, kernel_samples = 32;
  struct row { std::string what; double box_db, gauss_db; };
  std::vector<row> rows;
  {
    progress_bar bar("chessboard", 6);
    const sim::ideal_image box = convolved(s, how.background, sim::screen_kernel::step, judge_samples);
    bar.advance(1);
    const sim::ideal_image gauss = convolved(s, how.background, sim::screen_kernel::gauss, kernel_samples);
    bar.advance(1);
    for (const auto& [kernel, kind] : {std::pair{sim::screen_kernel::step, filter::step}, {sim::screen_kernel::hat, filter::hat}}) {
      const std::string name(sim::name_of(sim::filter_names, kind));
      how.kind = kind;
      for (const bool on_map : {false, true}) {
        const sim::image picture = on_map ? sim::draw(s, how).picture : sim::rounded(convolved(s, how.background, kernel, kernel_samples));
        rows.push_back({name + (on_map ? " on the map" : " on the screen"), sim::psnr_db(picture, box), sim::psnr_db(picture, gauss)});
        sim::output_file(folder + "/chessboard-" + name + (on_map ? "-map" : "-screen") + ".png").write(sim::encode_png(picture));
        bar.advance(1);
      }
    }
  }
  printf("%-20s  %8s  %8s\n", "chessboard, dB", "box", "gauss");
  for (const row& r : rows) printf("%-20s  %8.2f  %8.2f\n", r.what.c_str(), r.box_db, r.gauss_db);
}

void add_chessboard_command(CLI::App& app) {
  const auto o = std::make_shared<chessboard_options>();
  CLI::App& sub = *app.add_subcommand("chessboard", "GCK09's experiment: filters step and hat on the screen and on the map, four pictures and their PSNR");
  sub.add_option("--out", o->out, "folder for the pictures; made if missing")->required();
  sub.add_option("--size", o->size, "picture size, WxH")->capture_default_str();
  sub.add_option("--profile", o->profile, list_of(sim::profile_names))->capture_default_str();
  sub.footer("Judges: a box of 48x48 samples of the board a pixel, and a Gaussian of standard deviation 1/2 pixel.");
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
