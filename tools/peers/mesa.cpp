// SPDX-License-Identifier: Apache-2.0
// Mesa's llvmpipe through OSMesa: one quad with homogeneous texture coordinates, the same levels as ours, one thread. draw() ends when the
// pixels are in the caller's buffer; of sRGB codes, which OSMesa's own buffer does not take, when they are in a renderbuffer, from which read() gets them.
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <string>
#include <vector>

#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
#include <GL/glext.h>

#include "peer.hpp"

#ifndef GL_TEXTURE_MAX_ANISOTROPY_EXT
#define GL_TEXTURE_MAX_ANISOTROPY_EXT 0x84FE
#endif

namespace spantex::peers {
namespace {

GLint minifying(sampling kind) {
  switch (kind) {
    case sampling::nearest: return GL_NEAREST;
    case sampling::bilinear: return GL_LINEAR;
    case sampling::mip_bilinear: return GL_LINEAR_MIPMAP_NEAREST;
    case sampling::trilinear:
    case sampling::aniso16: break;
  }
  return GL_LINEAR_MIPMAP_LINEAR;
}

class mesa_peer final : public peer {
 public:
  explicit mesa_peer(OSMesaContext context) : context_(context) {}
  ~mesa_peer() override { OSMesaDestroyContext(context_); }
  const char* name() const override { return "llvmpipe"; }
  const char* version() const override { return version_.c_str(); }

  bool prepare(const task& t) override {
    width_ = t.width;
    height_ = t.height;
    pixels_.assign(size_t(width_) * size_t(height_), 0);
    if (!OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, width_, height_)) return false;
    OSMesaPixelStore(OSMESA_Y_UP, 0);
    version_ = std::string(text_of(GL_RENDERER)) + ", " + text_of(GL_VERSION);
    if (version_.find("llvmpipe") == std::string::npos) return false;
    if (!choose_target(t.srgb)) return false;
    upload(t);
    glMatrixMode(GL_PROJECTION);
    glLoadIdentity();
    if (t.srgb) glOrtho(0, width_, 0, height_, -1, 1);
    else glOrtho(0, width_, height_, 0, -1, 1);  // y down: the buffer has its first row at the top
    set_corners(t);
    return glGetError() == GL_NO_ERROR;
  }

  void draw() override {
    glBegin(GL_QUADS);
    for (const corner& c : corners_) {
      glTexCoord4d(c.s, c.t, 0, c.q);
      glVertex2d(c.x, c.y);
    }
    glEnd();
    glFinish();
  }

  void read(uint8_t* rgba) const override {
    if (codes_[0] == 0) memcpy(rgba, pixels_.data(), 4 * pixels_.size());
    else glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
  }

 private:
  struct corner { double x, y, s, t, q; };

  static const char* text_of(GLenum what) {
    const GLubyte* const text = glGetString(what);
    return text != nullptr ? reinterpret_cast<const char*>(text) : "?";
  }

  bool choose_target(bool srgb) {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glDisable(GL_FRAMEBUFFER_SRGB);
    if (codes_[0] != 0) {
      glDeleteFramebuffers(1, &codes_[0]);
      glDeleteRenderbuffers(1, &codes_[1]);
      codes_[0] = codes_[1] = 0;
    }
    if (srgb) {
      glGenFramebuffers(1, &codes_[0]);
      glGenRenderbuffers(1, &codes_[1]);
      glBindRenderbuffer(GL_RENDERBUFFER, codes_[1]);
      glRenderbufferStorage(GL_RENDERBUFFER, GL_SRGB8_ALPHA8, width_, height_);
      glBindFramebuffer(GL_FRAMEBUFFER, codes_[0]);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, codes_[1]);
      glEnable(GL_FRAMEBUFFER_SRGB);
    }
    glViewport(0, 0, width_, height_);
    return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  }

  void upload(const task& t) {
    if (texture_ != 0) glDeleteTextures(1, &texture_);
    glGenTextures(1, &texture_);
    glBindTexture(GL_TEXTURE_2D, texture_);
    glEnable(GL_TEXTURE_2D);
    glTexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, t.kind == sampling::nearest ? GL_NEAREST : GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, minifying(t.kind));
    if (t.kind == sampling::aniso16) glTexParameterf(GL_TEXTURE_2D, GL_TEXTURE_MAX_ANISOTROPY_EXT, 16);
    for (int k = 0; k < t.level_count; ++k)
      glTexImage2D(GL_TEXTURE_2D, k, t.srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, t.levels[k].width, t.levels[k].height, 0, GL_RGBA, GL_UNSIGNED_BYTE, t.levels[k].rgba);
  }

  void set_corners(const task& t) {
    const double* const m = t.matrix;
    for (int k = 0; k < 4; ++k) {
      const double x = k == 1 || k == 2 ? width_ : 0, y = k >= 2 ? height_ : 0;
      corners_[k] = {x, y, (m[0] * x + m[1] * y + m[2]) / t.levels[0].width, (m[3] * x + m[4] * y + m[5]) / t.levels[0].height,
                     m[6] * x + m[7] * y + m[8]};
    }
  }

  OSMesaContext context_;
  GLuint texture_ = 0;
  GLuint codes_[2] = {};  // framebuffer and renderbuffer of sRGB codes
  std::vector<uint32_t> pixels_;
  int width_ = 0, height_ = 0;
  corner corners_[4]{};
  std::string version_ = "?";
};

}  // namespace
}  // namespace spantex::peers

spantex::peers::peer* spantex_make_peer() {
  setenv("LP_NUM_THREADS", "0", 1);       // read when the context is made: draw in the caller's thread
  setenv("GALLIUM_DRIVER", "llvmpipe", 1);
  const OSMesaContext context = OSMesaCreateContext(OSMESA_RGBA, nullptr);
  return context == nullptr ? nullptr : new spantex::peers::mesa_peer(context);
}
