#include "perceive/line/straight_lines.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "common/numbers.h"

/* Sixteen rows are a piece of a line when their contrasts add up to this share of the full ones. */
#define PIECE_SUM 0.55
#define PIECES_MIN 5 /* of a line */
#define PIECE_SHARE 0.3 /* of the strips from its first to its last piece that have one */
/* Largest root mean square distance of a line's pieces from the straight line through them, along the row. */
#define STRAIGHT_PX 0.9
#define RIDGE_SHARE 0.4 /* least of a line's rows that show it */
#define APART_PX 5       /* of two pieces in one strip */
#define LINK_PX 2.0      /* from the line's continuation to the next piece */
#define LINK_LEAN 4.0    /* columns per strip by which their directions may differ */
#define GAP_STRIPS 2     /* of a line that are passed over at once, */
#define LONG_GAP_STRIPS 12 /* and once it has so many pieces that its direction is known: */
#define KNOWN_PIECES 3
#define ON_RIDGE 3       /* seventh parts of the full contrast: a row that shows the line */
#define SAME_PX 6.0      /* two lines that are nearer in the middle of the shorter one are one line */
#define COLUMN_PX 16     /* in which the pieces of a strip are looked up */
#define SUM_BINS (VISTA_STRIP_ROWS * VISTA_RIDGE_FULL + 1)

void vista_straight_lines_layout(vista_straight_lines *lines, vista_arena *arena, int32_t width_px, int32_t height_px) {
  vista_ridge_layout(&lines->ridge, arena, width_px, height_px);
  lines->pieces = vista_arena_take(arena, VISTA_PIECES_MAX, sizeof(vista_line_piece));
  lines->order = vista_arena_take(arena, VISTA_PIECES_MAX + (size_t)lines->ridge.strips, sizeof(int32_t));
  lines->columns = width_px / COLUMN_PX + 1;
  lines->first_of_column =
      vista_arena_take(arena, (size_t)lines->ridge.strips * (size_t)lines->columns, sizeof(int32_t));
  lines->first_piece = vista_arena_take(arena, (size_t)lines->ridge.strips + 1, sizeof(int32_t));
  lines->items = vista_arena_take(arena, VISTA_STRAIGHT_LINES_MAX, sizeof(vista_thin_line));
  lines->count = 0;
}

/* The largest of the columns around; of equal ones the first, which stands for all of them. */
static bool is_peak(const vista_ridge *ridge, int32_t u) {
  const uint8_t own = ridge->best[u];
  for (int32_t k = u - APART_PX; k <= u + APART_PX; ++k) {
    if (k < 0 || k >= ridge->width_px || k == u) continue;
    if (ridge->best[k] > own || (ridge->best[k] == own && k < u)) return false;
  }
  return true;
}

/* The middle of the equal ones from a peak on. */
static int32_t middle_of(const vista_ridge *ridge, int32_t peak) {
  int32_t last = peak;
  while (last + 1 < ridge->width_px && last < peak + APART_PX && ridge->best[last + 1] == ridge->best[peak]) ++last;
  return (peak + last) / 2;
}

static void find_pieces(int32_t threshold, vista_straight_lines *lines) {
  vista_ridge *const ridge = &lines->ridge;
  int32_t count = 0;
  for (int32_t strip = 0; strip < ridge->strips; ++strip) {
    int32_t *const first = lines->first_of_column + strip * lines->columns;
    lines->first_piece[strip] = count;
    vista_ridge_sum(ridge, strip);
    for (int32_t column = 0; column < lines->columns; ++column) {
      const int32_t next = (column + 1) * COLUMN_PX, end = next < ridge->width_px ? next : ridge->width_px;
      first[column] = count;
      for (int32_t u = column * COLUMN_PX; u < end && count < VISTA_PIECES_MAX; ++u)
        if (ridge->best[u] >= threshold && is_peak(ridge, u)) {
          const int32_t middle = middle_of(ridge, u);
          lines->pieces[count++] = (vista_line_piece){
              .u_px = (int16_t)middle, .lean = ridge->lean[middle], .sum = ridge->best[u], .strip = (int16_t)strip};
        }
    }
  }
  lines->first_piece[ridge->strips] = count;
}

/* Counting sort, which keeps equal ones in their order. */
static void sort_pieces(vista_straight_lines *lines) {
  int32_t first[SUM_BINS + 1] = {0};
  const int32_t count = lines->first_piece[lines->ridge.strips];
  for (int32_t i = 0; i < count; ++i) ++first[SUM_BINS - lines->pieces[i].sum];
  for (int32_t bin = 1; bin <= SUM_BINS; ++bin) first[bin] += first[bin - 1];
  for (int32_t i = count - 1; i >= 0; --i) lines->order[--first[SUM_BINS - lines->pieces[i].sum]] = i;
}

/* Sums over the pieces of a line that grows; strips are counted from its first piece. */
typedef struct growth {
  double n, t, u, tt, tu, uu;
  double lean; /* of its first piece, until there are more */
} growth;

static void add(growth *g, double t, double u) {
  g->n += 1.0, g->t += t, g->u += u, g->tt += t * t, g->tu += t * u, g->uu += u * u;
}

static void line_of(const growth *g, double *u, double *per_strip) {
  const double spread = g->tt - g->t * g->t / g->n;
  *per_strip = spread > 0.0 ? (g->tu - g->t * g->u / g->n) / spread : g->lean;
  *u = (g->u - *per_strip * g->t) / g->n; /* at t = 0 */
}

static int32_t column_of(double u) { return u <= 0.0 ? 0 : (int32_t)(u / COLUMN_PX); }

static int32_t next_piece(const vista_straight_lines *lines, int32_t strip, double u, double per_strip) {
  int32_t nearest = -1;
  double nearest_px = LINK_PX;
  if (u > lines->ridge.width_px + LINK_PX) return -1;
  const int32_t *const first = lines->first_of_column + strip * lines->columns;
  for (int32_t i = first[column_of(u - LINK_PX - APART_PX)]; i < lines->first_piece[strip + 1]; ++i) {
    const vista_line_piece *const piece = &lines->pieces[i];
    if (piece->u_px > u + LINK_PX) break;
    const double off_px = fabs(piece->u_px - u);
    if (piece->taken || off_px > nearest_px || fabs(piece->lean - per_strip) > LINK_LEAN) continue;
    nearest = i;
    nearest_px = off_px;
  }
  return nearest;
}

/* Follows a line from strip `from` on, downward or upward; returns the last strip that has a piece of it. */
static int32_t grow(vista_straight_lines *lines, int32_t from, int32_t step, growth *g, int32_t *members,
                    int32_t *member_count) {
  int32_t last = from;
  double u, per_strip;
  line_of(g, &u, &per_strip);
  for (int32_t strip = from + step; strip >= 0 && strip < lines->ridge.strips &&
                                    step * (strip - last) <= 1 + (g->n < KNOWN_PIECES ? GAP_STRIPS : LONG_GAP_STRIPS);
       strip += step) {
    const int32_t found = next_piece(lines, strip, u + per_strip * (strip - from), per_strip);
    if (found < 0) continue;
    add(g, strip - from, lines->pieces[found].u_px);
    members[(*member_count)++] = found;
    line_of(g, &u, &per_strip);
    last = strip;
  }
  return last;
}

/* Counts the rows of the ridges, from `first` on, in which there is one on the line. */
static int32_t rows_on_ridge(const vista_ridge *ridge, const vista_thin_line *line, int32_t first, int32_t count) {
  int32_t on = 0;
  for (int32_t v = first; v < first + count; ++v) {
    const int32_t u = (int32_t)lround(vista_thin_across_px(line, v + ridge->along_px)) - ridge->across_px;
    int32_t most = 0;
    for (int32_t k = u - 1; k <= u + 1; ++k) {
      if (k < 0 || k >= ridge->width_px) continue;
      const int32_t value = abs(vista_ridge_at(ridge, k, v));
      most = value > most ? value : most;
    }
    on += most >= ON_RIDGE;
  }
  return on;
}

int32_t vista_straight_line_end(const vista_ridge *ridge, const vista_thin_line *line, int32_t from_px, int32_t step) {
  int32_t end = (from_px - ridge->along_px) / VISTA_STRIP_ROWS;
  const int32_t first = (line->first_px - ridge->along_px) / VISTA_STRIP_ROWS,
                last = (line->last_px - ridge->along_px) / VISTA_STRIP_ROWS;
  for (int32_t strip = end + step; abs(strip - end) <= GAP_STRIPS + 1; strip += step) {
    if (strip < first || strip > last) break;
    if (2 * rows_on_ridge(ridge, line, strip * VISTA_STRIP_ROWS, VISTA_STRIP_ROWS) > VISTA_STRIP_ROWS) end = strip;
  }
  return ridge->along_px + end * VISTA_STRIP_ROWS + (step > 0 ? VISTA_STRIP_ROWS - 1 : 0);
}

static bool is_known(const vista_straight_lines *lines, const vista_thin_line *line) {
  const double middle = 0.5 * (line->first_px + line->last_px);
  for (int32_t i = 0; i < lines->count; ++i) {
    const vista_thin_line *const other = &lines->items[i];
    if (middle < other->first_px || middle > other->last_px) continue;
    if (fabs(vista_thin_across_px(line, middle) - vista_thin_across_px(other, middle)) <=
            SAME_PX * hypot(1.0, line->slope) &&
        fabs(line->slope - other->slope) <= 0.25)
      return true;
  }
  return false;
}

static void grow_from(int32_t seed, int32_t *members, vista_straight_lines *lines) {
  const vista_line_piece *const piece = &lines->pieces[seed];
  growth g = {.lean = piece->lean};
  int32_t count = 0;
  add(&g, 0.0, piece->u_px);
  members[count++] = seed;
  const int32_t below = grow(lines, piece->strip, 1, &g, members, &count);
  const int32_t above = grow(lines, piece->strip, -1, &g, members, &count);
  const int32_t strips = below - above + 1;
  if (count < PIECES_MIN || count < PIECE_SHARE * strips) return;
  double u, per_strip;
  line_of(&g, &u, &per_strip);
  const double residual = g.uu - g.u * g.u / g.n - per_strip * (g.tu - g.t * g.u / g.n);
  if (residual > vista_square(STRAIGHT_PX) * g.n) return;
  const vista_ridge *const ridge = &lines->ridge;
  const double across_px = ridge->across_px + u;
  const double along_px = ridge->along_px + (piece->strip + 0.5) * VISTA_STRIP_ROWS - 0.5;
  const vista_thin_line line = {.flat = ridge->flat,
                                .u_px = ridge->flat ? along_px : across_px,
                                .v_px = ridge->flat ? across_px : along_px,
                                .slope = per_strip / VISTA_STRIP_ROWS,
                                .first_px = ridge->along_px + above * VISTA_STRIP_ROWS,
                                .last_px = ridge->along_px + (below + 1) * VISTA_STRIP_ROWS - 1};
  const int32_t rows = strips * VISTA_STRIP_ROWS;
  if (rows_on_ridge(ridge, &line, above * VISTA_STRIP_ROWS, rows) < RIDGE_SHARE * rows) return;
  for (int32_t i = 0; i < count; ++i) lines->pieces[members[i]].taken = true;
  if (!is_known(lines, &line)) lines->items[lines->count++] = line;
}

void vista_straight_lines_find(const vista_image *image, double contrast, vista_straight_lines *lines) {
  vista_ridge_find(image, contrast, &lines->ridge);
  find_pieces((int32_t)ceil(PIECE_SUM * VISTA_STRIP_ROWS * VISTA_RIDGE_FULL), lines);
  sort_pieces(lines);
  lines->count = 0;
  const int32_t pieces = lines->first_piece[lines->ridge.strips];
  int32_t *const members = lines->order + VISTA_PIECES_MAX; /* a piece a strip at most */
  for (int32_t i = 0; i < pieces && lines->count < VISTA_STRAIGHT_LINES_MAX; ++i)
    if (!lines->pieces[lines->order[i]].taken) grow_from(lines->order[i], members, lines);
}
