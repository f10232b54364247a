// SPDX-License-Identifier: Apache-2.0
// spantex plane: one textured plane from a matrix.
#include <stdio.h>

#include <memory>
#include <optional>
#include <utility>

#include "commands.hpp"
#include "options.hpp"

namespace spantex::tool {
namespace {

struct plane_options {
  drawing_options drawing;
  std::string texture, size, matrix, out, stats;
  bool psnr = false;
};

void run(const plane_options& o) {
  sim::draw_options drawing = o.drawing.resolve();
  drawing.counted = !o.stats.empty();
  if (o.psnr) refuse_reference(drawing, "--psnr");
  const sim::screen_size size = parse_size(o.size);
  const sim::matrix m = parse_matrix(o.matrix, size);
  check_outputs({{"--out", o.out}, {"--stats", o.stats}}, {o.texture});
  const sim::output_file out(o.out);
  const sim::output_file stats = wanted_output(o.stats);
  sim::map_list maps;
  maps.push_back(load_map(o.texture, o.drawing));
  sim::scene s{"plane", size, std::make_shared<const sim::map_list>(std::move(maps)), {}};
  sim::add_plane(s, m, 0);

  const sim::draw_result r = draw_with_bar(s, drawing);
  std::optional<double> psnr_db;
  if (o.psnr) psnr_db = reference_psnr_db(s, r.picture, drawing.background);
  sim::output_files files;
  files.write(out, sim::encode_png(r.picture));
  if (stats.wanted()) files.write(stats, stats_json(r, drawing, psnr_db));
  files.commit();
  if (psnr_db) printf("PSNR against the reference: %.2f dB\n", *psnr_db);
}

}  // namespace

void add_plane_command(CLI::App& app) {
  const auto o = std::make_shared<plane_options>();
  CLI::App& sub = *app.add_subcommand("plane", "draw one textured plane from a 3x3 matrix");
  sub.add_option("--texture", o->texture, "the map: PNG or any other picture that stb_image reads, at most 4096x4096, or a texture pack (.stx)")->required();
  sub.add_option("--size", o->size, "picture size, WxH")->required();
  sub.add_option("--matrix", o->matrix,
                 "A,B,C,D,E,F,G,H,I: u = (A x + B y + C)/(G x + H y + I), v = (D x + E y + F)/(...), in texels, for pixel centres "
                 "(i + 1/2, j + 1/2); or facing, tilted, grazing")->required();
  sub.add_option("--out", o->out, "the picture, PNG")->required();
  o->drawing.add_to(sub, true);
  sub.add_option("--stats", o->stats, stats_help("counts and times as JSON"));
  sub.add_flag("--psnr", o->psnr, "compare with the 16x16 supersampled double-precision reference");
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
