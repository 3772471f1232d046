// A ray through a plume: its column, and the cells that deferred evaluation integrates
// over (records.h, KB_KIND_MEDIUM).
//
// Evaluation takes Planck's law B in each cell for linear in the column D.
// So the ray is followed twice, in one pass:
//
// - Steps. A step ends where the ray changes the box of a grid, in which c is a cubic of s, and after a
//   quarter of a jet's width at most: Simpson's rule then gives its column, exactly in a grid, to 2e-5 in a
//   jet (kb_plume_enter_jet()). It is halved until B in its middle is off the straight line between its ends by at most half of
//   KB_PLUME_TOLERANCE B_hot, at KB_PLUME_LADDER wavelengths from the shortest to the longest of the scene
//   (B_hot: at the hottest temperature of the plume), and grows again where the line does well.
// - Cells. A cell goes on over further steps while the straight line from its first to its last point keeps
//   within the other half of the tolerance at all points between. The slopes that do so, seen from the first
//   point, form an interval that only shrinks: no point need be remembered.
//
// An error of the source function bounds that of the radiance, so the radiance of a segment of optical depth
// x is off by at most KB_PLUME_TOLERANCE B_hot (1 - exp(-x)) and by the columns' error. That takes 20 to 60
// cells across a jet. A segment that would need more than KB_PLUME_FINE_CELLS goes on with coarser ones, 8.5
// times that bound; it has at most KB_PLUME_CELLS, the last of which takes the rest.
#ifndef KILOBAND_SHARED_PLUME_H
#define KILOBAND_SHARED_PLUME_H

#include "shared/plume_field.h"

#define KB_PLUME_CELLS 96u
#define KB_PLUME_TOLERANCE 2e-3f
/* From this cell on of a segment the cells' half of the tolerance is 16 times as large. */
#define KB_PLUME_FINE_CELLS 80u
/* Largest steps: of the way through a grid, of a jet's width; the smallest: of the way. */
#define KB_GRID_STEP 0.25f
#define KB_JET_STEP 0.25f
#define KB_SMALLEST_STEP (1.0f / 4096.0f)
/* Where steps grow with a jet's width: of the length on which it changes; the smallest, for floats' sake. */
#define KB_WIDENING_STEP 0.18f
#define KB_SMALLEST_WIDENING_STEP (1.0f / 1048576.0f)
/* A jet is followed to this many of its widths from the axis, where its scale is exp(-9) of the axis'. */
#define KB_JET_WIDTHS 3.0f

/* ---- the ray ------------------------------------------------------------------------------------------ */
typedef struct {
  KbFloat3 origin, direction; /* in the plume's coordinates, per metre */
  float at, end;              /* m along the ray: reached, and where the plume or the segment ends */
  float stride;               /* m, of the next step */
  float longest, shortest;    /* m, of any */
  float rate;                 /* jet whose steps grow with its width w: they are of w / rate; 0: others */
  float plane[3];             /* grid: the next planes of nodes */
  float last_scale;           /* where `at` is */
  float start_k, end_k;       /* temperatures at the cell's first and last point */
  float first_k, previous_k;  /* at the first cell's beginning; at the end of the last cell given out */
  float column;               /* m, of the cell so far */
  float start[KB_PLUME_LADDER], last[KB_PLUME_LADDER]; /* B / B_hot at the cell's first and last point */
  float low[KB_PLUME_LADDER], high[KB_PLUME_LADDER]; /* slopes that keep within the tolerance of all points */
  float hot[KB_PLUME_LADDER];                        /* e^-x of kb_planck_below() */
  kb_u32 count;                                      /* cells given out */
} KbPlumeWalk;

/* Shortens the walk to low <= origin + s direction <= high along one axis. */
KB_FN void kb_plume_clip(KbPlumeWalk* w, float origin, float direction, float low, float high) {
  if (direction == 0.0f) {
    if (origin < low || origin > high) w->end = w->at;
    return;
  }
  const float a = (low - origin) / direction, b = (high - origin) / direction;
  w->at = kb_larger(w->at, kb_smaller(a, b));
  w->end = kb_smaller(w->end, kb_larger(a, b));
}

KB_FN float kb_next_plane(float position, float direction) {
  const float below = kb_floor(position);
  return direction > 0.0f ? below + 1.0f : (below == position ? below - 1.0f : below);
}

KB_FN KbFloat3 kb_plume_position(const KbPlumeWalk* w, float s) {
  KbFloat3 p;
  p.x = w->origin.x + s * w->direction.x;
  p.y = w->origin.y + s * w->direction.y;
  p.z = w->origin.z + s * w->direction.z;
  return p;
}

KB_FN KbGasPoint kb_plume_at(const KbPlumeWalk* w, KB_GLOBAL const KbMedium* m,
                             KB_GLOBAL const KbFloat2* nodes, float s) {
  const KbFloat3 p = kb_plume_position(w, s);
  return m->type == KB_MEDIUM_GRID ? kb_grid_at(m, nodes, p) : kb_jet_at(m, p);
}

KB_FN void kb_plume_enter_grid(KbPlumeWalk* w, KB_GLOBAL const KbMedium* m) {
  kb_plume_clip(w, w->origin.x, w->direction.x, 0.0f, (float)(m->nodes[0] - 1u));
  kb_plume_clip(w, w->origin.y, w->direction.y, 0.0f, (float)(m->nodes[1] - 1u));
  kb_plume_clip(w, w->origin.z, w->direction.z, 0.0f, (float)(m->nodes[2] - 1u));
  const KbFloat3 p = kb_plume_position(w, w->at);
  w->plane[0] = kb_next_plane(p.x, w->direction.x);
  w->plane[1] = kb_next_plane(p.y, w->direction.y);
  w->plane[2] = kb_next_plane(p.z, w->direction.z);
  w->longest = KB_GRID_STEP * (w->end - w->at);
}

KB_FN void kb_plume_clip_jet(KbPlumeWalk* w, float reach) {
  kb_plume_clip(w, w->origin.x, w->direction.x, -reach, reach);
  kb_plume_clip(w, w->origin.y, w->direction.y, -reach, reach);
}

/* The jet is a cone: after its longest width the ray is clipped to the largest that it meets.
   Steps are a part of the narrowest width that is met, which is enough where the width changes little on the way. Along the
   axis it changes on the scale w / spread, which is shorter for spread > 1, and where a wide jet begins narrowly the way
   has more than 4096 such steps. There steps are a part of w / (|d_xy| + spread |d_z|), d the direction, which is what
   the jet changes on where the ray is: some dozens in all, as many as the logarithm of the ratio of widths along the axis.
   Single precision adds an error of up to 5e-9 times the distance over radius / spread. */
KB_FN void kb_plume_enter_jet(KbPlumeWalk* w, KB_GLOBAL const KbMedium* m) {
  kb_plume_clip_jet(w, KB_JET_WIDTHS * (m->radius + m->spread * m->length));
  kb_plume_clip(w, w->origin.z, w->direction.z, 0.0f, m->length);
  const float z0 = kb_plume_position(w, w->at).z, z1 = kb_plume_position(w, w->end).z;
  kb_plume_clip_jet(w, KB_JET_WIDTHS * (m->radius + m->spread * kb_larger(kb_larger(z0, z1), 0.0f)));
  const float narrowest = m->radius + m->spread * kb_larger(kb_smaller(z0, z1), 0.0f);
  const KbFloat3 d = w->direction;
  w->longest = KB_JET_STEP * narrowest / kb_sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
  const float way = w->end - w->at;
  if (m->spread > 1.0f || (m->spread > 0.0f && w->longest < KB_SMALLEST_STEP * way)) {
    w->rate = kb_sqrt(d.x * d.x + d.y * d.y) + m->spread * kb_fabs(d.z);
    w->longest = way;
  }
}

/* m, of the step from `at` in a jet whose steps grow with its width. */
KB_FN float kb_plume_widening_step(const KbPlumeWalk* w, KB_GLOBAL const KbMedium* m) {
  const float width = m->radius + m->spread * kb_larger(kb_plume_position(w, w->at).z, 0.0f);
  const float least = KB_SMALLEST_WIDENING_STEP / KB_SMALLEST_STEP * w->shortest;
  return kb_larger(KB_WIDENING_STEP * width / w->rate, least);
}

/* The cell begins anew where the walk is. */
KB_FN void kb_plume_open(KbPlumeWalk* w, float temperature_k, const float* below) {
  w->start_k = w->end_k = temperature_k;
  w->column = 0.0f;
  for (int j = 0; j < KB_PLUME_LADDER; ++j) {
    w->start[j] = w->last[j] = below[j];
    w->low[j] = -1e30f;
    w->high[j] = 1e30f;
  }
}

KB_FN void kb_plume_ladder(const KbPlumeWalk* w, KB_GLOBAL const KbMedium* m, float temperature_k,
                           float* below) {
  const float ratio = m->reference_k / temperature_k;
  KB_ROLLED
  for (int j = 0; j < KB_PLUME_LADDER; ++j) below[j] = kb_planck_below(m->second[j], w->hot[j], ratio);
}

/* The segment from t_min to t_max of origin + t direction (world); direction is a unit vector. Returns 0
   where it misses the plume. */
KB_FN kb_u32 kb_plume_begin(KbPlumeWalk* w, KB_GLOBAL const KbMedium* m, KB_GLOBAL const KbFloat2* nodes,
                            KbFloat3 origin, KbFloat3 direction, float t_min, float t_max) {
  float below[KB_PLUME_LADDER];
  w->origin = kb_affine_point(m->to_local, origin);
  w->direction = kb_affine_vector(m->to_local, direction);
  w->at = t_min;
  w->end = t_max;
  w->rate = 0.0f;
  w->count = 0u;
  if (m->type == KB_MEDIUM_GRID)
    kb_plume_enter_grid(w, m);
  else
    kb_plume_enter_jet(w, m);
  if (!(w->at < w->end)) return 0u;
  w->shortest = KB_SMALLEST_STEP * (w->end - w->at);
  w->stride = w->longest = kb_larger(w->longest, w->shortest);
  const KbGasPoint gas = kb_plume_at(w, m, nodes, w->at);
  for (int j = 0; j < KB_PLUME_LADDER; ++j) w->hot[j] = kb_plume_exp(-m->second[j]);
  kb_plume_ladder(w, m, gas.temperature_k, below);
  kb_plume_open(w, gas.temperature_k, below);
  w->last_scale = gas.scale;
  return 1u;
}

/* Where the step from `at` ends. */
KB_FN float kb_plume_stop(KbPlumeWalk* w, KB_GLOBAL const KbMedium* m) {
  float stop = kb_smaller(w->at + w->stride, w->end);
  if (w->rate > 0.0f) {
    const float near = w->at + kb_plume_widening_step(w, m);
    if (near > w->at) stop = kb_smaller(stop, near);
  }
  if (m->type != KB_MEDIUM_GRID) return stop > w->at ? stop : w->end;
  const float origin[3] = {w->origin.x, w->origin.y, w->origin.z};
  const float direction[3] = {w->direction.x, w->direction.y, w->direction.z};
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0f) continue;
    float crossing = (w->plane[axis] - origin[axis]) / direction[axis];
    if (crossing <= w->at) { /* passed: the next one */
      w->plane[axis] += direction[axis] > 0.0f ? 1.0f : -1.0f;
      crossing = (w->plane[axis] - origin[axis]) / direction[axis];
    }
    if (crossing > w->at) stop = kb_smaller(stop, crossing);
  }
  return stop > w->at ? stop : w->end; /* steps below the resolution of floats: the rest at once */
}

/* A step that was tried. */
typedef struct {
  float stop;
  KbGasPoint middle, end;
  float first_half, column; /* m, of its first half and of all of it */
} KbPlumeStep;

/* The parabola through three values over h: h / 6 (a + 4 m + b), its first half h / 24 (5 a + 8 m - b). */
KB_FN KbPlumeStep kb_plume_try(KbPlumeWalk* w, KB_GLOBAL const KbMedium* m, KB_GLOBAL const KbFloat2* nodes) {
  KbPlumeStep s;
  s.stop = kb_plume_stop(w, m);
  s.middle = kb_plume_at(w, m, nodes, 0.5f * (w->at + s.stop));
  s.end = kb_plume_at(w, m, nodes, s.stop);
  const float width = m->scale * (s.stop - w->at);
  s.column = width / 6.0f * (w->last_scale + 4.0f * s.middle.scale + s.end.scale);
  s.first_half = width / 24.0f * (5.0f * w->last_scale + 8.0f * s.middle.scale - s.end.scale);
  return s;
}

/* Column of the whole segment, m; after kb_plume_begin(). */
KB_FN float kb_plume_column(KbPlumeWalk* w, KB_GLOBAL const KbMedium* m, KB_GLOBAL const KbFloat2* nodes) {
  float column = 0.0f;
  while (w->at < w->end) {
    const KbPlumeStep s = kb_plume_try(w, m, nodes);
    column += s.column;
    w->at = s.stop;
    w->last_scale = s.end.scale;
  }
  return column;
}

/* How far B / B_hot in the middle of the step is off the straight line between its ends; `below`
   is that at its end. */
KB_FN float kb_plume_bend(const KbPlumeWalk* w, KB_GLOBAL const KbMedium* m, const KbPlumeStep* s,
                          const float* below) {
  float middle[KB_PLUME_LADDER], largest = 0.0f;
  const float share = s->column > 0.0f ? s->first_half / s->column : 0.5f;
  kb_plume_ladder(w, m, s->middle.temperature_k, middle);
  KB_ROLLED
  for (int j = 0; j < KB_PLUME_LADDER; ++j)
    middle[j] = kb_fabs(middle[j] - kb_plume_mix(w->last[j], below[j], share));
  for (int j = 0; j < KB_PLUME_LADDER; ++j) largest = kb_larger(largest, middle[j]);
  return largest;
}

/* One step: its column in m; `below` and *temperature_k belong to its end, where `at` is afterwards. */
KB_FN float kb_plume_step(KbPlumeWalk* w, KB_GLOBAL const KbMedium* m, KB_GLOBAL const KbFloat2* nodes,
                          float* below, float* temperature_k) {
  for (;;) {
    const KbPlumeStep s = kb_plume_try(w, m, nodes);
    kb_plume_ladder(w, m, s.end.temperature_k, below);
    const float bend = s.column > 0.0f ? kb_plume_bend(w, m, &s, below) : 0.0f;
    if (bend > 0.5f * KB_PLUME_TOLERANCE && w->stride > w->shortest) {
      w->stride = kb_larger(0.5f * (s.stop - w->at), w->shortest);
      continue;
    }
    if (bend < 0.0625f * KB_PLUME_TOLERANCE) w->stride = kb_smaller(2.0f * w->stride, w->longest);
    w->at = s.stop;
    w->last_scale = s.end.scale;
    *temperature_k = s.end.temperature_k;
    return s.column;
  }
}

/* Does the chord to the point (column, below) keep within the tolerance of the cell's points? */
KB_FN kb_u32 kb_plume_fits(const KbPlumeWalk* w, float column, const float* below) {
  kb_u32 fits = 1u;
  KB_ROLLED
  for (int j = 0; j < KB_PLUME_LADDER; ++j) {
    const float slope = (below[j] - w->start[j]) / column;
    fits &= (kb_u32)(slope >= w->low[j]) & (kb_u32)(slope <= w->high[j]);
  }
  return fits;
}

/* The cell reaches to the point. */
KB_FN void kb_plume_extend(KbPlumeWalk* w, float column, float temperature_k, const float* below) {
  const float tolerance = (w->count < KB_PLUME_FINE_CELLS ? 0.5f : 8.0f) * KB_PLUME_TOLERANCE;
  w->column = column;
  w->end_k = temperature_k;
  KB_ROLLED
  for (int j = 0; j < KB_PLUME_LADDER; ++j) {
    w->last[j] = below[j];
    w->low[j] = kb_larger(w->low[j], (below[j] - tolerance - w->start[j]) / column);
    w->high[j] = kb_smaller(w->high[j], (below[j] + tolerance - w->start[j]) / column);
  }
}

/* Gives the cell out and begins the next at its end. A cell whose beginning is not the end of the one before
   (no gas in between) is preceded by one without a column that leads there; then *cells is 2. */
KB_FN kb_u32 kb_plume_close(KbPlumeWalk* w, KbPlumeCell* out) {
  kb_u32 cells = 0u;
  float last[KB_PLUME_LADDER];
  if (w->count == 0u) w->first_k = w->previous_k = w->start_k;
  if (w->start_k != w->previous_k) {
    out[cells].column = 0.0f;
    out[cells++].temperature_k = w->start_k;
  }
  out[cells].column = w->column;
  out[cells++].temperature_k = w->end_k;
  w->count += cells;
  w->previous_k = w->end_k;
  for (int j = 0; j < KB_PLUME_LADDER; ++j) last[j] = w->last[j];
  kb_plume_open(w, w->end_k, last);
  return cells;
}

/* The next cells along the ray, 1 or 2 in `out`; 0: no more. At most KB_PLUME_CELLS in all. */
KB_FN kb_u32 kb_plume_next(KbPlumeWalk* w, KB_GLOBAL const KbMedium* m, KB_GLOBAL const KbFloat2* nodes,
                           KbPlumeCell* out) {
  float below[KB_PLUME_LADDER], temperature_k;
  while (w->at < w->end) {
    const float step = kb_plume_step(w, m, nodes, below, &temperature_k);
    if (step == 0.0f && w->column == 0.0f) { /* no gas yet: the cell begins later */
      kb_plume_open(w, temperature_k, below);
      continue;
    }
    const kb_u32 last_cell = w->count + 4u > KB_PLUME_CELLS;
    if (w->column == 0.0f || last_cell || (step > 0.0f && kb_plume_fits(w, w->column + step, below))) {
      kb_plume_extend(w, w->column + step, temperature_k, below);
      continue;
    }
    const kb_u32 cells = kb_plume_close(w, out);
    if (step > 0.0f)
      kb_plume_extend(w, step, temperature_k, below);
    else
      kb_plume_open(w, temperature_k, below);
    return cells;
  }
  return w->column > 0.0f ? kb_plume_close(w, out) : 0u;
}

#endif
