// Records of the streaming pipeline: what its kernels keep between launches, and what the host tells them.
//
// A ROUND renders S samples of Q pixels: its jobs are numbered sample * padded_pixels + pixel, where
// padded_pixels is Q rounded up to a multiple of the pool's size P. Slot s of the pool takes the jobs s,
// s + P, s + 2P ..., so a pixel belongs to one slot: what is added to it is added in the order of its
// samples, however the device schedules. Vertices of saved paths lie in an arena of 32-byte entries, in chunks
// of KB_CHUNK_ENTRIES that are handed out by a counter and linked by chunk_next[].
#ifndef KILOBAND_SHARED_PIPELINE_H
#define KILOBAND_SHARED_PIPELINE_H

#include "shared/environment.h"
#include "shared/estimator.h"
#include "shared/lang.h"
#include "shared/records.h"
#include "shared/spectra_layout.h"

#ifndef KB_CHUNK_ENTRIES
#define KB_CHUNK_ENTRIES 4u
#endif
/* With the method pt a slot's chunk holds what a path appends between two updates: with dispersion up to three vertices and
   three entries of samples, with gas the cells of plumes. With suns it has KB_MOST_SUNS entries more. */
#define KB_PT_DISPERSION_CHUNK_ENTRIES 8u
#define KB_PT_GAS_CHUNK_ENTRIES 48u

/* Interiors that a path may be in at a time; a sample that is in more of them is invalid. */
#define KB_MEDIUM_DEPTH 4
/* Gases that a shadow ray may pass; one that passes more makes its sample invalid. */
#define KB_SHADOW_MEDIA 8u

/* ---- the scene beside its arrays ---------------------------------------------------------------------- */
typedef struct {
  KbCamera camera;
  kb_u32 channels; /* K */
  kb_u32 emitter_count;
  kb_u32 environment; /* emitter, or KB_NONE */
  kb_u32 max_depth;   /* as Mitsuba counts; KB_NONE: unlimited */
  kb_u32 rr_depth;
  kb_u32 hide_emitters;
  kb_u32 unit_row;     /* a reflectance of 1, or KB_NONE */
  kb_u32 envmap_width; /* cells of the environment map's distribution */
  kb_u32 envmap_height;
  kb_u32 atmosphere;                    /* medium outside all interiors, or KB_NONE */
  kb_u16 camera_media[KB_MEDIUM_DEPTH]; /* where rays begin: as KbGasState::inside */
  kb_u32 gas;                           /* 1: the scene has media or null boundaries */
  kb_u32 instances;                     /* 1: the scene has instances */
  kb_u32 first_sun;                     /* the emitters from here on are suns; emitter_count: none is */
  kb_u32 light_tree;                    /* 1: the scene has one (light_tree.h) */
  kb_u32 envmap_row_shift;              /* cells of a region of the map: 2^shift */
  kb_u32 envmap_column_shift;
  kb_u32 reserved[2];
} KB_ALIGNED(16) KbSceneConstants;
KB_STATIC_ASSERT(sizeof(KbSceneConstants) == 208, scene_constants_size);

/* ---- ray tracing -------------------------------------------------------------------------------------- */
/* A primitive of the acceleration structure: a triangle of a mesh (corners), a whole analytic shape, or an instance of
   a group of meshes, which has a tree of its own. */
#define KB_PRIMITIVE_INSTANCE 4u
typedef struct {
  float corner[9];  /* mesh: three positions, in the world or in the group's coordinates; else not used */
  kb_u32 shape;     /* in groups: number within the group; instance: its first shape */
  kb_u32 primitive; /* triangle within the shape; 0 for analytic shapes; instance: root of the group's tree */
  kb_u32 analytic;  /* KbShapeType of the shape: 0 is a mesh's triangle; or KB_PRIMITIVE_INSTANCE */
} KB_ALIGNED(16) KbPrimitive;
KB_STATIC_ASSERT(sizeof(KbPrimitive) == 48, primitive_size);

/* An inner node: the boxes of its children, grown by one unit in the last place, plane by plane for SIMD.
   Children that are not there have empty boxes. Four children: on PoCL 1.2 to 1.4 times the ray rate
   of two (bench_traversal). */
#define KB_BVH_WIDTH 4
#define KB_BVH_LEAF 8                     /* primitives at most */
#define KB_BVH_MAX_PRIMITIVES 0x0fffffffu /* what an index of 28 bits reaches */
typedef struct {
  float plane[6][KB_BVH_WIDTH]; /* low x, y, z, high x, y, z */
  kb_u32 child[KB_BVH_WIDTH];   /* an inner node's index, or KB_BVH_LEAF_OF(first primitive, count) */
  kb_u32 reserved[4];           /* so that a node lies in one line of 128 bytes */
} KB_ALIGNED(16) KbBvhNode;
#define KB_BVH_IS_LEAF 0x80000000u
#define KB_BVH_NO_CHILD 0xffffffffu /* reads as a leaf, but has no primitives */
#define KB_BVH_LEAF_OF(first, count) (KB_BVH_IS_LEAF | ((count)-1u) << 28 | (first))
#define KB_BVH_LEAF_FIRST(leaf) ((leaf)&0x0fffffffu)
#define KB_BVH_LEAF_COUNT(leaf) ((leaf) == KB_BVH_NO_CHILD ? 0u : (((leaf) >> 28) & 7u) + 1u)
KB_STATIC_ASSERT(sizeof(KbBvhNode) == 128, bvh_node_size);

/* A triangle's vertices as devices have them: beside the 12 bytes of three indices 4 more, so that they come in one piece. */
typedef struct {
  kb_u32 vertex[3];
  kb_u32 reserved;
} KB_ALIGNED(16) KbTriangle;
KB_STATIC_ASSERT(sizeof(KbTriangle) == 16, triangle_size);

/* A closest-hit query; hits lie in (t_min, t_max). `previous` is what multiple importance sampling needs of
   the vertex the ray comes from. */
typedef struct {
  float origin[3];
  float t_min;
  float direction[3];
  float t_max;
  float previous_point[3];
  float previous_pdf; /* solid angle, of the BSDF sample */
} KB_ALIGNED(16) KbRay;
KB_STATIC_ASSERT(sizeof(KbRay) == 48, ray_size);

typedef struct {
  float t;
  float u, v;       /* barycentric coordinates of a mesh hit: of the second and third corner */
  kb_u32 primitive; /* index of a KbPrimitive, or KB_NONE: a miss */
} KB_ALIGNED(16) KbHit;
KB_STATIC_ASSERT(sizeof(KbHit) == 16, hit_size);

/* An occlusion query over (0, t_max); t_max < 0: there is none. */
typedef struct {
  float origin[3];
  float t_max;
  float direction[3];
  kb_u32 vertex; /* arena entry whose KB_VERTEX_NEE goes if something is in between */
} KB_ALIGNED(16) KbShadowRay;
KB_STATIC_ASSERT(sizeof(KbShadowRay) == 32, shadow_ray_size);

/* ---- path state --------------------------------------------------------------------------------------- */
#define KB_PATH_BOUNCE_MASK 0x0001ffffu
#define KB_PATH_FACING_MASK 0x00fe0000u /* of where the ray comes from: environment.h */
#define KB_PATH_FACING_SHIFT 17u
#define KB_PATH_LIVE 0x01000000u           /* has a ray to trace */
#define KB_PATH_ENDED 0x02000000u          /* complete, not yet handed over to evaluation */
#define KB_PATH_INVALID 0x04000000u        /* a weight is not finite, or the path is endless */
#define KB_PATH_PREVIOUS_DELTA 0x08000000u /* the ray was not sampled from a density */
#define KB_PATH_FINISHED 0x10000000u       /* the slot has no more jobs */
#define KB_PATH_HEROES 0x40000000u         /* its hero weights are set */
#define KB_PATH_NEGATIVE 0x80000000u       /* the next vertex has KB_VERTEX_NEGATIVE */
#define KB_PATH_FRESH 0x20000000u          /* what was appended last belongs to the path's first bounce */

/* With dispersion, beside the path's state: what each bin of channels still carries (channel_choice.clh), and the
   probabilities of the heroes (spectral_mis.clh). */
typedef struct {
  float carried[KB_CHANNEL_BINS];
  float heroes[KB_MAX_HEROES];
} KB_ALIGNED(16) KbDispersionState;
KB_STATIC_ASSERT(sizeof(KbDispersionState) == 96, dispersion_state_size);

KB_STATIC_ASSERT(KB_MAX_VERTICES <= KB_PATH_BOUNCE_MASK, bounces_fit);
KB_STATIC_ASSERT(KB_ALL_FACINGS <= KB_PATH_FACING_MASK >> KB_PATH_FACING_SHIFT, facings_fit);

typedef struct {
  kb_u32 job;
  kb_u32 flags;    /* bounce | facing | KB_PATH_* */
  float bound;     /* upper bound of the throughput over all channels, without radiance scaling */
  float magnitude; /* product of the scatter weights */
  kb_u32 channel;  /* the one that survived a dispersive refraction, or KB_NONE */
  kb_u32 chunk;    /* of the arena, being filled */
  kb_u32 length;   /* arena entries of this path so far */
  kb_u32 lit;      /* arena entries up to and with the last vertex that has light */
} KB_ALIGNED(16) KbPathState;
KB_STATIC_ASSERT(sizeof(KbPathState) == 32, path_state_size);

/* In scenes with gas: where a path is. */
#define KB_ESCAPE_UNKNOWN 0u
#define KB_ESCAPE_YES 1u
#define KB_ESCAPE_NO 2u
typedef struct {
  kb_u16 inside[KB_MEDIUM_DEPTH]; /* medium + 1 of the interiors entered and not left, in order; 0: none */
  kb_u16 shadow_inside[KB_MEDIUM_DEPTH]; /* the same where the shadow ray begins */
  kb_u32 crossings;                      /* null boundaries passed */
  kb_u32 escape;                         /* KB_ESCAPE_*: whether the ray at hand leaves the scene */
  float atmosphere_column;               /* m, passed on a ray that leaves the scene */
  float begin, shadow_begin; /* ray parameter of the surface that the ray left: its origin is off it */
} KbGasState;
KB_STATIC_ASSERT(sizeof(KbGasState) == 36, gas_state_size);

/* A pixel of the round. */
typedef struct {
  kb_u32 x, y;  /* in the full film */
  kb_u32 block; /* within the round: pixels of a block share mu */
  kb_u32 reserved;
} KB_ALIGNED(16) KbRoundPixel;
KB_STATIC_ASSERT(sizeof(KbRoundPixel) == 16, round_pixel_size);

/* Film pixels of one block that follow each other. */
typedef struct {
  kb_u32 first, count;
} KB_ALIGNED(8) KbFilmPart;
KB_STATIC_ASSERT(sizeof(KbFilmPart) == 8, film_part_size);

/* A saved path: arena entries from `chunk` on; count 0: nothing that contributes. */
#define KB_SAVED_INVALID 0xffffffffu
typedef struct {
  kb_u32 chunk;
  kb_u32 count; /* entries, or KB_SAVED_INVALID */
} KB_ALIGNED(8) KbSavedPath;
KB_STATIC_ASSERT(sizeof(KbSavedPath) == 8, saved_path_size);

#define KB_WAVELENGTHS_SHARED 0u
#define KB_WAVELENGTHS_PER_PATH 1u

typedef struct {
  kb_u64 seed;
  kb_u32 sampler;     /* KB_SAMPLER_* */
  kb_u32 wavelengths; /* KB_WAVELENGTHS_* */
  kb_u32 replicates;  /* R */
  kb_u32 replicate;
  kb_u32 first_index;   /* in the replicate, of the round's first sample */
  kb_u32 samples;       /* S */
  kb_u32 pixels;        /* Q */
  kb_u32 padded_pixels; /* a multiple of pool */
  kb_u32 pool;          /* P, slots in use */
  kb_u32 blocks;        /* of the round */
  kb_u32 arena_chunks;  /* capacity */
  kb_u32 degrade_rough; /* rough dispersive boundaries: one channel goes on, instead of spectral MIS */
  kb_u32 dispersion;    /* the scene has boundaries whose index depends on wavelength */
  kb_u32 open; /* dpept: 1: the round goes on with a chunk of samples, whose sums are the film it is given */
} KbRound;
KB_STATIC_ASSERT(sizeof(KbRound) == 64, round_size);

/* What is seen through a pixel's centre. */
typedef struct {
  float depth; /* m along the ray; 0: nothing is hit */
  float normal[3];
  float object, material; /* indices, -1: nothing */
} KbAuxiliary;
KB_STATIC_ASSERT(sizeof(KbAuxiliary) == 24, auxiliary_size);

/* Iterations of the pool after which finished slots leave the queue. */
#define KB_ITERATIONS_PER_PACKING 8u

/* Paths of a kind of material begin at a multiple of it in the order of shading, so that no group of lanes has two kinds. */
#define KB_SHADING_LANES 32u

/* Work-items of a group at most, of the kernels that work on slots. */
#define KB_LARGEST_PATH_GROUP 1024u

/* What a slot has done in a round. */
typedef struct {
  kb_u32 rays, vertices;
} KB_ALIGNED(8) KbTally;
KB_STATIC_ASSERT(sizeof(KbTally) == 8, tally_size);

/* ---- faults: kernels write, the host reads ------------------------------------------------------------ */
#define KB_FAULT_ARENA_FULL 1u     /* the round is repeated with fewer paths */
#define KB_FAULT_STACK_OVERFLOW 2u /* a traversal needs more stack than the measured depth: our bug */
#define KB_FAULT_BAD_INDEX 4u      /* a record refers to what does not exist: our bug */

/* Slots whose tallies a work-item adds up. */
#define KB_TALLY_SLOTS 64u

#define KB_LISTED_INVALID 22u

typedef struct {
  kb_u32 code;                 /* KB_FAULT_* bits */
  kb_u32 slot;                 /* of one that raised it */
  kb_u32 chunks;               /* arena chunks asked for */
  kb_u32 invalid;              /* paths that leave the mean */
  kb_u32 rays[2], vertices[2]; /* of the round, as far as they are added: low and high word */
  kb_u32 reserved[2];
  kb_u32 invalid_jobs[KB_LISTED_INVALID]; /* the first of them, in no order */
} KB_ALIGNED(16) KbFaults;
KB_STATIC_ASSERT(sizeof(KbFaults) == 128, faults_size);

/* ---- spectra ------------------------------------------------------------------------------------------
   Every row of spectra is tabulated over mu in each channel: node j of channel k is the value at
   mu = j / cells. Between nodes it is linear; the number of cells follows from an error bound. Values stand
   at nodes[first + j * stride + k], j = 0 .. cells. */
typedef struct {
  kb_u32 first;
  kb_u32
      cells; /* at least 1; 0: a row of knots (gases, narrow spectra), kernels/evaluate/spectral_row.clh has its layout */
} KB_ALIGNED(8) KbChannelTable;
KB_STATIC_ASSERT(sizeof(KbChannelTable) == 8, channel_table_size);

#endif
