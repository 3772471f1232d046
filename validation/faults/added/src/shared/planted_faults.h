// Faults that are planted on purpose, one at a time, to see whether the validation suite finds them: their
// numbers and the macros that ask for them. validation/faults has the table that says what each does,
// and how to add one.
//
// This file and what asks for faults are in the copy of the sources that scripts/plant_faults.sh makes, and nowhere
// else:
//
//   if (KB_PLANTED(DEPTH_SHORT)) ...               code of one backend: src_cpu, kernels
//   if (KB_PLANTED_OPENCL(MU_SHORT)) ...           the OpenCL backend's part on the host: src_gpu
//   if (KB_PLANTED_SHARED(TRIANGLE_WARP)) ...      what both backends use: src, src/shared
//
// shared/lang.h includes it there, so that code with faults need not.
//
// On the host they compare with the faults that are selected for the process
// (validation/faults/selection.hpp). A program of kernels is compiled for one fault,
// -DKB_PLANTED_SELECTED=number (src_gpu/device/program.cpp), which is therefore part of the key in the cache of
// programs.
//
// KB_FAULT_* of shared/pipeline.h are something else: what goes wrong on devices.
#ifndef KILOBAND_SHARED_PLANTED_FAULTS_H
#define KILOBAND_SHARED_PLANTED_FAULTS_H

enum KbPlantedFault {
  KB_PLANTED_NONE = 0,
  /* film and channels */
  KB_PLANTED_CHANNEL_SHIFT,
  KB_PLANTED_FILM_STALLS,
  KB_PLANTED_SAMPLE_DROPPED,
  KB_PLANTED_TILE_BIAS,
  KB_PLANTED_PIXEL_BIAS,
  KB_PLANTED_MU_SHORT,
  KB_PLANTED_MU_CENTRE,
  /* random numbers */
  KB_PLANTED_REPLICATES_EQUAL,
  KB_PLANTED_SAMPLES_REPEATED,
  KB_PLANTED_NUMBERS_REUSED,
  KB_PLANTED_LENS_NUMBERS,
  /* camera */
  KB_PLANTED_FILTER_OFFSET,
  KB_PLANTED_FILTER_SIGN,
  KB_PLANTED_METER_CONE,
  /* what is read */
  KB_PLANTED_MERGE_LAST,
  KB_PLANTED_STRIP_WINDING,
  KB_PLANTED_CREASES_SMOOTH,
  KB_PLANTED_MIXTURE_WEIGHTS,
  /* paths */
  KB_PLANTED_DEPTH_SHORT,
  KB_PLANTED_ROULETTE,
  KB_PLANTED_TWO_SIDED,
  KB_PLANTED_BUMP_SLOPE,
  KB_PLANTED_INSTANCE_NORMAL,
  KB_PLANTED_ATTRIBUTE_CORNERS,
  /* lights */
  KB_PLANTED_LIGHT_PDF,
  KB_PLANTED_LIGHT_SKIPPED,
  KB_PLANTED_LIGHT_AREA,
  KB_PLANTED_LIGHT_BACK,
  KB_PLANTED_LIGHT_HIDDEN,
  KB_PLANTED_INVERSE_SQUARE,
  KB_PLANTED_ENVMAP_SINE,
  KB_PLANTED_TRIANGLE_WARP,
  KB_PLANTED_MIS_DOUBLE,
  KB_PLANTED_MIS_SELECTION,
  KB_PLANTED_TREE_AT_HITS,
  KB_PLANTED_FACING_AT_HITS,
  KB_PLANTED_SUN_MISSED,
  KB_PLANTED_PICTURE_MIRRORED,
  /* scattering */
  KB_PLANTED_COSINE,
  KB_PLANTED_BSDF_WEIGHT,
  KB_PLANTED_MIXTURE_PDF,
  KB_PLANTED_ROUGHNESS_SQUARED,
  KB_PLANTED_ROUGHNESS_AXES,
  KB_PLANTED_SCHLICK_POWER,
  KB_PLANTED_TINTED_ROOT,
  KB_PLANTED_FRESNEL_NK,
  KB_PLANTED_REFRACTION_INVERTED,
  KB_PLANTED_RADIANCE_SCALING,
  KB_PLANTED_TOTAL_REFLECTION,
  /* dispersion */
  KB_PLANTED_CHANNELS_GO_ON,
  KB_PLANTED_CHANNEL_PROBABILITY,
  KB_PLANTED_CHANNEL_EVEN,
  KB_PLANTED_CHANNEL_INDEX,
  KB_PLANTED_HERO_DEFENSIVE,
  /* spectra and textures */
  KB_PLANTED_SPECTRUM_NEAREST,
  KB_PLANTED_TEXTURE_ROWS,
  KB_PLANTED_TEXTURE_UNFILTERED,
  /* thermal emission and gas */
  KB_PLANTED_EMISSIVITY_WAVELENGTH,
  KB_PLANTED_PLANCK_SECOND,
  KB_PLANTED_GAS_SHADOW,
  KB_PLANTED_GAS_FIRST,
  KB_PLANTED_GAS_HIDDEN,
  KB_PLANTED_COUNT
};

#if defined(KB_PLANTED_SELECTED) /* a program of kernels */

#define KB_PLANTED(fault) (KB_PLANTED_SELECTED == KB_PLANTED_##fault)
#define KB_PLANTED_SHARED(fault) KB_PLANTED(fault)

#elif defined(KILOBAND_FAULTS) /* the host, in a build with faults */

/* Selected for the process, KB_PLANTED_NONE or another: in the CPU backend, in the OpenCL backend,
   in what both use. */
extern unsigned kb_planted_cpu, kb_planted_opencl, kb_planted_shared;
#define KB_PLANTED(fault) (kb_planted_cpu == KB_PLANTED_##fault)
#define KB_PLANTED_OPENCL(fault) (kb_planted_opencl == KB_PLANTED_##fault)
#define KB_PLANTED_SHARED(fault) (kb_planted_shared == KB_PLANTED_##fault)
#define KB_PLANTED_NUMBER kb_planted_cpu
#define KB_PLANTED_OPENCL_NUMBER kb_planted_opencl
#define KB_PLANTED_SHARED_NUMBER kb_planted_shared

#else /* a program of kernels for which none is selected; a build of the copy without KILOBAND_FAULTS */

#define KB_PLANTED(fault) 0
#define KB_PLANTED_OPENCL(fault) 0
#define KB_PLANTED_SHARED(fault) 0
#define KB_PLANTED_NUMBER 0
#define KB_PLANTED_OPENCL_NUMBER 0
#define KB_PLANTED_SHARED_NUMBER 0

#endif
#endif
