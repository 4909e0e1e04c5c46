/* One camera of V4L2, streaming into memory that its driver shares. Only the luma is taken. */
#ifndef VISTA_FLY_DEVICE_H
#define VISTA_FLY_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "problem.h"

#define DEVICE_BUFFERS 4

/* How the luma of both views, or of one, lies in a picture. */
typedef struct device_layout {
  uint32_t pixel_format; /* of V4L2 */
  int32_t step, first; /* bytes from one pixel of a row to the next, and to the first; 0: it is compressed */
  bool interleaved; /* left and right take turns */
} device_layout;

typedef struct device {
  const char *name; /* such as /dev/video0 */
  int file; /* -1: closed */
  bool both; /* its picture holds both views */
  int32_t width_px, height_px; /* of one view */
  void *scratch; /* to decode compressed pictures in: jpeg_scratch_bytes of the picture; null: none are taken */
  size_t scratch_bytes;
  const device_layout *layout;
  size_t row_bytes; /* 0 of compressed pictures */
  int buffer_count;
  struct {
    unsigned char *start;
    size_t bytes;
  } buffers[DEVICE_BUFFERS];
} device;

/* Opens a device and starts its stream, in the layout that comes at the highest rate; of several, in the one that costs
 * least. name, both, the size and the scratch are set by the caller. */
bool device_open(device *d, problem *p);

/* DAMAGED: what came was no whole picture, and what was in left and right is gone. */
typedef enum device_news { DEVICE_NOTHING = 0, DEVICE_PICTURE, DEVICE_DAMAGED, DEVICE_LOST } device_news;

/* Takes the newest picture that is there, without waiting. left and right: what to write to; right is null of a camera
 * with one view. *taken_ns: when it was taken, on CLOCK_MONOTONIC. *older: pictures that were passed over. */
device_news device_take(device *d, uint8_t *left, uint8_t *right, int64_t *taken_ns, int64_t *older);

void device_close(device *d);

#endif
