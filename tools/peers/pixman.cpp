// SPDX-License-Identifier: Apache-2.0
// pixman: a projective transform of 16.16 numbers, nearest and bilinear.
#include <math.h>
#include <stddef.h>

#include <algorithm>
#include <vector>

#include <pixman.h>

#include "peer.hpp"

namespace spantex::peers {
namespace {

// r g b a to the a8r8g8b8 that pixman has its fast paths for, and back.
uint32_t to_argb(const uint8_t* p) { return uint32_t(p[3]) << 24 | uint32_t(p[0]) << 16 | uint32_t(p[1]) << 8 | p[2]; }

class pixman_peer final : public peer {
 public:
  ~pixman_peer() override { release(); }
  const char* name() const override { return "pixman"; }
  const char* version() const override { return pixman_version_string(); }

  bool prepare(const task& t) override {
    if ((t.kind != sampling::nearest && t.kind != sampling::bilinear) || !is_in_front(t)) return false;
    release();
    const level& map = t.levels[0];
    texels_.resize(size_t(map.width) * size_t(map.height));
    for (size_t k = 0; k < texels_.size(); ++k) texels_[k] = to_argb(map.rgba + 4 * k);
    pixels_.assign(size_t(t.width) * size_t(t.height), 0);
    width_ = t.width;
    height_ = t.height;
    const pixman_format_code_t format = t.srgb ? PIXMAN_a8r8g8b8_sRGB : PIXMAN_a8r8g8b8;
    map_ = pixman_image_create_bits(format, map.width, map.height, texels_.data(), 4 * map.width);
    frame_ = pixman_image_create_bits(format, width_, height_, pixels_.data(), 4 * width_);
    pixman_image_set_repeat(map_, PIXMAN_REPEAT_NORMAL);
    pixman_image_set_filter(map_, t.kind == sampling::nearest ? PIXMAN_FILTER_NEAREST : PIXMAN_FILTER_BILINEAR, nullptr, 0);
    return set_transform(t.matrix);
  }

  void draw() override { pixman_image_composite32(PIXMAN_OP_SRC, map_, nullptr, frame_, 0, 0, 0, 0, 0, 0, width_, height_); }

  void read(uint8_t* rgba) const override {
    for (size_t k = 0; k < pixels_.size(); ++k, rgba += 4) {
      const uint32_t p = pixels_[k];
      rgba[0] = uint8_t(p >> 16);
      rgba[1] = uint8_t(p >> 8);
      rgba[2] = uint8_t(p);
      rgba[3] = uint8_t(p >> 24);
    }
  }

 private:
  // Only ratios matter: as large as 16.16 takes, for the sake of its precision; affine ones with a divisor of 1, which is how pixman knows its ways for them.
  bool set_transform(const double* m) {
    double largest = 0;
    for (int k = 0; k < 9; ++k) largest = std::max(largest, fabs(m[k]));
    const double scale = m[6] == 0 && m[7] == 0 ? 1 / m[8] : 16384 / largest;
    pixman_f_transform f;
    for (int k = 0; k < 9; ++k) f.m[k / 3][k % 3] = m[k] * scale;
    pixman_transform fixed;
    if (!pixman_transform_from_pixman_f_transform(&fixed, &f)) return false;
    return pixman_image_set_transform(map_, &fixed);
  }

  void release() {
    if (map_ != nullptr) pixman_image_unref(map_);
    if (frame_ != nullptr) pixman_image_unref(frame_);
    map_ = frame_ = nullptr;
  }

  std::vector<uint32_t> texels_, pixels_;
  pixman_image_t *map_ = nullptr, *frame_ = nullptr;
  int width_ = 0, height_ = 0;
};

}  // namespace
}  // namespace spantex::peers

spantex::peers::peer* spantex_make_peer() { return new spantex::peers::pixman_peer; }
