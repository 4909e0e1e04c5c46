#include "device.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "clock.h"
#include "jpeg.h"

#define OLDEST_NS (10 * FLY_SECOND) /* a time further back is none of this clock */

#define MOST_INTERVALS 64

/* Those that cost least come first. Planes of colour lie behind the luma. */
static const device_layout layouts[] = {
    {V4L2_PIX_FMT_Y8I, 2, 0, true},   {V4L2_PIX_FMT_GREY, 1, 0, false},   {V4L2_PIX_FMT_NV12, 1, 0, false},
    {V4L2_PIX_FMT_NV21, 1, 0, false}, {V4L2_PIX_FMT_YUV420, 1, 0, false}, {V4L2_PIX_FMT_YVU420, 1, 0, false},
    {V4L2_PIX_FMT_YUYV, 2, 0, false}, {V4L2_PIX_FMT_UYVY, 2, 1, false},   {V4L2_PIX_FMT_MJPEG, 0, 0, false},
};

static int control(int file, unsigned long request, void *argument) {
  int result;
  do result = ioctl(file, request, argument);
  while (result < 0 && errno == EINTR);
  return result;
}

static bool offers(int file, uint32_t pixel_format) {
  struct v4l2_fmtdesc format = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
  for (; control(file, VIDIOC_ENUM_FMT, &format) == 0; ++format.index)
    if (format.pixelformat == pixel_format) return true;
  return false;
}

static int32_t layout_width(const device *d, const device_layout *layout) {
  return d->width_px * (d->both && !layout->interleaved ? 2 : 1);
}

/* The width of its picture. */
static int32_t picture_width(const device *d) { return layout_width(d, d->layout); }

/* The highest rate at which a layout comes in pictures of our size; 0 where the driver does not say. */
static double highest_rate_hz(const device *d, const device_layout *layout) {
  struct v4l2_frmivalenum interval = {.pixel_format = layout->pixel_format,
                                      .width = (uint32_t)layout_width(d, layout),
                                      .height = (uint32_t)d->height_px};
  double highest_hz = 0.0;
  for (; interval.index < MOST_INTERVALS && control(d->file, VIDIOC_ENUM_FRAMEINTERVALS, &interval) == 0;
       ++interval.index) {
    const bool discrete = interval.type == V4L2_FRMIVAL_TYPE_DISCRETE;
    const struct v4l2_fract shortest = discrete ? interval.discrete : interval.stepwise.min;
    if (shortest.numerator > 0 && shortest.denominator > highest_hz * shortest.numerator)
      highest_hz = (double)shortest.denominator / shortest.numerator;
    if (!discrete) break; /* one answer tells all */
  }
  return highest_hz;
}

static bool can_take(const device *d, const device_layout *layout) {
  return (d->both || !layout->interleaved) && (layout->step > 0 || d->scratch != NULL) &&
         offers(d->file, layout->pixel_format);
}

/* Cameras on USB often have their full rate in compressed pictures alone. */
static bool choose_layout(device *d, problem *p) {
  double best_hz = 0.0;
  d->layout = NULL;
  for (size_t k = 0; k < sizeof layouts / sizeof layouts[0]; ++k) {
    if (!can_take(d, &layouts[k])) continue;
    const double rate_hz = highest_rate_hz(d, &layouts[k]);
    if (d->layout != NULL && rate_hz <= best_hz) continue;
    d->layout = &layouts[k];
    best_hz = rate_hz;
  }
  return d->layout != NULL || problem_say(p, d->name, "offers neither GREY, Y8I, NV12, NV21, YU12, YV12, YUYV, UYVY%s",
                                          d->scratch != NULL ? " nor MJPG" : "; this vista-fly cannot read MJPG");
}

static bool set_format(device *d, problem *p) {
  struct v4l2_format format = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
  struct v4l2_pix_format *const pix = &format.fmt.pix;
  pix->width = (uint32_t)picture_width(d);
  pix->height = (uint32_t)d->height_px;
  pix->pixelformat = d->layout->pixel_format;
  pix->field = V4L2_FIELD_NONE;
  if (control(d->file, VIDIOC_S_FMT, &format) != 0) return problem_errno(p, d->name, errno);
  if (pix->width != (uint32_t)picture_width(d) || pix->height != (uint32_t)d->height_px)
    return problem_say(p, d->name, "delivers %ux%u px, the rig needs %dx%d", pix->width, pix->height, picture_width(d),
                       d->height_px);
  if (pix->pixelformat != d->layout->pixel_format) return problem_say(p, d->name, "does not keep to its formats");
  const size_t least = (size_t)picture_width(d) * (size_t)d->layout->step;
  d->row_bytes = d->layout->step > 0 && pix->bytesperline > least ? pix->bytesperline : least;
  return true;
}

static bool map_buffers(device *d, problem *p) {
  struct v4l2_requestbuffers request = {
      .count = DEVICE_BUFFERS, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .memory = V4L2_MEMORY_MMAP};
  if (control(d->file, VIDIOC_REQBUFS, &request) != 0) return problem_errno(p, d->name, errno);
  const int count = request.count < DEVICE_BUFFERS ? (int)request.count : DEVICE_BUFFERS;
  if (count < 2) return problem_say(p, d->name, "gives no buffers to stream into");
  const size_t needed = d->row_bytes * (size_t)(d->height_px - 1) + (size_t)picture_width(d) * (size_t)d->layout->step;
  for (d->buffer_count = 0; d->buffer_count < count; ++d->buffer_count) {
    struct v4l2_buffer buffer = {
        .index = (uint32_t)d->buffer_count, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .memory = V4L2_MEMORY_MMAP};
    if (control(d->file, VIDIOC_QUERYBUF, &buffer) != 0) return problem_errno(p, d->name, errno);
    if (buffer.length < needed) return problem_say(p, d->name, "has buffers that hold no picture");
    void *const start = mmap(NULL, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, d->file, (off_t)buffer.m.offset);
    if (start == MAP_FAILED) return problem_errno(p, d->name, errno);
    d->buffers[d->buffer_count].start = start;
    d->buffers[d->buffer_count].bytes = buffer.length;
    if (control(d->file, VIDIOC_QBUF, &buffer) != 0) return ++d->buffer_count, problem_errno(p, d->name, errno);
  }
  return true;
}

static bool set_up(device *d, problem *p) {
  struct v4l2_capability capability = {0};
  if (control(d->file, VIDIOC_QUERYCAP, &capability) != 0) return problem_say(p, d->name, "no camera of V4L2");
  const uint32_t can =
      capability.capabilities & V4L2_CAP_DEVICE_CAPS ? capability.device_caps : capability.capabilities;
  if (!(can & V4L2_CAP_VIDEO_CAPTURE) || !(can & V4L2_CAP_STREAMING))
    return problem_say(p, d->name, "is no camera that streams");
  if (!choose_layout(d, p) || !set_format(d, p) || !map_buffers(d, p)) return false;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  return control(d->file, VIDIOC_STREAMON, &type) == 0 || problem_errno(p, d->name, errno);
}

bool device_open(device *d, problem *p) {
  d->buffer_count = 0;
  d->file = open(d->name, O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (d->file < 0) return problem_errno(p, d->name, errno);
  if (set_up(d, p)) return true;
  device_close(d);
  return false;
}

/* ---- pictures ---- */

static void copy_view(const device *d, const unsigned char *picture, size_t first, size_t step, uint8_t *to) {
  for (int32_t v = 0; v < d->height_px; ++v, to += d->width_px) {
    const unsigned char *from = picture + (size_t)v * d->row_bytes + first;
    if (step == 1) {
      memcpy(to, from, (size_t)d->width_px);
      continue;
    }
    for (int32_t u = 0; u < d->width_px; ++u, from += step) to[u] = *from;
  }
}

/* Returns whether there was a whole picture in the buffer. */
static bool take_picture(const device *d, const struct v4l2_buffer *buffer, uint8_t *left, uint8_t *right) {
  const unsigned char *const picture = d->buffers[buffer->index].start;
  if (d->layout->step == 0)
    return buffer->bytesused <= d->buffers[buffer->index].bytes &&
           jpeg_decode(picture, buffer->bytesused, picture_width(d), d->height_px, d->both ? 2 : 1, d->scratch,
                       d->scratch_bytes, left, right);
  const size_t step = (size_t)d->layout->step, first = (size_t)d->layout->first;
  copy_view(d, picture, first, step, left);
  if (right != NULL)
    copy_view(d, picture, d->layout->interleaved ? 1 : first + step * (size_t)d->width_px, step, right);
  return true;
}

static int64_t time_of(const struct v4l2_buffer *buffer) {
  const int64_t now_ns = fly_now_ns();
  const int64_t stamp_ns = (int64_t)buffer->timestamp.tv_sec * FLY_SECOND + (int64_t)buffer->timestamp.tv_usec * 1000;
  const bool monotonic = (buffer->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  return monotonic && stamp_ns <= now_ns && stamp_ns >= now_ns - OLDEST_NS ? stamp_ns : now_ns;
}

/* The newest buffer that is filled; the others go back to the driver. */
static device_news newest(device *d, struct v4l2_buffer *buffer, int64_t *older) {
  device_news news = DEVICE_NOTHING;
  for (int k = 0; k < DEVICE_BUFFERS; ++k) {
    struct v4l2_buffer next = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE, .memory = V4L2_MEMORY_MMAP};
    if (control(d->file, VIDIOC_DQBUF, &next) != 0) return errno == EAGAIN ? news : DEVICE_LOST;
    if (next.index >= (uint32_t)d->buffer_count) return DEVICE_LOST;
    const bool damaged = (next.flags & V4L2_BUF_FLAG_ERROR) != 0;
    if (news == DEVICE_PICTURE || damaged) {
      ++*older;
      if (control(d->file, VIDIOC_QBUF, damaged ? &next : buffer) != 0) return DEVICE_LOST;
    }
    if (damaged) continue;
    *buffer = next;
    news = DEVICE_PICTURE;
  }
  return news;
}

device_news device_take(device *d, uint8_t *left, uint8_t *right, int64_t *taken_ns, int64_t *older) {
  struct v4l2_buffer buffer;
  const device_news news = newest(d, &buffer, older);
  if (news != DEVICE_PICTURE) return news;
  const int64_t stamp_ns = time_of(&buffer);
  const bool whole = take_picture(d, &buffer, left, right);
  if (whole) *taken_ns = stamp_ns;
  *older += !whole;
  if (control(d->file, VIDIOC_QBUF, &buffer) != 0) return DEVICE_LOST;
  return whole ? DEVICE_PICTURE : DEVICE_DAMAGED;
}

void device_close(device *d) {
  for (int k = 0; k < d->buffer_count; ++k) (void)munmap(d->buffers[k].start, d->buffers[k].bytes);
  d->buffer_count = 0;
  if (d->file >= 0) (void)close(d->file);
  d->file = -1;
}
