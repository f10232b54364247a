/* SPDX-License-Identifier: Apache-2.0
 * drawing_to_file OUT: what firmware/apps/drawing.c draws, as RGB565 numbers, little-endian. */
#include <stdio.h>

#include <spantex/spantex.h>

spantex_status draw_scene(uint16_t *frame);

static uint16_t frame[320 * 240];

int main(int count, char **arguments) {
  const spantex_status status = draw_scene(frame);
  FILE *const out = count == 2 ? fopen(arguments[1], "wb") : NULL;
  if (status != SPANTEX_OK || out == NULL) {
    fprintf(stderr, "drawing_to_file OUT: %s\n", out == NULL ? "no file to write" : spantex_status_string(status));
    return 2;
  }
  for (size_t k = 0; k < sizeof frame / sizeof *frame; ++k) {
    fputc(frame[k] & 255, out);
    fputc(frame[k] >> 8, out);
  }
  return fclose(out) == 0 ? 0 : 2;
}
