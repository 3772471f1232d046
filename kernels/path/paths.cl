// The kernels of path generation, a file for each stage. One iteration of the pool is
//   generate      ended paths are handed over, their slots take the next job (regeneration)
//   closest_hits  one ray of every live path
//   shade         one bounce of every live path: its vertex, a shadow ray, the next ray
//   any_hits      shadow rays; light that is hidden leaves the vertex (shadow_walks in scenes with gas)
// and now and then
//   compact       slots without jobs leave the queue
// On CPU devices the four are one kernel, whole_bounces, but where somebody looks at hits.
// All take KB_PATH_PARAMS and run over a queue of slots: work-item i < queue_length[0] works on slot queue_slots[i].
#include "path/generate.clh"
#include "path/closest_hits.clh"
#include "path/bounce.clh"
#include "path/shadow_rays.clh"
#include "path/compact.clh"
#include "path/whole_bounces.clh"
#include "path/auxiliary.clh"
