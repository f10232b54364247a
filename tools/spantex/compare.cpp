// SPDX-License-Identifier: Apache-2.0
// spantex compare: how far two pictures are apart.
#include <stdio.h>

#include <memory>

#include <sim/quality.hpp>
#include "commands.hpp"
#include "options.hpp"

namespace spantex::tool {
namespace {

struct compare_options { std::string a, b, diff; };

std::string size_text(const sim::image& p) { return std::to_string(p.width_px) + "x" + std::to_string(p.height_px); }

void run(const compare_options& o) {
  const sim::output_file diff = o.diff.empty() ? sim::output_file() : sim::output_file(o.diff);
  const sim::image a = sim::load_image(o.a), b = sim::load_image(o.b);
  if (a.width_px != b.width_px || a.height_px != b.height_px)
    throw sim::input_error(o.b + ": picture is " + size_text(b) + ", but " + o.a + " is " + size_text(a));
  const sim::difference d = sim::compare(a, b);
  if (diff.wanted()) diff.write(sim::encode_png(sim::difference_picture(a, b)));
  printf("PSNR              %.2f dB\n", sim::psnr_db(a, b));
  printf("SSIM              %.6f\n", sim::ssim(a, b));
  printf("worst error       %d\n", d.worst);
  printf("differing pixels  %llu of %zu\n", static_cast<unsigned long long>(d.differing_px), a.pixels.size());
}

}  // namespace

void add_compare_command(CLI::App& app) {
  const auto o = std::make_shared<compare_options>();
  CLI::App& sub = *app.add_subcommand("compare", "PSNR, SSIM, worst error and differing pixels of two pictures");
  sub.add_option("A", o->a, "a picture")->required();
  sub.add_option("B", o->b, "another of the same size")->required();
  sub.add_option("--diff", o->diff, "absolute differences, PNG");
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
