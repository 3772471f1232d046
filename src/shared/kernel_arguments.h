// The arguments of kernels: one list per group, from which kernels/base/arguments.clh makes the kernels' parameters and
// structs, and src_gpu/device/kernel_groups.hpp the host's structs and their binding.
//
// To add a buffer: a line here, and where the host fills the group (src_gpu/scene/device_scene.cpp for the scene), which
// does not compile without it. Nothing is counted or numbered by hand.
//
//   X(group, kind, type, name)   IN: a buffer of `type` that kernels only read, OUT: one that some write, VALUE: a scalar;
//                                SAME: read at the same address by all work-items, in constant memory
//   SEP                          what stands between two arguments; KB_COMMA in lists of parameters, else empty
//
// Kernels know an argument as group_name (scene_materials); a kernel's groups are named in the lists at the end.
#ifndef KILOBAND_SHARED_KERNEL_ARGUMENTS_H
#define KILOBAND_SHARED_KERNEL_ARGUMENTS_H

#define KB_COMMA ,

// clang-format off

/* The compiled scene (FlatScene). */
#define KB_SCENE_ARGUMENTS(X, SEP)                                                                               \
  X(scene, SAME, KbSceneConstants, constants) SEP                                                                \
  X(scene, IN, KbMaterial, materials) SEP                                                                        \
  X(scene, IN, KbBump, bumps) SEP             /* by material */                                                  \
  X(scene, IN, KbRoughness, roughness) SEP    /* by material */                                                  \
  X(scene, IN, kb_u32, principled_maps) SEP   /* [material][KB_PRINCIPLED_MAPPED]: bitmaps or KB_NONE; empty without principled ones */ \
  X(scene, IN, float, tables) SEP             /* of materials, thermal emission: KbMaterial::table, KbThermal::table */ \
  X(scene, IN, KbSurface, surfaces) SEP                                                                          \
  X(scene, IN, KbShape, shapes) SEP                                                                              \
  X(scene, IN, KbTexture, textures) SEP                                                                          \
  X(scene, IN, KbCheckerboard, checkerboards) SEP                                                                \
  X(scene, IN, KbFloat4, texels) SEP                                                                             \
  X(scene, IN, float, texel_values) SEP       /* of spectral textures, each at its first_value */                \
  X(scene, IN, float, texel_bounds) SEP                                                                          \
  X(scene, IN, float, spectrum_bounds) SEP    /* by row */                                                       \
  X(scene, IN, KbFloat4, normals) SEP         /* by vertex, as x, y, z, 0; KB_SHAPE_HAS_NORMALS */               \
  X(scene, IN, KbFloat2, uvs) SEP             /* by vertex; KB_SHAPE_HAS_UVS */                                  \
  X(scene, IN, KbFloat4, positions) SEP       /* by vertex, as x, y, z, 0 */                                     \
  X(scene, IN, KbTriangle, triangles) SEP                                                                        \
  X(scene, IN, float, area_cdf) SEP                                                                              \
  X(scene, IN, KbEmitter, emitters) SEP                                                                          \
  X(scene, IN, float, emitter_cdf) SEP        /* emitters + 1, with a light tree + 2: FlatScene */               \
  X(scene, IN, KbLightNode, light_nodes) SEP  /* light_tree.h; empty without a tree, as the next two */          \
  X(scene, IN, KbTreeLight, tree_lights) SEP                                                                     \
  X(scene, IN, kb_u32, first_tree_light) SEP  /* by emitter */                                                   \
  X(scene, IN, float, envmap_facings) SEP     /* EnvmapSampling's distributions, as the next two */              \
  X(scene, IN, float, envmap_rows) SEP                                                                           \
  X(scene, IN, float, envmap_columns) SEP                                                                        \
  X(scene, IN, KbMedium, media) SEP                                                                              \
  X(scene, IN, KbFloat2, plume_nodes) SEP     /* temperature, scale */                                           \
  X(scene, IN, kb_u32, interiors) SEP         /* by shape: the medium inside, or KB_NONE; empty without gas */   \
  X(scene, IN, float, filter_cells) SEP       /* tabulated filter: film/signed_filter.hpp */ \
  X(scene, IN, KbFloat2, filter_table) SEP    /* gaussian filter: nodes (value, slope per piece), 1025 of them */ \
  X(scene, IN, float, channel_bins) SEP       /* [spectrum][KB_CHANNEL_BINS]; only with dispersion */            \
  X(scene, IN, kb_u32, sobol) SEP             /* kb_sobol_table */                                               \
  X(scene, IN, KbThermal, thermals)           /* tables and field_offset: into tables */

/* The scene's spectra, tabulated over mu (ChannelTables). */
#define KB_SPECTRA_ARGUMENTS(X, SEP)                                                                             \
  X(spectra, SAME, KbSpectraLayout, layout) SEP                                                                  \
  X(spectra, IN, float, nodes) SEP                                                                               \
  X(spectra, IN, KbChannelTable, tables) SEP  /* by row */                                                       \
  X(spectra, IN, kb_u32, material_rows) SEP   /* by material: its first row of optical constants, or KB_NONE */  \
  X(spectra, IN, KbCover, cover) SEP                                                                             \
  X(spectra, IN, KbCoverBreak, cover_breaks)

/* The acceleration structure. */
#define KB_BVH_ARGUMENTS(X, SEP)                                                                                 \
  X(bvh, IN, KbBvhNode, nodes) SEP                                                                               \
  X(bvh, IN, KbPrimitive, primitives)

/* A round, the paths in flight and what they leave behind. */
#define KB_POOL_ARGUMENTS(X, SEP)                                                                                \
  X(pool, SAME, KbRound, round) SEP                                                                              \
  X(pool, IN, KbRoundPixel, pixels) SEP                                                                          \
  X(pool, IN, float, shared_mu) SEP           /* [block][sample] of the round; not read with per-path wavelengths */ \
  X(pool, OUT, KbPathState, states) SEP       /* by slot, as what follows */                                     \
  X(pool, OUT, KbRay, rays) SEP                                                                                  \
  X(pool, OUT, KbHit, hits) SEP                                                                                  \
  X(pool, OUT, kb_u32, hit_instances) SEP     /* first shape of the instance, or KB_NONE; empty without instances */ \
  X(pool, OUT, KbShadowRay, shadows) SEP                                                                         \
  X(pool, OUT, KbDispersionState, dispersion) SEP  /* only with KB_HAS_DISPERSION */                             \
  X(pool, OUT, KbGasState, gas) SEP           /* empty in scenes without gas */                                  \
  X(pool, OUT, KbTally, tallies) SEP                                                                             \
  X(pool, OUT, KbPathVertex, arena) SEP                                                                          \
  X(pool, OUT, kb_u32, chunk_next) SEP        /* by chunk of the arena */                                        \
  X(pool, OUT, KbSavedPath, saved) SEP        /* by job */                                                       \
  X(pool, OUT, KbFaults, faults)

/* The slots that a launch works on: work-item i < length[0] takes slots[i]. packed: the queue that `compact` fills. The length is
   the device's: launches have as many work-items as the host knows to be enough. */
#define KB_QUEUE_ARGUMENTS(X, SEP)                                                                               \
  X(queue, OUT, kb_u32, slots) SEP                                                                               \
  X(queue, OUT, kb_u32, length) SEP                                                                              \
  X(queue, OUT, kb_u32, packed) SEP                                                                              \
  X(queue, OUT, kb_u32, packed_length) SEP                                                                       \
  X(queue, OUT, kb_u32, ordered) SEP          /* [key][slot of the pool]: shading_order.clh */                   \
  X(queue, OUT, kb_u32, ordered_lengths)      /* by key */

/* What evaluation writes on its way to the film. */
#define KB_EVALUATION_ARGUMENTS(X, SEP)                                                                          \
  X(evaluation, OUT, float, dense) SEP        /* [table][row][stride]: spectra of shared wavelengths */          \
  X(evaluation, OUT, float, tau) SEP          /* [slot][stride], as radiance: the method pt */                   \
  X(evaluation, OUT, float, radiance) SEP                                                                        \
  X(evaluation, OUT, float, partial) SEP      /* [round pixel, or slot][part][D]: derived channels, a part per work-item */ \
  X(evaluation, VALUE, kb_u32, parts)

/* The film on the device (film.clh). */
#define KB_FILM_ARGUMENTS(X, SEP)                                                                                \
  X(film, OUT, float, sum) SEP                                                                                   \
  X(film, OUT, float, compensation) SEP                                                                          \
  X(film, OUT, kb_u32, counts) SEP            /* valid samples of a pixel */                                     \
  X(film, VALUE, kb_u32, pixels) SEP          /* that the film holds */                                          \
  X(film, VALUE, kb_u32, first)               /* film pixel of the round's, or of the packed pixels', pixel 0 */

/* Work on whole films: packed[pixel][K + D] are `pixels` pixels from film_first on. */
#define KB_PACKING_ARGUMENTS(X, SEP)                                                                             \
  X(packing, SAME, KbSpectraLayout, layout) SEP                                                                  \
  X(packing, OUT, float, open) SEP            /* sums of a chunk of samples that goes on */                      \
  X(packing, OUT, float, values) SEP          /* the array that is packed or unpacked: sum, compensation or open */ \
  X(packing, OUT, float, packed) SEP                                                                             \
  X(packing, VALUE, kb_u32, pixels)

/* What the replicates so far have come to: arrays that stand like the film's. */
#define KB_REPLICATES_ARGUMENTS(X, SEP)                                                                          \
  X(replicates, SAME, KbSpectraLayout, layout) SEP                                                               \
  X(replicates, IN, KbFilmPart, parts) SEP                                                                       \
  X(replicates, IN, KbFloat2, weights) SEP    /* of film pixels: of a difference in the mean, of its square in m2 */ \
  X(replicates, OUT, float, mean) SEP                                                                            \
  X(replicates, OUT, float, m2) SEP           /* if there are variances */                                       \
  X(replicates, OUT, float, sums) SEP         /* [part][film column]: of the replicate's samples, */             \
  X(replicates, OUT, float, lost) SEP         /* and what rounding has lost of them */                           \
  X(replicates, VALUE, kb_u32, first_part) SEP                                                                   \
  X(replicates, VALUE, kb_u32, end_part) SEP                                                                     \
  X(replicates, VALUE, kb_u32, variance)

/* What the rays through the centres of width x height pixels from (x0, y0) on see. */
#define KB_AUXILIARY_ARGUMENTS(X, SEP)                                                                           \
  X(auxiliary, OUT, KbAuxiliary, out) SEP                                                                        \
  X(auxiliary, OUT, KbFaults, faults) SEP                                                                        \
  X(auxiliary, VALUE, kb_u32, x0) SEP                                                                            \
  X(auxiliary, VALUE, kb_u32, y0) SEP                                                                            \
  X(auxiliary, VALUE, kb_u32, width) SEP                                                                         \
  X(auxiliary, VALUE, kb_u32, count)

/* The groups of each kernel, in the order of its parameters: X(GROUP, Group).
     path        reset_pool, generate, closest_hits, shade, any_hits, shadow_walks, whole_bounces,
                 compact, add_tallies
     auxiliary   auxiliary
     evaluation  resample_rows, dpept_batch, dpept_path, derived_add; pt_update, pt_derived, which have a queue
     film        film_clear, film_close, film_pack, film_unpack, film_finish
     replicates  replicate_fold */
#define KB_PATH_KERNEL(X, SEP) \
  X(SCENE, Scene) SEP X(SPECTRA, Spectra) SEP X(BVH, Bvh) SEP X(POOL, Pool) SEP X(QUEUE, Queue)
#define KB_AUXILIARY_KERNEL(X, SEP) X(SCENE, Scene) SEP X(BVH, Bvh) SEP X(AUXILIARY, Auxiliary)
#define KB_EVALUATION_KERNEL(X, SEP)                                                                             \
  X(SCENE, Scene) SEP X(SPECTRA, Spectra) SEP X(POOL, Pool) SEP X(EVALUATION, Evaluation) SEP X(FILM, Film) SEP  \
  X(QUEUE, Queue)
#define KB_FILM_KERNEL(X, SEP) X(FILM, Film) SEP X(PACKING, Packing)
#define KB_REPLICATES_KERNEL(X, SEP) X(FILM, Film) SEP X(REPLICATES, Replicates)

// clang-format on
#endif
