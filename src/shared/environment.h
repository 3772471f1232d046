// Which directions of an environment map a shaded point is offered: by the map, and by the cosine at the point.
//
// The normals of receivers, in the map's own frame, fall into KB_FACINGS facings: cells of the octahedral map. With
// s = |x| + |y| + |z| a normal (x, y, z) has the coordinates (x, z) / s where y >= 0 and else
// ((1 - |z| / s) sign x, (1 - |x| / s) sign z), each in [-1, 1], which KB_FACINGS_ACROSS cells divide evenly. Facing
// number i + KB_FACINGS_ACROSS * j has the i-th cell along x, the j-th along z. What sees both sides of its surface has the facing
// KB_ALL_FACINGS, which prefers no direction. Tables: scene/compile/light/envmap_sampling.hpp.
#ifndef KILOBAND_SHARED_ENVIRONMENT_H
#define KILOBAND_SHARED_ENVIRONMENT_H

#define KB_FACINGS_ACROSS 8u
#define KB_FACINGS 64u
#define KB_ALL_FACINGS KB_FACINGS

/* Random numbers have 24 bits. Where two choices share one, a third of it gives the second choice 12 bits more. */
#define KB_FINER_DIGITS 4096.0f

#endif
