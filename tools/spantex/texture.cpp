// SPDX-License-Identifier: Apache-2.0
// spantex texture: compiles a picture into a texture pack, a file or a C array.

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include <sim/distance_field.hpp>
#include <sim/pack.hpp>
#include "commands.hpp"
#include "options.hpp"
#include "progress.hpp"

namespace spantex::tool {
namespace {

constexpr std::array<sim::named<pack_format::byte_order>, 2> order_names{
    {{"little", pack_format::little_endian}, {"big", pack_format::big_endian}}};

constexpr std::array<sim::named<sim::inside_by>, 4> inside_names{
    {{"either", sim::inside_by::either}, {"alpha", sim::inside_by::alpha}, {"light", sim::inside_by::light}, {"dark", sim::inside_by::dark}}};

struct texture_options {
  std::string picture, out, c_array, format = "rgba8888", prefilter = "box", wrap = "repeat", order = "little";
  std::optional<int> alpha_test, levels, field;
  int reduction = 1;
  std::string inside = "either", ink = "ffffff", outline = "0";
  bool inverse = false, alpha_weighted = false, srgb = false;
  int threads = std::min(sim::hardware_threads(), most_threads);
};

// One mode for both axes, or U,V.
void set_wraps(const std::string& text, sim::compile_options& o) {
  const size_t comma = text.find(',');
  o.wrap_u = value_of(sim::wrap_names, text.substr(0, comma), "wrap mode");
  o.wrap_v = comma == std::string::npos ? o.wrap_u : value_of(sim::wrap_names, text.substr(comma + 1), "wrap mode");
}

sim::compile_options resolve(const texture_options& o) {
  sim::compile_options c;
  c.format = value_of(sim::format_names, o.format, "format");
  c.levels = value_of(sim::prefilter_names, o.prefilter, "prefilter");
  set_wraps(o.wrap, c);
  c.order = value_of(order_names, o.order, "byte order");
  c.alpha = o.alpha_weighted ? sim::alpha_weighting::weighted : sim::alpha_weighting::independent;
  c.inverse = o.inverse;
  c.srgb = o.srgb;
  check_range("--threads", o.threads, 1, most_threads);
  c.threads = o.threads;
  if (o.field && !has_alpha(c.format)) throw sim::input_error("--field: format " + o.format + " has no alpha");
  if (!o.alpha_test) return c;
  check_range("--alpha-test", *o.alpha_test, 1, 255);
  if (!has_alpha(c.format)) throw sim::input_error("--alpha-test: format " + o.format + " has no alpha");
  c.alpha_threshold = uint8_t(*o.alpha_test);
  return c;
}

void set_level_count(const texture_options& o, const sim::image& picture, sim::compile_options& c) {
  if (!o.levels) return;
  const int most = sim::all_levels(picture.width_px, picture.height_px);
  if (*o.levels < 1 || *o.levels > most)
    throw sim::input_error("--levels: outside 1.." + std::to_string(most) + ", the levels of " + o.picture);
  c.level_count = *o.levels;
}

bool is_source(const std::string& path) { return path.ends_with(".c") || path.ends_with(".h"); }

// A source of another language or spelling, where a pack in bytes would be a surprise.
bool is_other_source(const std::string& path) {
  const std::string suffix = sim::lower(std::filesystem::path(path).extension().string());
  const auto others = {".c", ".h", ".cc", ".hh", ".cpp", ".hpp", ".cxx", ".hxx", ".c++", ".h++", ".inc", ".inl"};
  return !is_source(path) && std::find(others.begin(), others.end(), suffix) != others.end();
}

void write(const sim::output_file& file, const sim::bytes& pack, sim::output_files& files) {
  if (!is_source(file.path())) return files.write(file, pack);
  const auto linkage = file.path().ends_with(".c") ? sim::c_linkage::external : sim::c_linkage::internal;
  files.write(file, sim::c_array(pack, sim::identifier_of(file.path()), linkage));
}

// A contour map of the picture's outline.
sim::bytes compiled_field(const texture_options& o, const sim::image& picture, sim::compile_options c) {
  const rgba8 ink = parse_colour(o.ink, "--ink");
  const contour_style style = sim::field_style(*o.field, parse_parts(o.outline, "--outline", 0, 255 / 16.0, 16));
  const std::vector<sim::image> levels = sim::make_field_levels(picture, o.reduction, *o.field, {ink.r, ink.g, ink.b, 0},
                                                                  value_of(inside_names, o.inside, "inside"));
  int parts = 0;
  for (const sim::image& level : levels) parts += blocks_across(level.height_px);
  progress_bar bar("compiling", parts);
  c.parts_done = bar.callback();
  return sim::compile_contour_pack(levels, style, c);
}

sim::bytes compiled(const sim::image& picture, sim::compile_options c) {
  progress_bar bar("compiling", sim::compile_parts(picture, c));
  c.parts_done = bar.callback();
  return sim::compile_pack(picture, c);
}

void run(const texture_options& o) {
  sim::compile_options c = resolve(o);
  if (o.out.empty() && o.c_array.empty()) throw sim::input_error("texture: nothing to write: give --out, --c-array or both");
  if (is_other_source(o.out)) throw sim::input_error("--out: '" + o.out + "': a C array's name ends in .c or .h, a pack's in .stx");
  if (!o.c_array.empty() && !is_source(o.c_array)) throw sim::input_error("--c-array: '" + o.c_array + "' does not end in .h or .c");
  check_outputs({{"--out", o.out}, {"--c-array", o.c_array}}, {o.picture});
  const sim::output_file out = wanted_output(o.out), source = wanted_output(o.c_array);
  const sim::image picture = sim::load_image(o.picture);
  set_level_count(o, picture, c);
  const sim::bytes pack = o.field ? compiled_field(o, picture, c) : compiled(picture, c);
  sim::output_files files;
  if (out.wanted()) write(out, pack, files);
  if (source.wanted()) write(source, pack, files);
  files.commit();
}

}  // namespace

void add_texture_command(CLI::App& app) {
  const auto o = std::make_shared<texture_options>();
  CLI::App& sub = *app.add_subcommand("texture", "compile a picture into a texture pack with its levels");
  sub.add_option("PICTURE", o->picture, "PNG or any other picture that stb_image reads, at most 4096x4096")->required();
  sub.add_option("--out", o->out, "the pack (.stx); a C and C++ array if the name ends in .c (external names) or .h (static)");
  sub.add_option("--c-array", o->c_array, "the pack as a C array as well: .h or .c; its name is the file's");
  sub.add_option("--format", o->format, list_of(sim::format_names))->capture_default_str();
  CLI::Option* const prefilter = sub.add_option("--prefilter", o->prefilter, list_of(sim::prefilter_names))->capture_default_str();
  sub.add_option("--wrap", o->wrap, list_of(sim::wrap_names) + "; or two, of u and of v: clamp,repeat")->capture_default_str();
  CLI::Option* const inverse = sub.add_flag("--inverse", o->inverse, "sharpen the levels by a truncated inverse of the prefilter's blur");
  CLI::Option* const weighted = sub.add_flag("--alpha-weighted", o->alpha_weighted, "colours count by their alpha: those of transparent texels do not bleed");
  CLI::Option* const alpha_test = sub.add_option("--alpha-test", o->alpha_test, "1..255: keep the share of texels with at least this alpha on every level");
  CLI::Option* const levels = sub.add_option("--levels", o->levels, "so many levels from the largest; all if not given");
  sub.add_option("--byte-order", o->order, "of 16-bit texels, the target's: " + list_of(order_names))->capture_default_str();
  CLI::Option* const srgb = sub.add_flag("--srgb", o->srgb, "colours are sRGB codes: levels are averaged in linear light, and the pack says so");
  CLI::Option* const field =
      sub.add_option("--field", o->field, "1..64: a map for filter contour; alpha becomes 128 and so many units a texel of the signed distance to the outline of the "
                                          "picture's inside");
  for (CLI::Option* const other : {prefilter, inverse, weighted, alpha_test, levels, srgb}) field->excludes(other);
  sub.add_option("--inside", o->inside, "of a field: alpha or luma (light) of 128 and more, luma below (dark); either: light of an opaque picture, else alpha")
      ->needs(field)->capture_default_str();
  sub.add_option("--reduction", o->reduction, "of a field: pixels of the picture along a texel; its sides are multiples")->needs(field)->capture_default_str();
  sub.add_option("--ink", o->ink, "of a field: RRGGBB of fill and outline")->needs(field)->capture_default_str();
  sub.add_option("--outline", o->outline, "of a field: width of the line along the contour in pixels, to 1/16; 0 fills the inside")->needs(field)->capture_default_str();
  sub.add_option("--threads", o->threads, "threads, 1.." + std::to_string(most_threads) + "; the bytes do not depend on it")->capture_default_str();
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
