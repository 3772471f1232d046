// Records of device-side spectra: how rows of channel tables are numbered, and how many channels cover a wavelength.
#ifndef KILOBAND_SHARED_SPECTRA_LAYOUT_H
#define KILOBAND_SHARED_SPECTRA_LAYOUT_H

#include "shared/lang.h"

/* Rows 0 .. S-1 are the scene's spectra; then come the unit emission, the wavelengths of textures, the optical
   constants of materials, and at the end one row per derived channel. */
typedef struct {
  kb_u32 channels;       /* K */
  kb_u32 stride;         /* floats between rows: K rounded up to a multiple of 16 */
  kb_u32 rows;           /* of all kinds */
  kb_u32 unit_row;       /* width_k / channel_scale_k: emission of 1 W m^-2 sr^-1 nm^-1 */
  kb_u32 wavelength_row; /* clamp(lambda_k, 360, 830) - KB_TEXTURE_CENTRE_NM, nm */
  kb_u32 derived_row;    /* first of the derived channels' rows: response times channel_scale_k / derived scale */
  kb_u32 derived;        /* D */
  kb_u32 overlapping;    /* 0: every wavelength is covered once, KbCover is not read */
  kb_u32 film_width;     /* of the full film, pixels */
  kb_u32 film_columns;   /* floats of a film pixel: stride, and D rounded up to a multiple of 16 */
  kb_u32 lambda_row;     /* lambda_k, nm; 0xffffffff where the scene has no plume */
  kb_u32 reserved;
} KbSpectraLayout;
KB_STATIC_ASSERT(sizeof(KbSpectraLayout) == 48, spectra_layout_size);

/* Texture parabolas are expanded around this wavelength, so that their terms stay small in float. */
#define KB_TEXTURE_CENTRE_NM 595.0f

/* How many channels m have min_m <= lambda < max_m (at least 1) at the wavelength of channel k: `cover` at mu = 0,
   and from each break's mu on that break's cover. Breaks of channel k: [first of k, first of k + 1), ascending. */
typedef struct {
  kb_u32 first;
  kb_u32 cover;
} KbCover;
KB_STATIC_ASSERT(sizeof(KbCover) == 8, cover_size);

typedef struct {
  float mu;
  kb_u32 cover;
} KbCoverBreak;
KB_STATIC_ASSERT(sizeof(KbCoverBreak) == 8, cover_break_size);

#endif
