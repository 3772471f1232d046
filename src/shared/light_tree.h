// The light tree: many lights, of which each shaded point chooses by power, distance and orientation.
//
// A light of the tree is a triangle of an emitting mesh, an emitting shape of another kind, or a positional light. Leaves are
// single lights; every node bounds where its lights lie (a sphere around the box of their points) and where they shine to (a cone of
// normals, of half angle theta_o about an axis, from which they shine up to 90 degrees away). From a point p a node
// counts (Conty Estevez and Kulla, Importance sampling of many lights with adaptive tree splitting, 2018)
//
//   power * max(0, cos theta') / max(d^2, r^2),   theta' = max(0, theta - theta_o - theta_b)
//
// with d the distance of p from the sphere's centre, r its radius, theta the angle between the axis and the direction to p, theta_b
// the angle under which the sphere is seen: theta' is the least angle under which a light may shine to p.
//
// The choice is made in whole steps. A node begins with n equally likely steps, of which the random number is one, and gives
// floor(n wl / (wl + wr)) of them, but at least one and not all, to its left child. Where fewer than KB_LIGHT_STEPS are left,
// each is split into 256 by further random bits, three times at most. So the probability of a leaf is exactly
// n / 2^(24 + 8 splits), and whoever knows the leaf finds the same number on the same way down. A light gets nothing
// only where its chance is below 2^-32.
#ifndef KILOBAND_SHARED_LIGHT_TREE_H
#define KILOBAND_SHARED_LIGHT_TREE_H

#include "shared/lang.h"

#define KB_LIGHT_STEPS 65536.0f
#define KB_LIGHT_SPLITS 3u
#define KB_LIGHT_FINER 256.0f

/* In depth-first order: the left child is the next node, and leaves below the right one come last. */
typedef struct {
  float centre[3]; /* m */
  float power;     /* share of the power of all lights in the guide bands */
  float axis[3];   /* unit */
  float cos_cone;  /* of theta_o; -1: they shine in all directions */
  float sin_cone;
  float radius2; /* m^2 */
  kb_u32 right;  /* the right child; KB_NONE: a leaf */
  kb_u32 light;  /* a leaf's, else KB_NONE */
} KB_ALIGNED(16) KbLightNode;
KB_STATIC_ASSERT(sizeof(KbLightNode) == 48, light_node_size);

typedef struct {
  kb_u32 emitter;
  kb_u32 triangle; /* in the mesh; 0 of others */
  kb_u32 leaf;     /* node; KB_NONE: without area, never chosen */
  float area;      /* m^2, of shapes and triangles */
} KB_ALIGNED(16) KbTreeLight;
KB_STATIC_ASSERT(sizeof(KbTreeLight) == 16, tree_light_size);

#endif
