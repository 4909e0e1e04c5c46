#define _GNU_SOURCE /* clock_gettime and ftruncate, which C17 alone does not show */
#include "vista/shared_frames.h"

#include <fcntl.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "common/clock.h"
#include "common/frame.h"

#define NAME_BYTES 64
#define ALIGNMENT 64

_Static_assert(sizeof(vista_shared_head) == 64, "the head has the size that readers know");
_Static_assert(sizeof(vista_shared_frame) <= VISTA_SHARED_PIXELS, "the images begin behind it");

static const char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";

vista_status vista_shared_frames_create(vista_shared_frames *ring, const char *name, int32_t width_px,
                                        int32_t height_px) {
  if (ring == NULL || name == NULL) return VISTA_ERROR_ARGUMENT;
  *ring = (vista_shared_frames){0};
  const size_t length = strlen(name);
  if (length == 0 || length > NAME_BYTES || strspn(name, alphabet) != length || name[0] == '.')
    return VISTA_ERROR_RANGE;
  if (width_px < VISTA_LEAST_IMAGE_PX || width_px > VISTA_MOST_IMAGE_PX || height_px < VISTA_LEAST_IMAGE_PX ||
      height_px > VISTA_MOST_IMAGE_PX)
    return VISTA_ERROR_SIZE;
  const size_t slot = VISTA_SHARED_PIXELS + 2 * (size_t)width_px * (size_t)height_px;
  const size_t slot_bytes = (slot + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
  ring->width_px = width_px;
  ring->height_px = height_px;
  ring->slot_bytes = slot_bytes;
  ring->bytes = sizeof(vista_shared_head) + VISTA_SHARED_SLOTS * slot_bytes;
  (void)snprintf(ring->path, sizeof ring->path, "/dev/shm/%s", name);
  (void)unlink(ring->path); /* readers of an older one see that it is another file */
  const int file = open(ring->path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) return VISTA_ERROR_SHARED;
  void *const memory = ftruncate(file, (off_t)ring->bytes) == 0
                           ? mmap(NULL, ring->bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0)
                           : MAP_FAILED;
  (void)close(file);
  if (memory == MAP_FAILED) return (void)unlink(ring->path), VISTA_ERROR_SHARED;
  ring->memory = memory;
  vista_shared_head head = {.version = VISTA_SHARED_VERSION,
                            .width_px = (uint32_t)width_px,
                            .height_px = (uint32_t)height_px,
                            .slot_bytes = (uint32_t)slot_bytes};
  memcpy(ring->memory, &head, sizeof head);
  atomic_thread_fence(memory_order_seq_cst);
  memcpy(ring->memory, "VISTASHM", sizeof head.magic); /* last: a reader that sees it sees all of the head */
  return VISTA_OK;
}

static void set_number(unsigned char *at, uint32_t number) {
  atomic_store_explicit((_Atomic uint32_t *)(void *)at, number, memory_order_seq_cst);
}

static void copy(const vista_image *image, unsigned char *to) {
  for (int32_t v = 0; v < image->height_px; ++v)
    memcpy(to + (size_t)v * (size_t)image->width_px, image->data + v * image->stride, (size_t)image->width_px);
}

vista_status vista_shared_frames_put(vista_shared_frames *ring, const vista_shared_frame *about,
                                     const vista_image *left, const vista_image *right) {
  if (ring == NULL || ring->memory == NULL || about == NULL || left == NULL || right == NULL)
    return VISTA_ERROR_ARGUMENT;
  /* What lies in the shared memory is not read again: any program may have written there. */
  const int32_t width = ring->width_px, height = ring->height_px;
  vista_status status = vista_frame_check_image(left, width, height);
  if (status == VISTA_OK) status = vista_frame_check_image(right, width, height);
  if (status != VISTA_OK) return status;
  if (++ring->number == 0) ring->number = 1;
  unsigned char *const slot =
      ring->memory + sizeof(vista_shared_head) + ring->number % VISTA_SHARED_SLOTS * ring->slot_bytes;
  set_number(slot + offsetof(vista_shared_frame, number), 0);
  atomic_thread_fence(memory_order_seq_cst);
  vista_shared_frame told = *about;
  told.number = 0;
  if (told.exposed_ns == 0) told.exposed_ns = (int64_t)(1e6 * vista_clock_ms());
  memcpy(slot, &told, sizeof told);
  copy(left, slot + VISTA_SHARED_PIXELS);
  copy(right, slot + VISTA_SHARED_PIXELS + (size_t)width * (size_t)height);
  set_number(slot + offsetof(vista_shared_frame, number), ring->number);
  set_number(ring->memory + offsetof(vista_shared_head, newest), ring->number);
  return VISTA_OK;
}

void vista_shared_frames_destroy(vista_shared_frames *ring) {
  if (ring == NULL || ring->memory == NULL) return;
  (void)munmap(ring->memory, ring->bytes);
  (void)unlink(ring->path);
  *ring = (vista_shared_frames){0};
}
