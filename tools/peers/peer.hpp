// SPDX-License-Identifier: Apache-2.0
// What others draw the same picture with, behind one small interface. A peer is one file here, built to build/peers/NAME.so where its library
// is installed, and loaded by `spantex bench` alone: nothing else sees the library's headers or links it.
//
// All of them: one thread, the same texels, the same plane, RGBA8888, coordinates as PRODUCT's command has them (pixel (i, j) and texel (k, l)
// have their centres half a unit further; rows from the top; the map repeats). prepare() may do whatever needs doing once a map and plane,
// draw() is what is timed: coefficients and prepared map in, pixels in memory out.
#pragma once
#include <stdint.h>

#include <initializer_list>

namespace spantex::peers {

enum class sampling : uint8_t { nearest, bilinear, mip_bilinear, trilinear, aniso16 };  // the first two: level 0 alone

struct level {
  const uint8_t* rgba;  // rows from the top; read by prepare() alone
  int width, height;
};

struct task {
  const level* levels;
  int level_count;     // each at max(1, floor(side / 2)) of the one before, down to 1x1
  double matrix[9];    // u = (a x + b y + c)/(g x + h y + i), v = (d x + e y + f)/(...), texels; what has no positive divisor is behind the viewer and stays opaque black
  int width, height;   // of the picture
  sampling kind;
  bool srgb;           // r, g, b are sRGB codes: decoded before they are filtered, encoded where they are written
};

// Whether all of the picture is in front of the viewer.
inline bool is_in_front(const task& t) {
  const double* const m = t.matrix;
  for (const int x : {0, t.width})
    for (const int y : {0, t.height})
      if (!(m[6] * x + m[7] * y + m[8] > 0)) return false;
  return true;
}

// Triangles in space, three corners each, as OpenGL has them.
struct corner { float x, y, z, s, t; };  // s, t: of the map's width and height
enum class wrapping : uint8_t { repeat, clamp, mirror };

struct mesh {
  const corner* corners;
  int corner_count;
  const level* levels;
  int level_count;
  wrapping wrap_s, wrap_t;
};

struct model_task {
  const mesh* meshes;  // their corners are read by prepare() alone
  int mesh_count;
  int width, height;   // of the picture
  sampling kind;
};

class peer {
 public:
  virtual ~peer() = default;
  virtual const char* name() const = 0;
  virtual const char* version() const = 0;
  virtual bool prepare(const task& t) = 0;          // false: not this sampling, not these colours, or not this plane
  virtual bool prepare(const model_task&) { return false; }
  virtual void begin_frame(const double*) {}        // of a model: clears the picture, opaque black; 16 numbers from space to clip coordinates, column by column
  virtual void draw() = 0;                          // of the task prepared last
  virtual void read(uint8_t* rgba) const = 0;       // the picture that draw() left in memory, rows from the top
};

}  // namespace spantex::peers

// The one symbol of a peer's shared object: a new peer, null where it cannot run here.
extern "C" spantex::peers::peer* spantex_make_peer();
