// Records of device-side spectra: how rows of channel tables are numbered, and how many channels cover a wavelength.
#ifndef KILOBAND_SHARED_SPECTRA_LAYOUT_H
#define KILOBAND_SHARED_SPECTRA_LAYOUT_H

#include "shared/lang.h"

/* Rows 0 .. S-1 are the scene's spectra; then come the unit emission, the wavelengths of textures, the optical
   constants of materials, the positions of channels in band sets, and at the end one row per derived channel. */
typedef struct {
  kb_u32 channels;       /* K */
  kb_u32 stride;         /* floats between rows: K rounded up to a multiple of 16 */
  kb_u32 rows;           /* of all kinds */
  kb_u32 unit_row;       /* width_k / channel_scale_k: emission of 1 W m^-2 sr^-1 nm^-1 */
  kb_u32 wavelength_row; /* clamp(lambda_k, 360, 830) - KB_TEXTURE_CENTRE_NM, nm */
  kb_u32 derived_row;    /* first row of derived channels: response times channel_scale_k / derived scale */
  kb_u32 derived;        /* D */
  kb_u32 overlapping;    /* 0: every wavelength is covered once, KbCover is not read */
  kb_u32 film_width;     /* of the full film, pixels */
  kb_u32 film_columns;   /* floats of a film pixel: stride, and D rounded up to a multiple of 16 */
  kb_u32 band_row;       /* per band set three rows: a band's number, bands from there on, unit (0 outside) */
  kb_u32 planck_row;     /* five rows for Planck's law at any temperature (KB_PLANCK_*), or 0xffffffff */
  kb_u32 lambda_row;     /* lambda_k, nm; 0xffffffff where the scene has no plume */
  kb_u32 reserved[3];
} KbSpectraLayout;
KB_STATIC_ASSERT(sizeof(KbSpectraLayout) == 64, spectra_layout_size);

/* Rows of channels that do not depend on mu, but for one: lowest wavelength as a sum of two floats and width, nm;
   mu itself; log2 of channel_scale, an integer. */
#define KB_PLANCK_MIN_HIGH 0u
#define KB_PLANCK_MIN_LOW 1u
#define KB_PLANCK_WIDTH 2u
#define KB_PLANCK_MU 3u
#define KB_PLANCK_LOG2_SCALE 4u
#define KB_PLANCK_ROWS 5u

/* Channels are put into this many bins to choose the one that survives a dispersive refraction: bin b holds the channels
   k with k * KB_CHANNEL_BINS / K == b, some hold none if K is smaller. */
#define KB_CHANNEL_BINS 16u
KB_FN kb_u32 kb_channel_bin_begin(kb_u32 bin, kb_u32 channels) {
  return (kb_u32)(((kb_u64)bin * channels + (KB_CHANNEL_BINS - 1u)) / KB_CHANNEL_BINS);
}

/* The part of the probability that is shared evenly by all channels. */
#define KB_EVEN_CHANNELS 0.1f

/* Of derived channels: width_k times the sum of 1 / width_m over the channels m that have min_m <= lambda < max_m at the
   wavelength of channel k (at least 1): `divisor` at mu = 0, and from each break's mu on that break's. Breaks of channel k:
   [first of k, first of k + 1), ascending. */
typedef struct {
  kb_u32 first;
  float divisor;
} KbCover;
KB_STATIC_ASSERT(sizeof(KbCover) == 8, cover_size);

typedef struct {
  float mu;
  float divisor;
} KbCoverBreak;
KB_STATIC_ASSERT(sizeof(KbCoverBreak) == 8, cover_break_size);

#endif
