/* Preloaded before a program: files named fake-video* become cameras of V4L2, as far as vista-fly calls them.
 *
 * Such a file holds pictures of $FAKE_BYTES each, and the camera delivers them one after the other, again and again, at
 * $FAKE_HZ. $FAKE_FORMAT: its pixel format, $FAKE_WIDTH and $FAKE_HEIGHT: the only size that it has, $FAKE_STRIDE: bytes
 * a row. With $FAKE_SLOW_HZ it offers MJPG besides, at $FAKE_HZ, and its other format at this rate. While the
 * file FILE.gone exists, the camera is unplugged; with FILE.mute it delivers nothing. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

enum { MOST = 64, BUFFERS = 4 };

static struct camera {
  int used, pictures, queued[BUFFERS], queue_length;
  char path[256];
  int64_t due_ns, count;
} cameras[MOST]; /* by the number of the file */

static long number(const char *name) { return getenv(name) != NULL ? atol(getenv(name)) : 0; }

/* Of a buffer: whole pages. */
static long slot_bytes(void) { return (number("FAKE_BYTES") + 4095) / 4096 * 4096; }

static int64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static int is(const struct camera *c, const char *suffix) {
  char path[300];
  snprintf(path, sizeof path, "%s%s", c->path, suffix);
  return access(path, F_OK) == 0;
}

static int real_open(const char *path, int flags, mode_t mode) {
  static int (*real)(const char *, int, ...);
  if (real == NULL) *(void **)&real = dlsym(RTLD_NEXT, "open");
  return real(path, flags, mode);
}

/* A file of memory in place of the camera: what the program maps of it are the buffers. */
int open(const char *path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = flags & O_CREAT ? va_arg(list, mode_t) : 0;
  va_end(list);
  if (strstr(path, "fake-video") == NULL) return real_open(path, flags, mode);
  struct camera fresh = {.used = 1};
  snprintf(fresh.path, sizeof fresh.path, "%s", path);
  if (is(&fresh, ".gone")) return errno = ENODEV, -1;
  fresh.pictures = real_open(path, O_RDONLY | O_CLOEXEC, 0);
  if (fresh.pictures < 0) return -1;
  const int file = memfd_create("camera", MFD_CLOEXEC);
  if (file < 0 || file >= MOST || ftruncate(file, BUFFERS * slot_bytes()) != 0) abort();
  cameras[file] = fresh;
  return file;
}

int close(int file) {
  static int (*real)(int);
  if (real == NULL) *(void **)&real = dlsym(RTLD_NEXT, "close");
  if (file >= 0 && file < MOST && cameras[file].used) {
    cameras[file].used = 0;
    real(cameras[file].pictures);
  }
  return real(file);
}

static int dequeue(int file, struct v4l2_buffer *buffer) {
  struct camera *const c = &cameras[file];
  static char picture[1 << 23];
  const long bytes = number("FAKE_BYTES");
  const int64_t period_ns = 1000000000 / (number("FAKE_HZ") > 0 ? number("FAKE_HZ") : 30);
  if (is(c, ".gone")) return errno = ENODEV, -1;
  if (is(c, ".mute") || c->queue_length == 0 || now_ns() < c->due_ns) {
    usleep(1000); /* a file of memory is always ready to be read, as poll sees it */
    return errno = EAGAIN, -1;
  }
  const int index = c->queued[0];
  memmove(c->queued, c->queued + 1, sizeof c->queued - sizeof c->queued[0]);
  --c->queue_length;
  const off_t end = lseek(c->pictures, 0, SEEK_END);
  if (pread(c->pictures, picture, (size_t)bytes, c->count * bytes % end) != bytes) abort();
  if (pwrite(file, picture, (size_t)bytes, index * slot_bytes()) != bytes) abort();
  *buffer = (struct v4l2_buffer){.index = (uint32_t)index,
                                 .type = V4L2_BUF_TYPE_VIDEO_CAPTURE,
                                 .memory = V4L2_MEMORY_MMAP,
                                 .bytesused = (uint32_t)bytes,
                                 .flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC,
                                 .timestamp = {c->due_ns / 1000000000, c->due_ns % 1000000000 / 1000}};
  ++c->count;
  c->due_ns += period_ns;
  return 0;
}

/* Cameras of one run expose at the same moments. */
static int64_t next_tick(void) {
  const int64_t step_ns = 500000000;
  return (now_ns() / step_ns + 1) * step_ns;
}

int ioctl(int file, unsigned long request, ...) {
  va_list list;
  va_start(list, request);
  void *const argument = va_arg(list, void *);
  va_end(list);
  if (file < 0 || file >= MOST || !cameras[file].used) {
    static int (*real)(int, unsigned long, ...);
    if (real == NULL) *(void **)&real = dlsym(RTLD_NEXT, "ioctl");
    return real(file, request, argument);
  }
  struct camera *const c = &cameras[file];
  const char *const format = getenv("FAKE_FORMAT");
  const uint32_t fourcc = v4l2_fourcc(format[0], format[1], format[2], format[3]);
  const long bytes = number("FAKE_BYTES");
  switch (request) {
    case VIDIOC_QUERYCAP:
      ((struct v4l2_capability *)argument)->capabilities = (uint32_t)number("FAKE_CAPABILITIES");
      return 0;
    case VIDIOC_ENUM_FMT: {
      struct v4l2_fmtdesc *const d = argument;
      const uint32_t offered[] = {fourcc, V4L2_PIX_FMT_MJPEG};
      if (d->index > (number("FAKE_SLOW_HZ") > 0)) return errno = EINVAL, -1;
      d->pixelformat = offered[d->index];
      return 0;
    }
    case VIDIOC_ENUM_FRAMEINTERVALS: {
      struct v4l2_frmivalenum *const f = argument;
      const long slow_hz = number("FAKE_SLOW_HZ");
      if (slow_hz == 0 || f->index > 0) return errno = EINVAL, -1;
      f->type = V4L2_FRMIVAL_TYPE_DISCRETE;
      f->discrete.numerator = 1;
      f->discrete.denominator = (uint32_t)(f->pixel_format == V4L2_PIX_FMT_MJPEG ? number("FAKE_HZ") : slow_hz);
      return 0;
    }
    case VIDIOC_S_FMT: {
      struct v4l2_pix_format *const pix = &((struct v4l2_format *)argument)->fmt.pix;
      pix->width = (uint32_t)number("FAKE_WIDTH");
      pix->height = (uint32_t)number("FAKE_HEIGHT");
      pix->bytesperline = (uint32_t)number("FAKE_STRIDE");
      return 0;
    }
    case VIDIOC_REQBUFS:
      ((struct v4l2_requestbuffers *)argument)->count = BUFFERS;
      return 0;
    case VIDIOC_QUERYBUF: {
      struct v4l2_buffer *const b = argument;
      b->length = (uint32_t)bytes;
      b->m.offset = (uint32_t)(b->index * slot_bytes());
      return 0;
    }
    case VIDIOC_QBUF:
      c->queued[c->queue_length++] = (int)((struct v4l2_buffer *)argument)->index;
      return 0;
    case VIDIOC_STREAMON:
      c->due_ns = next_tick();
      return 0;
    case VIDIOC_DQBUF:
      return dequeue(file, argument);
    default:
      return errno = EINVAL, -1;
  }
}
