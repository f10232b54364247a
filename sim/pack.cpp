// SPDX-License-Identifier: Apache-2.0
#include "pack.hpp"

#include <stdio.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "inverse_filter.hpp"

namespace spantex::sim {
namespace {

namespace pf = pack_format;

// A level's texels as they lie in a pack; encode_level gives 16-bit texels in this machine's order.
bytes in_order(bytes texels, texel_format format, pf::byte_order order) {
  if (is_16_bit(format) && order != pf::native_order)
    for (size_t k = 0; k < texels.size(); k += 2) std::swap(texels[k], texels[k + 1]);
  return texels;
}

image as_stored(texel_format format, const image& level, const palette& colours = {}) {
  return decode_level(format, encode_level(format, level, colours), level.width_px, level.height_px, colours);
}

// What no array can be called: words of C and C++, what the source itself uses, main, and what compilers for Unix define.
constexpr std::string_view taken_names =
    " _Alignas _Alignof _Atomic _BitInt _Bool _Complex _Decimal128 _Decimal32 _Decimal64 _Generic _Imaginary _Noreturn _Static_assert _Thread_local alignas "
    "alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t char8_t class co_await co_return co_yield compl concept const "
    "const_cast consteval constexpr constinit continue decltype default delete do double dynamic_cast else enum explicit export extern false float for "
    "friend goto if inline int linux long main mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register "
    "reinterpret_cast requires restrict return short signed sizeof static static_assert static_cast struct switch template this thread_local throw true try "
    "typedef typeid typename typeof typeof_unqual uint32_t uint64_t uint8_t union unix unsigned using virtual void volatile wchar_t while xor xor_eq ";

bool all_on_their_side(const image& wanted, const image& got, uint8_t threshold) {
  for (size_t k = 0; k < wanted.pixels.size(); ++k)
    if ((wanted.pixels[k].a >= threshold) != (got.pixels[k].a >= threshold)) return false;
  return true;
}

void settle_texels(image& level, texel_format format, uint8_t threshold) {
  image ramp(256, 1, {});
  for (int a = 0; a < 256; ++a) ramp.at(a, 0).a = uint8_t(a);
  const image kept = as_stored(format, ramp);
  std::array<uint8_t, 256> settled{};
  for (int a = 0; a < 256; ++a) {
    const int towards = a >= threshold ? 1 : -1;
    int moved = a;
    while (moved > 0 && moved < 255 && (kept.at(moved, 0).a >= threshold) != (a >= threshold)) moved += towards;
    settled[size_t(a)] = uint8_t(moved);
  }
  for (rgba8& c : level.pixels) c.a = settled[c.a];
}

void settle_indices(image& level, const palette& colours, uint8_t threshold, int threads) {
  palette sides[2];
  for (const rgba8& c : colours) sides[c.a >= threshold].push_back(c);
  const auto nearest = [](const palette& p, rgba8 c) { return p[size_t(nearest_colour(p.data(), int(p.size()), c))]; };
  for_each_index(level.height_px, threads, [&](int y) {
    for (int x = 0; x < level.width_px; ++x) {
      rgba8& c = level.at(x, y);
      const bool kept = c.a >= threshold;
      if ((nearest(colours, c).a >= threshold) != kept && !sides[kept].empty()) c = nearest(sides[kept], c);
    }
  });
}

// Alphas of 0 and 255 come out of every format with alpha as they are, so the last push helps.
void settle_block(image& block, texel_format format, uint8_t threshold) {
  const image wanted = block;
  for (const int push : {0, 1, 2, 4, 8, 16, 32, 64, 128, 255}) {
    for (size_t k = 0; k < block.pixels.size(); ++k) {
      const int a = wanted.pixels[k].a;
      block.pixels[k].a = uint8_t(std::clamp(a >= threshold ? a + push : a - push, 0, 255));
    }
    if (all_on_their_side(wanted, as_stored(format, block), threshold)) return;
  }
}

void settle_blocks(image& level, texel_format format, uint8_t threshold, int threads) {
  for_each_index(blocks_across(level.height_px), threads, [&](int by) {
    const int y0 = block_side * by, height = std::min(block_side, level.height_px - y0);
    for (int x0 = 0; x0 < level.width_px; x0 += block_side) {
      image block(std::min(block_side, level.width_px - x0), height, {});
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < block.width_px; ++x) block.at(x, y) = level.at(x0 + x, y0 + y);
      settle_block(block, format, threshold);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < block.width_px; ++x) level.at(x0 + x, y0 + y) = block.at(x, y);
    }
  });
}

void settle_alpha(image& level, const palette& colours, const compile_options& o) {
  if (is_compressed(o.format)) settle_blocks(level, o.format, o.alpha_threshold, o.threads);
  else if (palette_size(o.format) != 0) settle_indices(level, colours, o.alpha_threshold, o.threads);
  else settle_texels(level, o.format, o.alpha_threshold);
}

struct facts {
  bool opaque = true, binary_alpha = true;
  uint16_t uniform_levels = 0;
};

// Level k, as it comes out of its format.
void note_facts(const image& decoded, size_t k, facts& f) {
  bool uniform = true;
  for (const rgba8& c : decoded.pixels) {
    uniform = uniform && c == decoded.pixels[0];
    f.opaque = f.opaque && c.a == 255;
    f.binary_alpha = f.binary_alpha && (c.a == 255 || c.a == 0);
  }
  if (uniform) f.uniform_levels = uint16_t(f.uniform_levels | 1u << k);
}

void put16(bytes& out, size_t at, uint32_t x) {
  out[at] = uint8_t(x);
  out[at + 1] = uint8_t(x >> 8);
}

void put32(bytes& out, size_t at, uint32_t x) {
  put16(out, at, x & 0xFFFF);
  put16(out, at + 2, x >> 16);
}

int level_count_of(const image& level0, const compile_options& o) {
  return o.level_count == 0 ? all_levels(level0.width_px, level0.height_px) : o.level_count;
}

// But for what the payload tells: facts, palette, levels, size, checksums.
bytes header_of(const image& level0, const compile_options& o) {
  const int level_count = level_count_of(level0, o);
  bytes h(pf::header_bytes(level_count));
  std::copy(std::begin(pf::magic), std::end(pf::magic), h.begin());
  put16(h, 4, pf::version);
  put16(h, 6, uint32_t(h.size()));
  h[12] = uint8_t(o.format);
  h[13] = uint8_t(level_count);
  h[14] = uint8_t(o.wrap_u);
  h[15] = uint8_t(o.wrap_v);
  put16(h, 16, uint32_t(level0.width_px));
  put16(h, 18, uint32_t(level0.height_px));
  h[22] = is_16_bit(o.format) ? o.order : pf::bytes_only;
  h[23] = o.alpha_threshold;
  return h;
}

void put_facts(bytes& pack, const facts& f, bool srgb) {
  const auto flag = [](bool set, pf::flag bit) { return set ? uint32_t(bit) : 0u; };
  put16(pack, 20, flag(f.opaque, pf::opaque) | flag(f.binary_alpha, pf::binary_alpha) | flag(srgb, pf::srgb));
  put16(pack, 24, f.uniform_levels);
}

void put_contour(bytes& pack, const contour_style& s) {
  put16(pack, 20, uint32_t(pack[20] | pack[21] << 8) | uint32_t(pf::contour));
  put16(pack, 32, s.threshold);
  put16(pack, 34, s.scale);
  pack[36] = s.outline;
  pack[37] = uint8_t(s.unit);
}

void align(bytes& pack) { pack.resize(pf::aligned(uint32_t(pack.size()))); }

void append_palette(bytes& pack, const palette& colours) {
  if (colours.empty()) return;
  put16(pack, 26, uint32_t(colours.size()));
  put32(pack, 28, uint32_t(pack.size()));
  for (const rgba8& c : colours) pack.insert(pack.end(), {c.r, c.g, c.b, c.a});
  align(pack);
}

void append_level(bytes& pack, size_t k, const bytes& texels) {
  const size_t entry = pf::header_bytes(int(k));
  put32(pack, entry, uint32_t(pack.size()));
  put32(pack, entry + 4, uint32_t(texels.size()));
  pack.insert(pack.end(), texels.begin(), texels.end());
  align(pack);
}

void seal(bytes& pack, size_t header_bytes) {
  put32(pack, 8, uint32_t(pack.size()));
  put32(pack, 40, crc32(pack.data() + header_bytes, pack.size() - header_bytes));
  const uint32_t fixed = crc32(pack.data(), pf::fixed_bytes - 4);
  put32(pack, 44, crc32(pack.data() + pf::fixed_bytes, header_bytes - pf::fixed_bytes, fixed));
}

// Every alpha that could be the test's, 256 for one that nothing passes.
int alpha_reached_by(const std::array<int64_t, 256>& count, const alpha_coverage& wanted, int64_t texels, int preferred) {
  int best = preferred;
  int64_t reached = 0, least = -1;
  for (int t = 256; t >= 1; --t) {
    if (t < 256) reached += count[size_t(t)];
    const int64_t off = std::abs(reached * wanted.texels - wanted.kept * texels);
    if (least >= 0 && (off > least || (off == least && std::abs(t - preferred) >= std::abs(best - preferred)))) continue;
    best = t;
    least = off;
  }
  return best;
}

void tell(const compile_options& o, const image& level) {
  if (o.parts_done) o.parts_done(blocks_across(level.height_px));
}

std::vector<image> filtered_levels(const image& level0, const compile_options& o) {
  const int count = level_count_of(level0, o);
  const colour_space space = o.srgb ? colour_space::srgb : colour_space::coded;
  std::vector<image> levels{level0};
  while (int(levels.size()) < count) {
    levels.push_back(halved(levels.back(), o.levels, o.wrap_u, o.wrap_v, o.alpha, o.threads, space));
    tell(o, levels.back());
  }
  if (!o.inverse) return levels;
  for (int k = 1; k < count; ++k) {
    const blur x = blur_of(level0.width_px, level0.height_px, k, o.levels);
    levels[size_t(k)] = inverse_filtered(levels[size_t(k)], x, o.wrap_u, o.wrap_v, o.alpha, o.threads, space);
    tell(o, levels[size_t(k)]);
  }
  return levels;
}

void keep_alpha_test(std::vector<image>& levels, const palette& colours, const compile_options& o) {
  const alpha_coverage wanted = coverage_of(levels[0], o.alpha_threshold);
  for (image& level : levels) {
    if (&level != &levels[0]) keep_coverage(level, o.alpha_threshold, wanted);
    settle_alpha(level, colours, o);
    tell(o, level);
  }
}

std::vector<image> levels_with(const image& level0, const palette& colours, const compile_options& o) {
  std::vector<image> levels = filtered_levels(level0, o);
  if (o.alpha_threshold != 0) keep_alpha_test(levels, colours, o);
  return levels;
}

}  // namespace

alpha_coverage coverage_of(const image& level, uint8_t threshold) {
  const auto kept = std::count_if(level.pixels.begin(), level.pixels.end(), [&](const rgba8& c) { return c.a >= threshold; });
  return {int64_t(kept), int64_t(level.pixels.size())};
}

void keep_coverage(image& level, uint8_t threshold, const alpha_coverage& wanted) {
  std::array<int64_t, 256> count{};
  for (const rgba8& c : level.pixels) ++count[c.a];
  const int t = alpha_reached_by(count, wanted, int64_t(level.pixels.size()), threshold);
  for (rgba8& c : level.pixels) c.a = uint8_t(std::min(255, c.a * threshold / t));
}

palette compile_palette(const image& level0, const compile_options& o) {
  const int most = palette_size(o.format);
  if (most == 0) return {};
  const alpha_coverage test = coverage_of(level0, o.alpha_threshold);
  if (test.kept == 0 || test.kept == test.texels) return make_palette(level0, most);
  image sides[2];
  for (const rgba8& c : level0.pixels) sides[c.a >= o.alpha_threshold].pixels.push_back(c);
  const int share = std::clamp(int(most * test.kept / test.texels), 1, most - 1);
  palette colours = make_palette(sides[1], share);
  const palette others = make_palette(sides[0], most - share);
  colours.insert(colours.end(), others.begin(), others.end());
  return colours;
}

std::vector<image> compile_levels(const image& level0, const compile_options& o) {
  return levels_with(level0, o.alpha_threshold != 0 ? compile_palette(level0, o) : palette{}, o);
}

// Every pass over a level counts its rows of blocks: filtering, sharpening, settling, encoding.
int compile_parts(const image& level0, const compile_options& o) {
  int parts = 0;
  for (int k = 0; k < level_count_of(level0, o); ++k) {
    const int filters = k == 0 ? 0 : o.inverse ? 2 : 1, settling = o.alpha_threshold == 0 ? 0 : 1;
    parts += (filters + settling + 1) * blocks_across(level_side(level0.height_px, k));
  }
  return parts;
}

namespace {

bytes pack_of(const std::vector<image>& levels, const palette& colours, const compile_options& o, const contour_style* style) {
  bytes pack = header_of(levels[0], o);
  const size_t header_bytes = pack.size();
  append_palette(pack, colours);
  facts f;
  for (size_t k = 0; k < levels.size(); ++k) {
    const image& level = levels[k];
    const bytes texels = encode_level(o.format, level, colours, o.threads, o.parts_done);
    note_facts(decode_level(o.format, texels, level.width_px, level.height_px, colours), k, f);
    append_level(pack, k, in_order(texels, o.format, o.order));
  }
  put_facts(pack, f, o.srgb);
  if (style != nullptr) put_contour(pack, *style);
  seal(pack, header_bytes);
  return pack;
}

}  // namespace

bytes compile_pack(const image& level0, const compile_options& o) {
  const palette colours = compile_palette(level0, o);
  return pack_of(levels_with(level0, colours, o), colours, o, nullptr);
}

bytes compile_contour_pack(const std::vector<image>& levels, const contour_style& style, const compile_options& options) {
  compile_options o = options;
  o.level_count = int(levels.size());
  o.srgb = false;
  o.alpha_threshold = 0;
  const int most = palette_size(o.format);
  return pack_of(levels, most == 0 ? palette{} : make_palette(levels[0], most), o, &style);
}

std::string identifier_of(const std::string& path) {
  std::string name = std::filesystem::path(path).stem().string();
  const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); };
  for (char& c : name)
    if (!plain(c)) c = '_';
  const bool taken = taken_names.find(" " + name + " ") != std::string_view::npos;
  return name.empty() || taken || (name[0] >= '0' && name[0] <= '9') ? "map_" + name : name;
}

std::string c_array(const bytes& pack, const std::string& name, c_linkage linkage) {
  const std::string size = std::to_string(pack.size()), storage = linkage == c_linkage::internal ? "static const" : "const";
  std::string text = "/* Texture pack, spantex/pack.hpp. In C++: texture_pack::open(" + name + ", " + name + "_bytes, ...). */\n#include <stdint.h>\n\n";
  text += "/* The union aligns the bytes to 8. */\nstatic const union { uint8_t bytes[" + size + "]; uint64_t alignment; } " + name + "_storage = {{";
  char number[8];
  for (size_t k = 0; k < pack.size(); ++k) {
    snprintf(number, sizeof number, "%u,", unsigned(pack[k]));
    text += k % 24 == 0 ? "\n" : "";
    text += number;
  }
  text.back() = '\n';
  text += "}};\n\n";
  if (linkage == c_linkage::external)
    text += "#ifdef __cplusplus\nextern \"C\" {\n#endif\nextern const uint8_t* const " + name + ";\nextern const uint32_t " + name +
            "_bytes;\n#ifdef __cplusplus\n}\n#endif\n\n";
  text += storage + " uint8_t* const " + name + " = " + name + "_storage.bytes;\n" + storage + " uint32_t " + name + "_bytes = " + size + ";\n";
  return text;
}

}  // namespace spantex::sim
