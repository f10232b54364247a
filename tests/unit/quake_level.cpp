// SPDX-License-Identifier: Apache-2.0
// Levels of Quake III: a small map made here, whole and damaged; a walk through it. What depth complexity costs in texture words and filtered pixels, drawn
// nearest first with floors, against every surface's own visible pixels: of a stack, and of frames of real levels where their package is installed.
#include <unistd.h>
#include <zip.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include <sim/draw_host.hpp>
#include <sim/level.hpp>
#include <tests/support.hpp>  // last: cmocka's macro fail is a name of the standard library's

using namespace spantex;
using namespace spantex::sim;

namespace {

namespace fs = std::filesystem;

// --- cost of what is hidden ----------------------------------------------------------------------------

struct work { uint64_t words, pixels; };

work drawn(const scene& s, std::vector<uint32_t>& depths, bool depths_first = false) {
  using standard = fixed_profile<profiles::standard>;
  const size_t columns = size_t(s.size.width_px + 7) / 8, rows = size_t(s.size.height_px + 7) / 8;
  std::vector<uint32_t> floors(columns * rows);
  image picture(s.size.width_px, s.size.height_px, {});
  direct_engine<standard> engine{standard{}};
  renderer<direct_engine<standard>, standard> r(engine, standard{}, {picture.pixels.data(), s.size.width_px, s.size.height_px, s.size.width_px});
  if (depths_first) {
    for (const drawable& d : s.items) lay_depths(d.shape, {depths.data(), floors.data()}, s.size.width_px, s.size.height_px);
    reopen_depths(depths.data(), int64_t(depths.size()));
    reopen_depths(floors.data(), int64_t(floors.size()));
  }
  for (const drawable& d : s.items) SPANTEX_ASSERT_OK(r.draw(d.shape, s.texture(d), filter::trilinear, {depths.data(), floors.data()}));
  SPANTEX_ASSERT_OK(r.finish());
  return {r.counters().words_loaded, r.counters().pixels};
}

struct cost { work all, visible; overdraw over; work depths_first; };

// Visible: depths are there beforehand, one less than the nearest surface's, so that each surface draws just what is seen of it.
// With depths first every scene, and so every frame, costs that.
cost cost_of(const scene& s) {
  std::vector<uint32_t> depths(size_t(s.size.width_px) * size_t(s.size.height_px));
  cost c{drawn(s, depths), {}, overdraw_of(s), {}};
  std::vector<uint32_t> none(depths.size());
  c.depths_first = drawn(s, none, true);
  assert_true(none == depths);
  for (uint32_t& z : depths) z -= z != 0;
  c.visible = drawn(s, depths);
  assert_int_equal(c.visible.pixels, c.over.pixels_shown);
  assert_int_equal(c.depths_first.pixels, c.visible.pixels);
  assert_int_equal(c.depths_first.words, c.visible.words);
  return c;
}

bool costs_little_more(const char* name, const cost& c) {
  printf("%s: overdraw %.2f, words %.3f, filtered pixels %.3f of what the visible pixels cost\n", name, double(c.over.pixels_tested) / double(c.over.pixels_shown),
         double(c.all.words) / double(c.visible.words), double(c.all.pixels) / double(c.visible.pixels));
  return 10 * c.all.words <= 13 * c.visible.words && 10 * c.all.pixels <= 13 * c.visible.pixels;
}

constexpr screen_size screen{320, 240};

std::shared_ptr<const map_list> one_map() {
  image picture(256, 256, {});
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x) picture.at(x, y) = {uint8_t(x), uint8_t(y), uint8_t(x ^ y), 255};
  map_list maps;
  maps.emplace_back(std::move(picture), prefilter::box, wrap::repeat, wrap::repeat);
  return std::make_shared<const map_list>(std::move(maps));
}

// Layers of squares, each square tilted at random within its layer's depth: nothing is parallel, and neighbours do not meet.
scene stack(int layers) {
  constexpr int across = 10, down = 8;
  constexpr double vertical = 0.9, side = 0.16;
  scene s{"stack", screen, one_map(), {}};
  const lens view = make_lens(screen, vertical, 0.25);
  random_source random(7);
  for (int layer = 0; layer < layers; ++layer)
    for (int j = -down / 2; j < down / 2; ++j)
      for (int i = -across / 2; i < across / 2; ++i) {
        const double depth = 1 + 0.5 * layer, size = side * depth * 1.02, x = i * side * depth, y = j * side * depth;
        const double tilt = double(random.between(-20, 20)) / 100, lean = double(random.between(-20, 20)) / 100;
        const auto corner = [&](double a, double b) {
          const double z = depth + 0.2 * (tilt * (a - 0.5) + lean * (b - 0.5)) * depth;
          return vertex{to_fixed(x + a * size), to_fixed(y + b * size), to_fixed(z), to_fixed(64 * a * depth), to_fixed(64 * b * depth)};
        };
        const vertex v[4] = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
        add_polygon(s, view, v, 4, 0);
      }
  return s;
}

SPANTEX_CASE(eight_layers_cost_at_most_three_tenths_more_than_one) {
  static scene deep, flat;
  deep = stack(8), flat = stack(1);
  nearest_first(deep), nearest_first(flat);
  const cost eight = cost_of(deep), one = cost_of(flat);
  assert_true(eight.over.pixels_tested > 7 * eight.over.pixels_shown);
  assert_true(costs_little_more("stack of 8 against its visible pixels", eight));
  assert_true(10 * eight.all.words <= 13 * one.all.words);
  assert_true(10 * eight.all.pixels <= 13 * one.all.pixels);
}

SPANTEX_CASE(frames_of_levels_cost_at_most_three_tenths_more_than_their_visible_pixels) {
  const char* const archive = "/usr/share/games/openarena/baseoa/pak1-maps.pk3";
  if (access(archive, R_OK) != 0) skip();  // tools/setup levels
  for (const char* const name : {"oa_dm3", "oa_rpg3dm2", "czest1dm"}) {
    static level l;
    static scene s;
    l = load_level(archive, name, {});
    cost sum{};
    for (const viewpoint& v : tour(l, 6)) {
      camera_options c;
      c.eye = v.eye, c.target = v.target, c.vertical_degrees = 60;
      s = look_at(l.drawn, c, screen);
      nearest_first(s);
      const cost frame = cost_of(s);
      sum.all.words += frame.all.words, sum.all.pixels += frame.all.pixels;
      sum.visible.words += frame.visible.words, sum.visible.pixels += frame.visible.pixels;
      sum.over.pixels_tested += frame.over.pixels_tested, sum.over.pixels_shown += frame.over.pixels_shown;
    }
    assert_true(costs_little_more(name, sum));
  }
}

SPANTEX_CASE(hidden_faces_of_levels_show_nothing) {
  const char* const archive = "/usr/share/games/openarena/baseoa/pak1-maps.pk3";
  if (access(archive, R_OK) != 0) skip();  // tools/setup levels
  for (const char* const name : {"oa_dm3", "oa_rpg3dm2", "czest1dm"}) {
    static level l;
    static scene all, some;
    static draw_result whole, part;
    l = load_level(archive, name, {});
    size_t set_up = 0, hidden = 0;
    for (const viewpoint& v : tour(l, 12)) {
      camera_options c;
      c.eye = v.eye, c.target = v.target, c.vertical_degrees = 60;
      all = look_at(l.drawn, c, screen, {true, nullptr, false});
      some = look_at(l.drawn, c, screen, {true, nullptr, true});
      whole = draw(all, {});
      part = draw(some, {});
      assert_true(whole.picture.pixels == part.picture.pixels);
      set_up += some.items.size();
      hidden += size_t(some.polygons_hidden);
    }
    print_message("%s: %zu faces hidden, %zu set up\n", name, hidden, set_up);
    assert_true(hidden > 2 * set_up);
  }
}

// --- reading -------------------------------------------------------------------------------------------

bytes little_endian(std::initializer_list<uint32_t> values) {
  bytes b;
  for (const uint32_t v : values)
    for (int k = 0; k < 4; ++k) b.push_back(uint8_t(v >> (8 * k)));
  return b;
}
uint32_t bits(float x) { return std::bit_cast<uint32_t>(x); }
void append(bytes& to, const bytes& more) { to.insert(to.end(), more.begin(), more.end()); }

bytes bsp_vertex(float x, float y, float z, float u, float v) {
  return little_endian({bits(x), bits(y), bits(z), bits(u), bits(v), 0, 0, 0, 0, 0, 0});
}
bytes bsp_face(uint32_t texture, uint32_t type, uint32_t vertex, uint32_t vertices, uint32_t index, uint32_t indices, uint32_t width, uint32_t height) {
  bytes f = little_endian({texture, 0, type, vertex, vertices, index, indices});
  f.resize(96);
  append(f, little_endian({width, height}));
  return f;
}
bytes bsp_texture(const std::string& name, uint32_t flags) {
  bytes t(name.begin(), name.end());
  t.resize(64);
  append(t, little_endian({flags, 0}));
  return t;
}

bytes bsp_file(const bytes (&lumps)[17]) {
  bytes file{'I', 'B', 'S', 'P'}, body;
  append(file, little_endian({46}));
  for (const bytes& l : lumps) {
    append(file, little_endian({uint32_t(8 + 8 * 17 + body.size()), uint32_t(l.size())}));
    append(body, l);
  }
  append(file, body);
  return file;
}

// A square as a polygon of two triangles, a flat patch of nine points, and the square once more as sky.
bytes small_map() {
  bytes lumps[17];
  const std::string entities = "{ \"classname\" \"worldspawn\" }\n{ \"origin\" \"1 2 3\" \"classname\" \"info_player_start\" }\n"
                               "{ \"classname\" \"weapon_x\" \"origin\" \"9 2 3\" }\n{ \"classname\" \"light\" \"origin\" \"0 0 0\" }";
  lumps[0] = bytes(entities.begin(), entities.end());
  append(lumps[1], bsp_texture("textures/a", 0));
  append(lumps[1], bsp_texture("textures/a", 4));
  for (int k = 0; k < 4; ++k) append(lumps[10], bsp_vertex(float(k % 2 * 64), 32, float(k / 2 * 64), float(k % 2) + 5, float(k / 2) - 3));
  for (int k = 0; k < 9; ++k) append(lumps[10], bsp_vertex(float(k % 3 * 32), float(k / 3 * 32 + 64), 0, float(k % 3) / 2, float(k / 3) / 2));
  lumps[11] = little_endian({0, 1, 2, 2, 1, 3});
  append(lumps[13], bsp_face(0, 1, 0, 4, 0, 6, 0, 0));
  append(lumps[13], bsp_face(0, 2, 4, 9, 0, 0, 3, 3));
  append(lumps[13], bsp_face(1, 1, 0, 4, 0, 6, 0, 0));
  return bsp_file(lumps);
}

// Faces that are all made of the same triangles, or of the same patch.
bytes map_of_equal_faces(uint32_t type, int count) {
  constexpr uint32_t side = 65, triangles = 1024;
  bytes lumps[17];
  lumps[1] = bsp_texture("textures/a", 0);
  for (uint32_t k = 0; k < side * side; ++k) append(lumps[10], bsp_vertex(float(k % side), float(k / side), 0, 0, 0));
  for (uint32_t k = 0; k < triangles; ++k) append(lumps[11], little_endian({k, k + 1, k + side}));
  for (int k = 0; k < count; ++k) append(lumps[13], bsp_face(0, type, 0, side * side, 0, 3 * triangles, side, side));
  return bsp_file(lumps);
}

struct folder {
  std::string path = (fs::temp_directory_path() / ("spantex-level-" + std::to_string(getpid()))).string();
  folder() { fs::create_directories(path + "/maps"), fs::create_directories(path + "/textures"); }
  ~folder() { fs::remove_all(path); }
  void write(const std::string& name, const bytes& data) const { output_file(path + "/" + name).write(data); }
  // As they are, not compressed.
  void write_archive(const std::string& name, const std::vector<std::pair<std::string, bytes>>& files) const {
    zip_t* const z = zip_open((path + "/" + name).c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
    for (const auto& [file, data] : files) {
      const zip_int64_t at = zip_file_add(z, file.c_str(), zip_source_buffer(z, data.data(), data.size(), 0), 0);
      zip_set_file_compression(z, zip_uint64_t(at), ZIP_CM_STORE, 0);
    }
    assert_int_equal(zip_close(z), 0);
  }
};

// Why a level is refused; empty if it is not.
std::string refusal(const std::string& path, const std::string& map = "") {
  try {
    (void)load_level(path, map, {});
  } catch (const input_error& e) {
    return e.what();
  }
  return {};
}

SPANTEX_CASE(a_map_is_read_with_its_patches_and_places) {
  static folder f;
  static level l;
  f.write("maps/m.bsp", small_map());
  l = load_level(f.path + "/maps/m.bsp", "", {});
  assert_int_equal(l.drawn.faces.size(), 2 + 32);  // no sky
  assert_int_equal(l.missing.size(), 1);
  assert_int_equal(l.places.size(), 2);
  assert_true((l.places[0] == vector3d{1, 3 + 26, -2} && l.places[1] == vector3d{9, 3 + 26, -2}));
  f.write("textures/a.png", encode_png(image(16, 8, {10, 20, 30, 255})));
  l = load_level(f.path + "/maps/m.bsp", "", {});
  assert_int_equal(l.missing.size(), 0);
  const world_face& first = l.drawn.faces[0];  // u of 5..6 periods of 16 texels, v of -3..-2 of 8: whole periods off; v grows as in the file
  assert_true((first.corners[1].position == vector3d{64, 0, -32} && first.corners[1].u == 16 && first.corners[1].v == 0 && first.corners[2].v == 8));
  double area = 0;  // of the patch
  for (size_t k = 2; k < l.drawn.faces.size(); ++k) {
    const auto& c = l.drawn.faces[k].corners;
    area += std::fabs((c[1].position[0] - c[0].position[0]) * (c[2].position[2] - c[0].position[2]) -
                      (c[2].position[0] - c[0].position[0]) * (c[1].position[2] - c[0].position[2])) / 2;
  }
  assert_true(std::fabs(area - 64 * 64) < 1e-9);
}

// Nothing to be read leaves by anything but input_error; sanitizers see what is read beyond the file.
SPANTEX_CASE(damaged_maps_are_refused) {
  static folder f;
  static bytes map;
  const auto refused = [&] {
    f.write("maps/m.bsp", map);
    return !refusal(f.path + "/maps/m.bsp").empty();
  };
  const bytes good = small_map();
  map = good;
  assert_false(refused());
  for (size_t size = 0; size < good.size(); size += 7) {
    map.assign(good.begin(), good.begin() + std::ptrdiff_t(size));
    assert_true(refused());
  }
  map = good;
  map[size_t(map[8 + 8 * 11]) | size_t(map[9 + 8 * 11]) << 8] = 4;  // the first index, of four vertices
  assert_true(refused());
  random_source random(5);
  int refusals = 0;
  for (int n = 0; n < 2000; ++n) {
    map = good;
    map[size_t(random.between(4, int64_t(map.size()) - 1))] = uint8_t(random.next());
    refusals += refused();
  }
  assert_in_range(refusals, 100, 1999);
}

// A floor of 150 by 70 maps of 512x512, turned: parts that stay below 32768 texels, and each of its points is on one of them, at the place of the map that it had.
SPANTEX_CASE(faces_beyond_the_range_are_cut) {
  const auto map_with = [](wrap u, wrap v) { return texture_map(image(512, 512, {1, 2, 3, 255}), prefilter::box, u, v); };
  const auto at = [](double x, double y) { return world_vertex{{x, 0, y}, 0.3 + 1.5 * x + 0.2 * y, -7.2 - 0.4 * x + 0.7 * y}; };
  const world_face floor{{at(0, 0), at(100, 0), at(100, 100), at(0, 100)}, 4};
  const auto is_whole = [](double x) { return fabs(x - round(x)) < 1e-9; };
  for (const wrap mode : {wrap::repeat, wrap::mirror}) {
    const texture_map map = map_with(mode, mode);
    std::vector<world_face> parts;
    add_in_texels(parts, floor, map.view(), "floor");
    assert_true(parts.size() > 3 && parts.size() < 20);
    double area = 0;
    for (const world_face& part : parts) {
      assert_int_equal(part.map_index, 4);
      assert_true(part.corners.size() >= 3 && part.corners.size() <= size_t(max_polygon_vertices));
      const double period = mode == wrap::mirror ? 1024 : 512;
      const world_vertex first = part.corners[0], whole = at(first.position[0], first.position[2]);
      assert_true(is_whole((first.u - whole.u * 512) / period) && is_whole((first.v - whole.v * 512) / period));
      for (size_t k = 0; k < part.corners.size(); ++k) {
        const world_vertex &a = part.corners[k], &b = part.corners[(k + 1) % part.corners.size()], of_floor = at(a.position[0], a.position[2]);
        assert_true(fabs(a.u) < 32768 && fabs(a.v) < 32768);
        assert_true(fabs((a.u - first.u) - (of_floor.u - whole.u) * 512) < 1e-6 && fabs((a.v - first.v) - (of_floor.v - whole.v) * 512) < 1e-6);
        area += (a.position[0] * b.position[2] - b.position[0] * a.position[2]) / 2;
      }
    }
    assert_true(fabs(area - 10000) < 1e-6);
  }
  const auto refused = [&](const world_face& face, wrap u, wrap v, const std::string& why = "texture coordinates of a face exceed 32768 texels", size_t before = 0) {
    std::vector<world_face> parts(before);
    try {
      add_in_texels(parts, face, map_with(u, v).view(), "floor");
    } catch (const input_error& e) {
      return e.what() == "floor: " + why;
    }
    return false;
  };
  constexpr size_t most = 1 << 20;
  assert_true(refused(floor, wrap::repeat, wrap::repeat, "more than 2^20 faces, cut where their texture coordinates exceed 32768 texels", most - 3));
  assert_false(refused({{at(0, 0), at(40, 0), at(0, 40)}, 0}, wrap::repeat, wrap::repeat, "", most));
  assert_true(refused(floor, wrap::clamp, wrap::repeat));
  assert_false(refused({{at(0, 0), at(40, 0), at(0, 40)}, 0}, wrap::clamp, wrap::clamp));
  for (const double far : {1e7, 1e30, 1e300}) {
    world_face huge = floor;
    huge.corners[2].u = far;
    assert_true(refused(huge, wrap::repeat, wrap::repeat));
  }
}

// A floor of two triangles, cut into hundreds: seen from anywhere above, nothing shows through.
SPANTEX_CASE(cut_faces_leave_no_holes) {
  const auto at = [](double x, double y) { return world_vertex{{x, 0, y}, 0.3 + 9.1 * x + 0.4 * y, -7.2 - 0.8 * x + 3.3 * y}; };
  world w{"floor", nullptr, {}, {}, 0};
  map_list maps;
  maps.emplace_back(image(512, 512, {255, 255, 255, 255}), prefilter::box, wrap::repeat, wrap::repeat);
  for (const world_face& half : {world_face{{at(0, 0), at(100, 0), at(100, 100)}, 0}, world_face{{at(0, 0), at(100, 100), at(0, 100)}, 0}}) add_in_texels(w.faces, half, maps[0].view(), "floor");
  assert_true(w.faces.size() > 50);
  w.maps = std::make_shared<const map_list>(std::move(maps));
  w.measure();
  random_source random(3);
  for (int k = 0; k < 40; ++k) {
    const auto within = [&](double low, double high) { return low + (high - low) * double(random.between(0, 1000)) / 1000; };
    camera_options c;
    c.eye = vector3d{within(30, 70), within(1, 12), within(30, 70)};
    c.target = vector3d{(*c.eye)[0] + within(-2, 2), 0, (*c.eye)[2] + within(-2, 2)};
    assert_int_equal(overdraw_of(look_at(w, c, {640, 480})).pixels_shown, 640 * 480);
  }
}

SPANTEX_CASE(triangles_are_counted_before_they_are_made) {
  static folder f;
  static std::string why;
  constexpr uint32_t patch = 2, mesh = 3;
  f.write("m.bsp", map_of_equal_faces(mesh, 5));
  assert_true(refusal(f.path + "/m.bsp").empty());
  f.write("m.bsp", map_of_equal_faces(mesh, 1025));
  why = refusal(f.path + "/m.bsp");
  assert_true(why == f.path + "/m.bsp: 1049600 triangles, more than 1048576");
  f.write("m.bsp", map_of_equal_faces(patch, 33));
  why = refusal(f.path + "/m.bsp");
  assert_true(why == f.path + "/m.bsp: 1081344 triangles, more than 1048576");
}

SPANTEX_CASE(what_an_archive_holds_is_as_its_checksum_says) {
  static folder f;
  static bytes file;
  static std::string why;
  const bytes map = small_map();
  f.write_archive("a.pk3", {{"maps/m.bsp", map}});
  assert_true(refusal(f.path + "/a.pk3").empty());
  file = read_file(f.path + "/a.pk3");
  const auto at = std::search(file.begin(), file.end(), map.begin(), map.end());
  assert_true(at != file.end());
  at[std::ptrdiff_t(map.size()) - 4] ^= 1;
  f.write("a.pk3", file);
  why = refusal(f.path + "/a.pk3");
  assert_true(why.starts_with(f.path + "/a.pk3: maps/m.bsp: damaged"));
}

SPANTEX_CASE(maps_of_an_archive_are_found_in_any_case_and_listed_once) {
  static folder f;
  static std::string path, why;
  path = f.path + "/maps/b.pk3";
  const bytes map = small_map(), cut = [] { bytes p = encode_png(image(16, 8, {10, 20, 30, 255})); p.resize(p.size() / 2); return p; }();
  f.write_archive("maps/b.pk3", {{"readme.txt", map}, {"MAPS/One.BSP", map}, {"maps/two.bsp", map}, {"more/two.bsp", map}});
  assert_true(refusal(path, "one").empty() && refusal(path, "Two").empty());
  why = refusal(path, "three");
  assert_true(why == path + ": no map 'three'; there are One, two");
  why = refusal(path);
  assert_true(why == path + ": many maps, choose one by --map: One, two");
  f.write_archive("maps/b.pk3", {{"maps/one.bsp", map}, {"textures/a.png", cut}});
  why = refusal(path);
  assert_true(why.starts_with(path + ": textures/a.png: "));
  fs::create_directories(f.path + "/maps/textures");
  f.write("maps/textures/a.png", encode_png(image(16, 8, {10, 20, 30, 255})));
  assert_true(refusal(path) == why);  // its own comes first
}

SPANTEX_CASE(a_walk_goes_where_nothing_is_in_the_way) {
  static level l;
  const auto wall = [](double x) {  // across the z axis' plane, from the floor up
    return world_face{{{{x, -100, -100}, 0, 0}, {{x, 300, -100}, 0, 0}, {{x, -100, 300}, 0, 0}}, 0};
  };
  l = {{"walk", nullptr, {wall(50)}, {}, 0}, {{0, 0, 0}, {100, 0, 0}, {0, 0, 40}, {100, 0, 40}}, {}};
  l.drawn.measure();
  int crossings = 0;
  static std::vector<viewpoint> views;
  views = tour(l, 80);
  for (size_t k = 1; k < views.size(); ++k) crossings += (views[k].eye[0] < 50) != (views[k - 1].eye[0] < 50);
  assert_int_equal(views.size(), 80);
  assert_int_equal(crossings, 1);  // the leap
  for (const viewpoint& v : views) assert_true(v.eye[0] == 0 || v.eye[0] == 100);
  l.places.resize(1);
  assert_true((tour(l, 4)[0].eye == vector3d{0, 0, 0}));
  l.places.clear();
  for (int k = 0; k < 30000; ++k) l.places.push_back({-2.0 * k, 0, 0});
  views = tour(l, 1022);
  assert_true(std::fabs(views.back().eye[0] + 1021) < 1e-6);  // through the first 512
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(eight_layers_cost_at_most_three_tenths_more_than_one),
      cmocka_unit_test(frames_of_levels_cost_at_most_three_tenths_more_than_their_visible_pixels),
      cmocka_unit_test(hidden_faces_of_levels_show_nothing),
      cmocka_unit_test(a_map_is_read_with_its_patches_and_places),
      cmocka_unit_test(damaged_maps_are_refused),
      cmocka_unit_test(faces_beyond_the_range_are_cut),
      cmocka_unit_test(cut_faces_leave_no_holes),
      cmocka_unit_test(triangles_are_counted_before_they_are_made),
      cmocka_unit_test(what_an_archive_holds_is_as_its_checksum_says),
      cmocka_unit_test(maps_of_an_archive_are_found_in_any_case_and_listed_once),
      cmocka_unit_test(a_walk_goes_where_nothing_is_in_the_way),
  };
  return run_suite("quake_level", tests);
}
