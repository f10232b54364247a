// SPDX-License-Identifier: Apache-2.0
// A compiled texture (.stx): a map with its levels and what is known about it, validated and used where it lies: flash, a linked object
// or a mapped file. docs/TEXTURES.md tells the format; `spantex texture` writes it.
//
//   offset  bytes
//        0    4   magic 'S' 'T' 'X' 1Ah
//        4    2   version, 1
//        6    2   header bytes, 48 + 8 levels
//        8    4   bytes of the whole pack
//       12    1   texel format (texel.hpp)
//       13    1   level count
//       14    2   wrap mode of u, of v (wrap.hpp)
//       16    4   width, height of level 0
//       20    2   flags: 1 opaque, 2 binary alpha, 4 sRGB, 8 contour map
//       22    1   byte order of 16-bit texels: 0 none there, 1 little, 2 big
//       23    1   threshold of the alpha test, 0 for none
//       24    2   uniform levels: bit L is set if all texels of level L are alike
//       26    2   colours of the palette, 4 bytes r g b a each: 1..256 for palette8, 1..16 for palette4, 0 for the others
//       28    4   offset of the palette, 0 for none
//       32    8   of a contour map (contour_style.hpp): threshold, scale, u8.8, 2 bytes each; outline, 1/16 pixel; field unit; 2 bytes 0. Else 0
//       40    4   CRC-32 of the payload: from the header's end to the pack's
//       44    4   CRC-32 of the header without this field
//       48    8   per level: offset, bytes
//
// Numbers of the header are little-endian on every machine. The payload follows the header: palette, levels from 0, each at a multiple of 8
// bytes from the pack's start, the gaps 0. The two CRCs cover every bit. CRC-32 is zlib's: polynomial EDB88320h, inverted before and after.
#pragma once
#include <stddef.h>
#include <stdint.h>

#include <spantex/texture.hpp>

namespace spantex {

namespace pack_format {

inline constexpr uint8_t magic[4] = {'S', 'T', 'X', 0x1A};
inline constexpr uint16_t version = 1;
inline constexpr uint32_t fixed_bytes = 48, level_entry_bytes = 8, alignment = 8;
enum flag : uint16_t { opaque = 1, binary_alpha = 2, srgb = 4, contour = 8, all_flags = 15 };
enum byte_order : uint8_t { bytes_only = 0, little_endian = 1, big_endian = 2 };

inline constexpr byte_order native_order = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? big_endian : little_endian;

constexpr uint32_t aligned(uint32_t n) { return (n + alignment - 1) & ~(alignment - 1); }
constexpr uint32_t header_bytes(int level_count) { return fixed_bytes + level_entry_bytes * uint32_t(level_count); }

}  // namespace pack_format

namespace detail {

struct crc_table { uint32_t value[16]; };
constexpr crc_table make_crc_table() {
  crc_table t{};
  for (uint32_t k = 0; k < 16; ++k) {
    uint32_t c = k;
    for (int bit = 0; bit < 4; ++bit) c = (c & 1) != 0 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
    t.value[k] = c;
  }
  return t;
}
inline constexpr crc_table crc_of_nibble = make_crc_table();

}  // namespace detail

// Continues `crc` (0 to begin) over `size` bytes. Table of 64 bytes, two steps a byte.
constexpr uint32_t crc32(const uint8_t* data, size_t size, uint32_t crc = 0) {
  crc = ~crc;
  for (size_t k = 0; k < size; ++k) {
    crc ^= data[k];
    crc = (crc >> 4) ^ detail::crc_of_nibble.value[crc & 15];
    crc = (crc >> 4) ^ detail::crc_of_nibble.value[crc & 15];
  }
  return ~crc;
}

// Reading every texel once at start-up may take too long; the header, and that the levels lie within the bytes, is always checked.
enum class payload_check : uint8_t { crc, none };

class texture_pack {
 public:
  // The bytes must stay where they are while the pack is used; bytes beyond the pack's own size are not looked at. No byte at or beyond
  // `size` is read. On failure `out` is left as it was. Errors, in the order of the checks:
  //   bad_pointer         null
  //   pack_misaligned     not at a multiple of 8 bytes
  //   pack_truncated      fewer bytes than the header, or the pack, has
  //   pack_not_a_pack     the magic is not there
  //   pack_bad_version    a version that is not known here
  //   pack_bad_header     the header's checksum, or its length, is wrong
  //   pack_bad_field      a format, wrap mode, flag, byte order or palette that is not defined; a reserved byte that is not 0
  //   bad_size, bad_levels  as texture_view::make
  //   pack_bad_layout     level or palette is not where, or as long as, format and size say
  //   pack_byte_order     16-bit texels of the other byte order
  //   pack_bad_payload    the payload's checksum is wrong
  static status open(const void* bytes, size_t size, texture_pack& out, payload_check check = payload_check::crc) {
    SPANTEX_TRY(open_view(bytes, size, out.view_, check));
    const reader r{static_cast<const uint8_t*>(bytes), size};
    out.flags_ = r.u16(20);
    out.alpha_threshold_ = r.u8(23);
    out.uniform_levels_ = r.u16(24);
    return status::ok;
  }

  // The same of view() alone.
  static status open_view(const void* bytes, size_t size, texture_view& out, payload_check check = payload_check::crc) {
    if (bytes == nullptr) return size == 0 ? status::pack_truncated : status::bad_pointer;
    if (uintptr_t(bytes) % pack_format::alignment != 0) return status::pack_misaligned;
    const reader r{static_cast<const uint8_t*>(bytes), size};
    SPANTEX_TRY(check_header(r));
    SPANTEX_TRY(check_fields(r));
    SPANTEX_TRY(check_layout(r));
    if (is_16_bit(texel_format(r.u8(12))) && r.u8(22) != pack_format::native_order) return status::pack_byte_order;
    const uint32_t begin = r.u16(6), end = r.u32(8);
    if (check == payload_check::crc && crc32(r.data + begin, end - begin) != r.u32(40)) return status::pack_bad_payload;
    SPANTEX_TRY(make_view(r, out));
    const uint16_t flags = r.u16(20);
    if ((flags & pack_format::srgb) != 0) out.set_colours(colour_space::srgb);
    if ((flags & pack_format::contour) != 0) SPANTEX_TRY(out.set_contour(style_of(r)));
    out.set_facts({(flags & pack_format::opaque) != 0, r.u16(24)});
    return status::ok;
  }

  const texture_view& view() const { return view_; }

  // Facts that let work be skipped; each holds for every texel of every level, as it comes out of its format.
  bool opaque() const { return (flags_ & pack_format::opaque) != 0; }              // alpha is 255: no blending, no alpha test
  bool binary_alpha() const { return (flags_ & pack_format::binary_alpha) != 0; }  // alpha is 0 or 255
  bool uniform(int level) const { return ((uniform_levels_ >> level) & 1) != 0; }  // one colour: nothing to load or filter
  bool srgb() const { return (flags_ & pack_format::srgb) != 0; }                  // the maker's word about the colours; view() has it too
  bool contour() const { return (flags_ & pack_format::contour) != 0; }            // alpha is a scalar field for filter contour; view() has its style

  bool alpha_tested() const { return alpha_threshold_ != 0; }
  uint8_t alpha_threshold() const { return alpha_threshold_; }  // a texel is kept if its alpha is at least this

 private:
  struct reader {
    const uint8_t* data;
    size_t size;
    uint8_t u8(uint32_t at) const { return data[at]; }
    uint16_t u16(uint32_t at) const { return uint16_t(data[at] | data[at + 1] << 8); }
    uint32_t u32(uint32_t at) const { return uint32_t(u16(at)) | uint32_t(u16(at + 2)) << 16; }
  };

  static contour_style style_of(const reader& r) { return {r.u16(32), r.u16(34), r.u8(36), field_unit(r.u8(37))}; }

  static status check_header(const reader& r) {
    using namespace pack_format;
    for (uint32_t k = 0; k < sizeof magic; ++k) {
      if (k >= r.size) return status::pack_truncated;
      if (r.u8(k) != magic[k]) return status::pack_not_a_pack;
    }
    if (r.size < fixed_bytes) return status::pack_truncated;
    if (r.u16(4) != version) return status::pack_bad_version;
    const uint32_t header = r.u16(6), levels = r.u8(13);
    if (levels > max_levels || header != header_bytes(int(levels))) return status::pack_bad_header;
    if (r.size < header) return status::pack_truncated;
    const uint32_t crc = crc32(r.data + fixed_bytes, header - fixed_bytes, crc32(r.data, fixed_bytes - 4));
    if (crc != r.u32(44)) return status::pack_bad_header;
    if (r.u32(8) < header) return status::pack_bad_layout;
    return r.size < r.u32(8) ? status::pack_truncated : status::ok;
  }

  static status check_fields(const reader& r) {
    using namespace pack_format;
    const uint8_t format = r.u8(12), last_wrap = uint8_t(wrap::mirror);
    if (format >= texel_format_count || r.u8(14) > last_wrap || r.u8(15) > last_wrap) return status::pack_bad_field;
    const uint8_t order = r.u8(22);
    const bool ordered = is_16_bit(texel_format(format));
    if (ordered ? order != little_endian && order != big_endian : order != bytes_only) return status::pack_bad_field;
    if ((r.u16(20) & ~all_flags) != 0) return status::pack_bad_field;
    const bool of_contours = (r.u16(20) & pack_format::contour) != 0;
    if (!of_contours && (r.u32(32) != 0 || r.u32(36) != 0)) return status::pack_bad_field;
    if (of_contours && (r.u16(38) != 0 || check(style_of(r)) != status::ok)) return status::pack_bad_field;
    if ((r.u16(24) >> r.u8(13)) != 0) return status::pack_bad_field;
    const uint32_t colours = r.u16(26), most = uint32_t(palette_size(texel_format(format)));
    if (colours > most || (colours == 0) != (most == 0)) return status::pack_bad_field;
    return r.u32(28) == (colours == 0 ? 0 : r.u16(6)) ? status::ok : status::pack_bad_layout;
  }

  // Everything has one place: after the header the palette, then the levels, each as long as its format and size say. Sums cannot wrap:
  // sides are checked first, so a level has at most 2^26 bytes.
  SPANTEX_FRAME_APART static status check_layout(const reader& r) {
    const auto format = texel_format(r.u8(12));
    const int count = r.u8(13);
    const int32_t width = r.u16(16), height = r.u16(18);
    if (width < 1 || height < 1 || width > max_texture_side || height > max_texture_side) return status::bad_size;
    uint32_t next = pack_format::aligned(r.u16(6) + uint32_t(sizeof(rgba8)) * r.u16(26));
    for (int k = 0; k < count; ++k) {
      const uint32_t entry = pack_format::header_bytes(k);
      const uint32_t bytes = level_bytes(format, level_side(width, k), level_side(height, k));
      if (r.u32(entry) != next || r.u32(entry + 4) != bytes) return status::pack_bad_layout;
      next = pack_format::aligned(next + bytes);
    }
    if (next != r.u32(8)) return status::pack_bad_layout;
    return texture_view::check_shape(count, width, height);
  }

  // What was checked cannot fail.
  SPANTEX_FRAME_APART static status make_view(const reader& r, texture_view& out) {
    const void* levels[max_levels] = {};
    const int count = r.u8(13), colours = r.u16(26);
    for (int k = 0; k < count; ++k) levels[k] = r.data + r.u32(pack_format::header_bytes(k));
    const rgba8* const palette = colours == 0 ? nullptr : static_cast<const rgba8*>(static_cast<const void*>(r.data + r.u32(28)));
    return texture_view::make(texel_format(r.u8(12)), levels, count, r.u16(16), r.u16(18), wrap(r.u8(14)), wrap(r.u8(15)), out, palette, colours);
  }

  texture_view view_;
  uint16_t flags_ = 0, uniform_levels_ = 0;
  uint8_t alpha_threshold_ = 0;
};

}  // namespace spantex
