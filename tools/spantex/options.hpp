// SPDX-License-Identifier: Apache-2.0
// What the command's subcommands share: options, their parsing, and what they stand for. Bad values throw sim::input_error with one
// line that names the option or file and the reason.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <sim/draw_host.hpp>
#include <sim/figures.hpp>
#include <sim/file.hpp>
#include <sim/level.hpp>
#include <sim/world.hpp>

namespace spantex::tool {

// "a, b, c"
template <class T, size_t N>
std::string list_of(const std::array<sim::named<T>, N>& names) {
  std::string text;
  for (const auto& n : names) text += (text.empty() ? "" : ", ") + std::string(n.name);
  return text;
}

template <class T, size_t N>
T value_of(const std::array<sim::named<T>, N>& names, const std::string& name, const char* what) {
  for (const auto& n : names)
    if (n.name == name) return n.value;
  throw sim::input_error(std::string("unknown ") + what + " '" + name + "' (known: " + list_of(names) + ")");
}

// By name, one after the other, or every one by "all".
template <class T, size_t N>
std::vector<T> values_of(const std::array<sim::named<T>, N>& names, const std::vector<std::string>& wanted, const char* what) {
  std::vector<T> values;
  if (wanted == std::vector<std::string>{"all"})
    for (const auto& n : names) values.push_back(n.value);
  else
    for (const std::string& w : wanted) values.push_back(value_of(names, w, what));
  return values;
}

// Refuses a name that is there twice.
void refuse_repeats(const char* option, std::vector<std::string> names);

// Filters of pictures that are judged against the reference. Refuses contour: the reference has no coverage.
filter judged_filter(const std::string& name);
std::vector<filter> judged_filters();

std::string joined(const std::vector<std::string>& words);
std::vector<std::string> split(const std::string& text, char separator);

inline constexpr int most_threads = 256, most_repeats = 1000000;
// Refuses a number outside low..high.
void check_range(const char* option, int value, int low, int high);

double parse_number(const std::string& text, const std::string& what);
std::vector<double> parse_numbers(const std::string& text, size_t count, const std::string& what);
sim::screen_size parse_size(const std::string& text);
rgba8 parse_colour(const std::string& text, const char* option);
// A number within limits, in 1/parts, to nearest.
int parse_parts(const std::string& text, const char* option, double low, double high, int parts);
shading parse_alpha(const std::string& text);
// What is left of all skips without those named, by commas; "all" names every one. Beside the draw layer's: levels of a map that the filter does not ask for
// are not made, spans that show what they showed in the frame before are not drawn, and faces that others hide are not set up.
struct skip_choice {
  skip_set drawing = usual_skips;
  bool levels = true, unchanged = true, occluded = true;
};
skip_choice parse_no_skip(const std::string& text);
skip_set parse_skip(const std::string& text);  // more than the usual ones: "" or "other-half"
// What an option has no reference for.
void refuse_reference(const sim::draw_options& o, const std::string& option);

// Nine numbers or the name of one of the three planes (for 640x480). Refused, with the reason: not nine numbers, not finite, singular, or
// coordinates beyond what the engine takes (2^15 texels) at every pixel in front of the viewer.
sim::matrix parse_matrix(const std::string& text, sim::screen_size size);

// What an option names that may be left out: no file, then.
sim::output_file wanted_output(const std::string& path);

// Makes a folder for outputs where it is missing.
void make_folder(const std::string& path);

// An option and the file that it names; an empty path is none.
struct named_output { std::string option, path; };
// Refuses two outputs that would be one file, and one that would replace a file that is read.
void check_outputs(const std::vector<named_output>& outputs, const std::vector<std::string>& inputs);

// Behind what an option says: what counts without it.
std::string unless_given(const std::string& of_profile_default);

// Samples 1..16, spacing 0..16, slack 0..15, bias -16..0; what filter they belong to.
void check_changes(const sim::profile_changes& c, filter kind);

// How pictures are drawn.
struct drawing_options {
  std::string space = "screen", filter = "trilinear", profile = "default", engine = "direct", wrap = "repeat", prefilter = "box", format = "rgba8888", background = "000000";
  std::string kernel = "fastest";
  int threads = 1, repeat = 1;
  bool single_half = false, srgb = false;
  std::string alpha = "opaque", culled = "none", no_skip, skip;
  std::optional<std::string> level;
  std::optional<int> samples, spacing, slack, bias;
  std::optional<std::string> outline, threshold, field_scale;

  void add_to(CLI::App& app, bool with_engine);
  sim::draw_options resolve() const;
  void parse_contour(sim::draw_options& o) const;
  spantex::wrap wrap_mode() const { return value_of(sim::wrap_names, wrap, "wrap mode"); }
  colour_space colours() const { return srgb ? colour_space::srgb : colour_space::coded; }
  texel_format texels() const { return value_of(sim::format_names, format, "format"); }
  int most_levels() const { return parse_no_skip(no_skip).levels && !uses_levels(value_of(sim::filter_names, filter, "filter")) ? 1 : 0; }  // 0: all
  sim::level_making making() const { return parse_no_skip(no_skip).levels ? sim::level_making::on_demand : sim::level_making::at_once; }
  sim::prefilter level_filter() const { return value_of(sim::prefilter_names, prefilter, "prefilter"); }

 private:
  CLI::Option *wrap_given_ = nullptr, *prefilter_given_ = nullptr, *format_given_ = nullptr;

 public:
  bool wrap_given() const { return wrap_given_ != nullptr && wrap_given_->count() > 0; }
  bool format_given() const { return format_given_ != nullptr && format_given_->count() > 0; }
  bool prefilter_given() const { return prefilter_given_ != nullptr && prefilter_given_->count() > 0; }
};

// The map in a file: a picture, whose levels are made here, or a texture pack, which has its own and refuses --wrap, --prefilter and --format.
sim::texture_map load_map(const std::string& path, const drawing_options& d);

// What is drawn: a model, a scene by name, or (matrix given) a plane.
struct subject_options {
  std::string subject, size = "640x480", texture, matrix, camera, eye, target, map, order;
  double fov_degrees = 40;

  void add_to(CLI::App& app, bool with_matrix);
  // Refuses what the subject would ignore: a camera for a plane or a scene with its own, a texture for what has its own.
  void check_consistent() const;
  // Loads once; then one scene per frame, the camera turned by `turn_degrees`.
  class loaded {
   public:
    loaded(const subject_options& o, const drawing_options& d);
    enum class faces : uint8_t { that_may_show, all };  // of a model or level that is drawn nearest first, opaque
    sim::scene at(double turn_degrees, sim::thread_team* team = nullptr, faces which = faces::that_may_show) const;
    // False where the turn changes nothing: a plane from coefficients, or a camera fixed by --eye and --target.
    bool turns() const { return !matrix_ && !sim::named_plane(name_) && !camera_.eye; }
    // A level without a camera of its own: frames are a walk, not a turntable. Seen from its first place where one frame is asked for.
    bool walks() const { return walks_; }
    bool is_model() const { return world_ != nullptr; }
    // A level's textures that have no picture and are grey; null for what is no level.
    const std::vector<std::string>* textures_missing() const { return level_ ? &level_->missing : nullptr; }
    const std::vector<std::string>& files() const { return files_; }  // that it was read from
    sim::scene seen_from(const sim::viewpoint& v, sim::thread_team* team = nullptr, faces which = faces::that_may_show) const { return set_up(camera_from(v), team, which); }
    bool leaves_hidden() const { return leaves_hidden_; }
    // Of a model or level: the camera of either, and what it sees.
    const sim::world& world() const { return *world_; }
    sim::screen_size size() const { return request_.size; }
    sim::camera_options camera_at(double turn_degrees) const;
    sim::camera_options camera_from(const sim::viewpoint& v) const;
    sim::scene set_up(const sim::camera_options& from, sim::thread_team* team = nullptr, faces which = faces::that_may_show) const;
    std::vector<sim::viewpoint> walk(int frames) const { return sim::tour(*level_, frames); }

   private:
    void find_distance();

    sim::scene_request request_;
    std::string name_;
    std::optional<sim::matrix> matrix_;
    std::vector<std::string> files_;
    std::shared_ptr<const sim::level> level_;
    std::shared_ptr<const sim::world> world_;  // a model's or the level's
    sim::camera_options camera_;
    bool walks_ = false, nearest_first_ = false, leaves_hidden_ = false;
  };

 private:
  CLI::Option* fov_given_ = nullptr;
};

}  // namespace spantex::tool
