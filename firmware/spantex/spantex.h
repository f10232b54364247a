/* SPDX-License-Identifier: Apache-2.0
 *
 * spantex from C99: textured pictures from RGB565 maps into the frame buffers that displays have, by rows (docs/DRAWING.md). Integers only, no heap, no state
 * of its own: everything lives in memory that the caller gives. The pixels are those of the C++ calls (spantex/rows/pictures.hpp), bit for bit. Compile
 * spantex_c.cpp with the program, as C++20; nothing else of C++ is needed, no library either.
 *
 *   screen positions   1/256 pixel, origin top left, y down; pixel (i, j) has its centre at (i + 1/2, j + 1/2); below 2^28
 *   map positions      s15.16 texels of level 0; (0, 0) is the outer corner of the first texel; up to 2^30
 *   angles             0.1 degree, clockwise on the screen
 *   errors             every call tells; a call that fails before drawing has drawn nothing
 *
 * A spantex_map, spantex_target or spantex_state is opaque; it may be copied, and lie anywhere at a multiple of 8 bytes. One that is all zeros is refused.
 */
#ifndef SPANTEX_H
#define SPANTEX_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* --- errors ------------------------------------------------------------------------------------------------- */

/* The numbers of spantex::status. */
typedef enum spantex_status {
  SPANTEX_OK,
  SPANTEX_BAD_SIZE,           /* a width, height or count outside the supported range */
  SPANTEX_BAD_POINTER,        /* null, or an object that was never set up */
  SPANTEX_BAD_ALIGNMENT,      /* memory at an address, or a tile at a column, that its format does not allow */
  SPANTEX_OUT_OF_MEMORY,
  SPANTEX_BAD_LEVELS,         /* levels of a size that the filter cannot use */
  SPANTEX_OUT_OF_RANGE,       /* a number outside its documented range */
  SPANTEX_DEGENERATE,         /* nothing to draw: no area, edge-on, outside the screen */
  SPANTEX_HALF_BUSY, SPANTEX_HALF_NOT_LOADED, SPANTEX_HALF_NOT_STARTED, SPANTEX_BAD_ADDRESS, SPANTEX_DEVICE_ERROR, SPANTEX_DEVICE_TIMEOUT, SPANTEX_MISMATCH,
  SPANTEX_PACK_MISALIGNED, SPANTEX_PACK_TRUNCATED, SPANTEX_PACK_NOT_A_PACK, SPANTEX_PACK_BAD_VERSION, SPANTEX_PACK_BAD_HEADER, SPANTEX_PACK_BAD_FIELD,
  SPANTEX_PACK_BAD_LAYOUT, SPANTEX_PACK_BYTE_ORDER, SPANTEX_PACK_BAD_PAYLOAD
} spantex_status;

/* English, without a full stop; never null. */
const char *spantex_status_string(spantex_status status);

/* --- memory ------------------------------------------------------------------------------------------------- */

#define SPANTEX_ALIGNMENT 8
#if UINTPTR_MAX > 0xFFFFFFFFu
#define SPANTEX_MAP_BYTES 256
#define SPANTEX_TARGET_BYTES 144
#define SPANTEX_STATE_BYTES 1376
#else
#define SPANTEX_MAP_BYTES 192
#define SPANTEX_TARGET_BYTES 136
#define SPANTEX_STATE_BYTES 2104
#endif

typedef union spantex_map { unsigned char bytes[SPANTEX_MAP_BYTES]; uint64_t alignment; } spantex_map;
typedef union spantex_target { unsigned char bytes[SPANTEX_TARGET_BYTES]; uint64_t alignment; } spantex_target;
typedef union spantex_state { unsigned char bytes[SPANTEX_STATE_BYTES]; uint64_t alignment; } spantex_state; /* what a call works in; needs no set-up */

/* --- maps --------------------------------------------------------------------------------------------------- */

typedef enum spantex_wrap { SPANTEX_REPEAT, SPANTEX_CLAMP, SPANTEX_MIRROR } spantex_wrap;

/* A map of RGB565 numbers: levels[0] has width x height of them (sides 1 to 4096), levels[k] half of that k times, rounded down, at least 1. They stay the
 * caller's. Errors: BAD_POINTER, BAD_SIZE, BAD_LEVELS, OUT_OF_RANGE (wrap). */
spantex_status spantex_map_init(spantex_map *map, const uint16_t *const *levels, int level_count, int32_t width, int32_t height, spantex_wrap wrap_u,
                                spantex_wrap wrap_v);

/* A compiled map (`spantex texture --format rgb565`), used where it lies. check_payload: read all of it once, against its checksum. Errors: BAD_POINTER,
 * OUT_OF_RANGE (not RGB565), PACK_..., BAD_SIZE, BAD_LEVELS. */
spantex_status spantex_map_open(spantex_map *map, const void *pack, size_t bytes, int check_payload);

/* --- targets ------------------------------------------------------------------------------------------------ */

/* Layouts: spantex/pixels.hpp. */
typedef enum spantex_format {
  SPANTEX_RGB565, SPANTEX_RGB565_SWAPPED, SPANTEX_RGB888, SPANTEX_BGR888, SPANTEX_RGBA8888, SPANTEX_BGRA8888, SPANTEX_GREY8, SPANTEX_GREY4, SPANTEX_MONO1,
  SPANTEX_MONO1_PAGES
} spantex_format;

typedef struct spantex_rectangle { int32_t x0, y0, x1, y1; } spantex_rectangle; /* pixels, x1 and y1 not included */

/* Memory that holds the part `held` of the screen: all of it, a strip, a tile. Errors: BAD_POINTER, BAD_SIZE, BAD_ALIGNMENT, OUT_OF_RANGE. */
spantex_status spantex_target_init(spantex_target *target, spantex_format format, void *pixels, int32_t stride_bytes, spantex_rectangle held);

/* Errors of these: BAD_POINTER. */
spantex_status spantex_target_screen(spantex_target *target, spantex_rectangle screen);     /* the screen that it is part of; `held` if not set */
spantex_status spantex_target_clip(spantex_target *target, spantex_rectangle clip);         /* writes within it only, until set again */
spantex_status spantex_target_blend(spantex_target *target, uint8_t alpha, int32_t key);    /* constant alpha, 255 stores; RGB565 left out, -1 for none */
spantex_status spantex_target_fill(const spantex_target *target, uint16_t rgb565);

/* --- drawing ------------------------------------------------------------------------------------------------ */

typedef enum spantex_filter {
  SPANTEX_NEAREST, SPANTEX_BILINEAR, SPANTEX_THREE_POINT, /* level 0 */
  SPANTEX_MIP_BILINEAR, SPANTEX_TRILINEAR                 /* maps whose sides halve exactly, or are 1 */
} spantex_filter;

typedef struct spantex_point { int32_t x, y; } spantex_point;             /* 1/256 pixel */
typedef struct spantex_texel_point { int32_t u, v; } spantex_texel_point; /* s15.16 */

/* All: BAD_POINTER, OUT_OF_RANGE (filter, or one that was left out of the build), BAD_LEVELS, BAD_SIZE (a screen that is empty or too large); and as listed. */

/* u = (a x + b y + c)/(g x + h y + i), v = (d x + e y + f)/(...), x and y in pixels, u and v in texels; in front where the divisor is positive. Errors:
 * DEGENERATE. */
typedef struct spantex_matrix { int64_t a, b, c, d, e, f, g, h, i; } spantex_matrix;
spantex_status spantex_draw_plane(spantex_state *state, const spantex_target *target, const spantex_map *map, spantex_filter filter, const spantex_matrix *matrix,
                                  spantex_rectangle area);

/* Four corners, convex, from that of the map's first texel clockwise; map_corners: four positions of their own, or null. Errors: DEGENERATE, OUT_OF_RANGE. */
spantex_status spantex_draw_quad(spantex_state *state, const spantex_target *target, const spantex_map *map, spantex_filter filter, const spantex_point *corners,
                                 const spantex_texel_point *map_corners);

/* A picture turned about its pivot and scaled. Errors: DEGENERATE, OUT_OF_RANGE. */
typedef struct spantex_sprite {
  spantex_point at;          /* where the pivot lies on the screen */
  spantex_texel_point pivot;
  int32_t scale_x, scale_y;  /* s15.16 pixels a texel; negative: mirrored. LVGL's 256 is 65536 */
  int32_t angle;
} spantex_sprite;
spantex_status spantex_draw_sprite(spantex_state *state, const spantex_target *target, const spantex_map *map, spantex_filter filter, const spantex_sprite *sprite);

/* Triangles on the screen: w is a corner's depth in any unit, from 1, all alike for affine ones. indices: three a triangle, or null: vertices by threes. back_faces
 * 0: those that run counter-clockwise are left out. Errors: OUT_OF_RANGE (an index, w, a position), BAD_SIZE. */
typedef struct spantex_screen_vertex { spantex_point at; spantex_texel_point map; uint32_t w; } spantex_screen_vertex;
spantex_status spantex_draw_triangles(spantex_state *state, const spantex_target *target, const spantex_map *map, spantex_filter filter,
                                      const spantex_screen_vertex *vertices, int32_t vertex_count, const uint16_t *indices, int32_t triangle_count, int back_faces);

/* The same in camera space, z forward, s15.16 throughout: screen = focal (x, y)/z + centre, clipped where z < near_z. */
typedef struct spantex_vertex { int32_t x, y, z; int32_t u, v; } spantex_vertex;
typedef struct spantex_projection { int32_t focal_x, focal_y, centre_x, centre_y, near_z; } spantex_projection;
spantex_status spantex_draw_mesh(spantex_state *state, const spantex_target *target, const spantex_map *map, spantex_filter filter, const spantex_projection *camera,
                                 const spantex_vertex *vertices, int32_t vertex_count, const uint16_t *indices, int32_t triangle_count, int back_faces);

/* Heading turns right, pitch up, roll lowers the right side; focal and centre s15.16 pixels: of a level camera centre_y is the horizon. */
typedef struct spantex_camera { int32_t heading, pitch, roll, focal, centre_x, centre_y; } spantex_camera;

/* Mode 7: a level map below the camera, or above it where height is negative. s15.16: where the camera stands, texels per unit of length. Errors: DEGENERATE,
 * OUT_OF_RANGE. */
typedef struct spantex_floor { int32_t x, z, height, texels_per_unit; } spantex_floor;
spantex_status spantex_draw_floor(spantex_state *state, const spantex_target *target, const spantex_map *map, spantex_filter filter, const spantex_camera *camera,
                                  const spantex_floor *floor);

/* A cube around the camera: maps of ahead, right, behind, left, above, below, each as it looks from within; null is left out. Errors: OUT_OF_RANGE. */
spantex_status spantex_draw_cube(spantex_state *state, const spantex_target *target, const spantex_map *const faces[6], spantex_filter filter,
                                 const spantex_camera *camera);

/* --- displays without a frame buffer ------------------------------------------------------------------------ */

/* start: begin to send the window's pixels, row by row, and return. wait: return when that buffer (0 or 1) has been sent. */
typedef struct spantex_display {
  void (*start)(void *user, spantex_rectangle window, const uint8_t *bytes, uint32_t count, int buffer);
  void (*wait)(void *user, int buffer);
  void *user;
} spantex_display;

/* Calls draw once a tile, which draws everything into `target`; a tile is sent while the next is drawn. Buffers of `bytes` bytes each. Errors: BAD_SIZE (screen, or
 * a tile larger than a buffer), BAD_POINTER, BAD_ALIGNMENT, OUT_OF_RANGE, what `draw` returns. */
typedef spantex_status (*spantex_draw_tile)(void *user, spantex_target *target);
spantex_status spantex_draw_tiles(const spantex_display *display, spantex_format format, spantex_rectangle screen, int32_t tile_width, int32_t tile_height,
                                  void *buffer0, void *buffer1, uint32_t bytes, spantex_draw_tile draw, void *user);

#ifdef __cplusplus
}
#endif

#endif
