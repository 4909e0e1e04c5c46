#include "jpeg.h"

#ifndef VISTA_FLY_HAS_JPEG

size_t jpeg_scratch_bytes(int32_t width_px) {
  (void)width_px;
  return 0;
}

bool jpeg_decode(const unsigned char *data, size_t bytes, int32_t width_px, int32_t height_px, int views, void *scratch,
                 size_t scratch_bytes, uint8_t *left, uint8_t *right) {
  (void)data, (void)bytes, (void)width_px, (void)height_px, (void)views;
  (void)scratch, (void)scratch_bytes, (void)left, (void)right;
  return false;
}

#else

#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include <jerror.h>
#include <jpeglib.h>

#define ALIGNMENT 64
#define TABLES_BYTES ((size_t)1 << 18) /* tables and state of libjpeg, whatever the size of the picture */
#define BYTES_PER_COLUMN 256           /* rows of blocks of all components, as they pass */

typedef struct decoder {
  struct jpeg_decompress_struct jpeg;
  struct jpeg_error_mgr errors;
  jmp_buf failed;
  bool damaged;
  unsigned char *memory;
  size_t used, capacity;
  uint8_t *row;
} decoder;

static size_t padded(size_t bytes) { return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT; }

size_t jpeg_scratch_bytes(int32_t width_px) {
  return padded(sizeof(decoder)) + TABLES_BYTES + BYTES_PER_COLUMN * (size_t)width_px;
}

/* ---- what libjpeg asks of the system: its memory comes from the scratch, and is given back as a whole ---- */

/* These take the place of libjpeg's own ones (jmemnobs.c), which would call malloc for each picture. */
void *jpeg_get_small(j_common_ptr jpeg, size_t bytes);
void jpeg_free_small(j_common_ptr jpeg, void *object, size_t bytes);
void *jpeg_get_large(j_common_ptr jpeg, size_t bytes);
void jpeg_free_large(j_common_ptr jpeg, void *object, size_t bytes);
size_t jpeg_mem_available(j_common_ptr jpeg, size_t least, size_t most, size_t already);
void jpeg_open_backing_store(j_common_ptr jpeg, void *store, long bytes);
long jpeg_mem_init(j_common_ptr jpeg);
void jpeg_mem_term(j_common_ptr jpeg);

void *jpeg_get_small(j_common_ptr jpeg, size_t bytes) {
  decoder *const d = jpeg->client_data;
  if (bytes > d->capacity - d->used) return NULL;
  void *const object = d->memory + d->used;
  d->used += padded(bytes) < d->capacity - d->used ? padded(bytes) : d->capacity - d->used;
  return object;
}

void *jpeg_get_large(j_common_ptr jpeg, size_t bytes) { return jpeg_get_small(jpeg, bytes); }

void jpeg_free_small(j_common_ptr jpeg, void *object, size_t bytes) {
  (void)jpeg;
  (void)object;
  (void)bytes;
}

void jpeg_free_large(j_common_ptr jpeg, void *object, size_t bytes) { jpeg_free_small(jpeg, object, bytes); }

size_t jpeg_mem_available(j_common_ptr jpeg, size_t least, size_t most, size_t already) {
  (void)jpeg;
  (void)least;
  (void)already;
  return most;
}

void jpeg_open_backing_store(j_common_ptr jpeg, void *store, long bytes) {
  (void)store;
  (void)bytes;
  ERREXIT(jpeg, JERR_NO_BACKING_STORE);
}

long jpeg_mem_init(j_common_ptr jpeg) {
  (void)jpeg;
  return 0;
}

void jpeg_mem_term(j_common_ptr jpeg) { (void)jpeg; }

/* ---- decoding ---- */

static void leave(j_common_ptr jpeg) {
  decoder *const d = jpeg->client_data;
  longjmp(d->failed, 1);
}

/* Cameras pad their pictures; anything else that libjpeg warns of means that blocks are wrong or missing. */
static void note(j_common_ptr jpeg, int level) {
  decoder *const d = jpeg->client_data;
  if (level < 0 && jpeg->err->msg_code != JWRN_EXTRANEOUS_DATA) d->damaged = true;
}

static bool decode(decoder *d, const unsigned char *data, size_t bytes, int32_t width_px, int32_t height_px, int views,
                   uint8_t *left, uint8_t *right) {
  struct jpeg_decompress_struct *const jpeg = &d->jpeg;
  const size_t half = (size_t)(width_px / views);
  if (setjmp(d->failed) != 0) return false;
  jpeg_create_decompress(jpeg);
  jpeg_mem_src(jpeg, data, (unsigned long)bytes);
  (void)jpeg_read_header(jpeg, TRUE);
  if (jpeg->image_width != (JDIMENSION)width_px || jpeg->image_height != (JDIMENSION)height_px) return false;
  jpeg->out_color_space = JCS_GRAYSCALE; /* the planes of colour are not decoded further than they have to be */
  (void)jpeg_start_decompress(jpeg);
  d->row = jpeg_get_small((j_common_ptr)jpeg, (size_t)width_px);
  if (d->row == NULL) return false;
  while (jpeg->output_scanline < jpeg->output_height) {
    const size_t v = jpeg->output_scanline;
    JSAMPROW row = d->row;
    if (jpeg_read_scanlines(jpeg, &row, 1) != 1) return false;
    memcpy(left + v * half, d->row, half);
    if (views > 1) memcpy(right + v * half, d->row + half, half);
  }
  (void)jpeg_finish_decompress(jpeg);
  return !d->damaged;
}

bool jpeg_decode(const unsigned char *data, size_t bytes, int32_t width_px, int32_t height_px, int views, void *scratch,
                 size_t scratch_bytes, uint8_t *left, uint8_t *right) {
  decoder *const d = scratch;
  const size_t head = padded(sizeof *d);
  if (scratch_bytes < jpeg_scratch_bytes(width_px)) return false;
  memset(d, 0, sizeof *d);
  d->memory = (unsigned char *)scratch + head;
  d->capacity = scratch_bytes - head;
  d->jpeg.err = jpeg_std_error(&d->errors);
  d->errors.error_exit = leave;
  d->errors.emit_message = note;
  d->jpeg.client_data = d;
  return decode(d, data, bytes, width_px, height_px, views, left, right);
}

#endif
