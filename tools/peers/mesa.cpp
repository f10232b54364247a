// SPDX-License-Identifier: Apache-2.0
// Mesa's llvmpipe through OSMesa: one polygon with homogeneous texture coordinates, or a model's triangles map by map from a buffer that was filled once; the same levels as
// ours, one thread. draw() ends when the pixels are in the caller's buffer; of sRGB codes, which OSMesa's own buffer does not take, when they are in a renderbuffer, from which read() gets them.
#include <stddef.h>
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

GLint wrapping_of(wrapping w) { return w == wrapping::repeat ? GL_REPEAT : w == wrapping::clamp ? GL_CLAMP_TO_EDGE : GL_MIRRORED_REPEAT; }

class mesa_peer final : public peer {
 public:
  explicit mesa_peer(OSMesaContext context) : context_(context) {}
  ~mesa_peer() override { OSMesaDestroyContext(context_); }
  const char* name() const override { return "llvmpipe"; }
  const char* version() const override { return version_.c_str(); }

  // Its anisotropic filter walks through all texels that a pixel's image spans: near a horizon it does not end.
  bool prepare(const task& t) override {
    if (t.kind == sampling::aniso16 && !is_in_front(t)) return false;
    if (!begin(t.width, t.height, t.srgb)) return false;
    textures_ = {texture_of(t.levels, t.level_count, t.kind, t.srgb, GL_REPEAT, GL_REPEAT)};
    glDisable(GL_DEPTH_TEST);
    glMatrixMode(GL_PROJECTION);
    glLoadIdentity();
    if (t.srgb) glOrtho(0, width_, 0, height_, -1, 1);
    else glOrtho(0, width_, height_, 0, -1, 1);  // y down: the buffer has its first row at the top
    set_corners(t);
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    return glGetError() == GL_NO_ERROR;
  }

  bool prepare(const model_task& t) override {
    if (!begin(t.width, t.height, false)) return false;
    std::vector<corner> all;
    for (int k = 0; k < t.mesh_count; ++k) {
      const mesh& m = t.meshes[k];
      textures_.push_back(texture_of(m.levels, m.level_count, t.kind, false, wrapping_of(m.wrap_s), wrapping_of(m.wrap_t)));
      firsts_.push_back(GLint(all.size()));
      all.insert(all.end(), m.corners, m.corners + m.corner_count);
    }
    firsts_.push_back(GLint(all.size()));
    glGenBuffers(1, &buffer_);
    glBindBuffer(GL_ARRAY_BUFFER, buffer_);
    glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(all.size() * sizeof(corner)), all.data(), GL_STATIC_DRAW);
    glEnableClientState(GL_VERTEX_ARRAY);
    glEnableClientState(GL_TEXTURE_COORD_ARRAY);
    glVertexPointer(3, GL_FLOAT, sizeof(corner), nullptr);
    glTexCoordPointer(2, GL_FLOAT, sizeof(corner), reinterpret_cast<const void*>(offsetof(corner, s)));
    glEnable(GL_DEPTH_TEST);
    return glGetError() == GL_NO_ERROR;
  }

  void begin_frame(const double* clip) override {
    glMatrixMode(GL_PROJECTION);
    glLoadMatrixd(clip);
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glFinish();
  }

  void draw() override {
    if (buffer_ == 0) draw_plane();
    for (size_t k = 0; buffer_ != 0 && k < textures_.size(); ++k) {
      glBindTexture(GL_TEXTURE_2D, textures_[k]);
      glDrawArrays(GL_TRIANGLES, firsts_[k], firsts_[k + 1] - firsts_[k]);
    }
    glFinish();
  }

  void read(uint8_t* rgba) const override {
    if (codes_[0] == 0) memcpy(rgba, pixels_.data(), 4 * pixels_.size());
    else glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
  }

 private:
  struct plane_corner { double x, y, s, t, q; };

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

  // A picture of that size, nothing left of the task before.
  bool begin(int width, int height, bool srgb) {
    width_ = width;
    height_ = height;
    pixels_.assign(size_t(width_) * size_t(height_), 0);
    if (!OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, width_, height_)) return false;
    OSMesaPixelStore(OSMESA_Y_UP, 0);
    version_ = std::string(text_of(GL_RENDERER)) + ", " + text_of(GL_VERSION);
    if (version_.find("llvmpipe") == std::string::npos) return false;
    glDeleteTextures(GLsizei(textures_.size()), textures_.data());
    glDeleteBuffers(1, &buffer_);
    glDisableClientState(GL_VERTEX_ARRAY);
    glDisableClientState(GL_TEXTURE_COORD_ARRAY);
    textures_.clear();
    firsts_.clear();
    buffer_ = 0;
    return choose_target(srgb);
  }

  static GLuint texture_of(const level* levels, int count, sampling kind, bool srgb, GLint wrap_s, GLint wrap_t) {
    GLuint made = 0;
    glGenTextures(1, &made);
    glBindTexture(GL_TEXTURE_2D, made);
    glEnable(GL_TEXTURE_2D);
    glTexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap_s);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap_t);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, kind == sampling::nearest ? GL_NEAREST : GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, minifying(kind));
    if (kind == sampling::aniso16) glTexParameterf(GL_TEXTURE_2D, GL_TEXTURE_MAX_ANISOTROPY_EXT, 16);
    for (int k = 0; k < count; ++k)
      glTexImage2D(GL_TEXTURE_2D, k, srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, levels[k].width, levels[k].height, 0, GL_RGBA, GL_UNSIGNED_BYTE, levels[k].rgba);
    return made;
  }

  void draw_plane() const {
    glBegin(GL_POLYGON);
    for (const plane_corner& c : corners_) {
      glTexCoord4d(c.s, c.t, 0, c.q);
      glVertex2d(c.x, c.y);
    }
    glEnd();
  }

  // The picture's part in front of the viewer.
  void set_corners(const task& t) {
    const double* const m = t.matrix;
    const auto corner_at = [&](double x, double y) {
      return plane_corner{x, y, (m[0] * x + m[1] * y + m[2]) / t.levels[0].width, (m[3] * x + m[4] * y + m[5]) / t.levels[0].height, m[6] * x + m[7] * y + m[8]};
    };
    const double w = width_, h = height_;
    const plane_corner all[] = {corner_at(0, 0), corner_at(w, 0), corner_at(w, h), corner_at(0, h)};
    corners_.clear();
    for (int k = 0; k < 4; ++k) {
      const plane_corner &a = all[k], &b = all[(k + 1) % 4];
      if (a.q > 0) corners_.push_back(a);
      if ((a.q > 0) == (b.q > 0)) continue;
      const double along = a.q / (a.q - b.q);
      corners_.push_back(corner_at(a.x + along * (b.x - a.x), a.y + along * (b.y - a.y)));
    }
  }

  OSMesaContext context_;
  std::vector<GLuint> textures_;  // of a model: one a mesh
  std::vector<GLint> firsts_;     // corners of each mesh, and the end
  GLuint buffer_ = 0;             // of a model's corners; 0: a plane is drawn
  GLuint codes_[2] = {};  // framebuffer and renderbuffer of sRGB codes
  std::vector<uint32_t> pixels_;
  int width_ = 0, height_ = 0;
  std::vector<plane_corner> corners_;
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
