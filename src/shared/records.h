// Records that both backends read: the flattened scene, and the path vertices that deferred evaluation reads.
// Layouts are fixed (sizes are asserted); an index of KB_NONE means "absent".
#ifndef KILOBAND_SHARED_RECORDS_H
#define KILOBAND_SHARED_RECORDS_H

#include "shared/lang.h"

#define KB_NONE 0xffffffffu

/* ---- references to spectra -------------------------------------------------------------------------------------
   A u32: the top two bits say what it is, the rest is an index. A named spectrum is a row of the spectrum table. */
#define KB_REF_SPECTRUM 0x00000000u
#define KB_REF_BITMAP 0x40000000u
#define KB_REF_CHECKERBOARD 0x80000000u
#define KB_REF_KIND_MASK 0xc0000000u
#define KB_REF_INDEX_MASK 0x3fffffffu

/* ---- materials -------------------------------------------------------------------------------------------------- */
enum KbMaterialType {
  KB_MATERIAL_DIFFUSE = 0,
  KB_MATERIAL_CONDUCTOR = 1,
  KB_MATERIAL_ROUGH_CONDUCTOR = 2,
  KB_MATERIAL_DIELECTRIC = 3,
  KB_MATERIAL_ROUGH_DIELECTRIC = 4,
  KB_MATERIAL_PLASTIC = 5,
  KB_MATERIAL_ROUGH_PLASTIC = 6,
  KB_MATERIAL_PRINCIPLED = 7, /* principled.h */
  KB_MATERIAL_COUNT = 8
};

#define KB_MATERIAL_NONLINEAR 1u      /* plastic: colour shifts by internal scattering */
#define KB_MATERIAL_DISPERSIVE 2u     /* dielectric: eta depends on the wavelength: eta_row, ext_row */
#define KB_MATERIAL_SAMPLE_VISIBLE 4u /* rough: sample visible normals */
#define KB_MATERIAL_PERFECT_MIRROR 8u /* conductor: eta 0, k 1, reflectance 1 at every wavelength */
#define KB_MATERIAL_COMPENSATED 16u   /* rough: scaled by 1 / E, its single-scattering albedo (thermal.h) */
#define KB_MATERIAL_GGX 32u           /* rough: the distribution of normals; else Beckmann */
#define KB_MATERIAL_THIN \
  64u /* smooth dielectric: a pane, two boundaries and no inside; principled: a sheet */

/* One leaf BSDF. Spectral quantities are references; scalars that steer sampling are averages over the guide bands. */
typedef struct {
  kb_u32 type;    /* KbMaterialType */
  kb_u32 flags;   /* KB_MATERIAL_* */
  kb_u32 ref_a;   /* diffuse: reflectance; conductor, plastic, dielectric: specular reflectance;
                          principled: base colour */
  kb_u32 ref_b;   /* plastic: diffuse reflectance; dielectric: specular transmittance;
                          compensated conductor: ref_a times the reflectance at normal incidence */
  kb_u32 eta_row; /* index of refraction inside: conductors, dispersive dielectrics; else KB_NONE */
  kb_u32 k_row;   /* conductor: extinction coefficient; else KB_NONE */
  kb_u32 ext_row; /* dispersive: index outside where it depends on the wavelength; KB_NONE: eta_ext */
  float alpha_u;  /* roughness along the tangent */
  float alpha_v;
  float eta;             /* dielectric, plastic: interior over exterior index (guide mean when dispersive) */
  float eta_ext;         /* dispersive: constant exterior index */
  float escape;          /* plastic: of diffuse light from inside, what leaves through the coating; > 0 */
  float specular_weight; /* plastic: probability scale of the specular lobe,
                            s / (s + d) of the guide means, mixed with uniform */
  float bound_a;         /* upper bound of ref_a over guide and rendered channels */
  float bound_b;         /* the same of ref_b; principled: 1, of what is white */
  kb_u32 table;          /* where its tables begin in those of the scene (material_tables.h), or KB_NONE */
} KB_ALIGNED(16) KbMaterial;
KB_STATIC_ASSERT(sizeof(KbMaterial) == 64, material_size);

#define KB_BUMP_FLIP \
  1u /* a normal that turns away from where the path comes from is turned about the surface's */
#define KB_BUMP_SHADOW 2u  /* light that arrives at a flat angle is shadowed by what is not in the geometry */
#define KB_BUMP_OUTSIDE 4u /* around a two-sided bsdf: a bump seen from behind is a dent */

/* What turns the shading normal of a material; src_cpu/geometry/bump-inl.hpp derives it. */
typedef struct {
  kb_u32 texture; /* KB_TEXTURE_NORMALS, or heights in m; KB_NONE: nothing */
  kb_u32 flags;   /* KB_BUMP_* */
} KB_ALIGNED(8) KbBump;
KB_STATIC_ASSERT(sizeof(KbBump) == 8, bump_size);

/* Roughness that varies over the surface of a material: bitmap references, or KB_NONE for its own. */
typedef struct {
  kb_u32 alpha_u_ref, alpha_v_ref;
} KB_ALIGNED(8) KbRoughness;
KB_STATIC_ASSERT(sizeof(KbRoughness) == 8, roughness_size);

#define KB_SURFACE_TRANSMISSIVE 1u /* one material, both sides, not flipped */
#define KB_SURFACE_TWO_SIDED 2u    /* back != KB_NONE: the frame is flipped for directions from below */
#define KB_SURFACE_THERMAL 4u      /* emits by Kirchhoff's law: front_thermal, back_thermal */
#define KB_SURFACE_NULL 8u         /* nothing but the boundary of a medium: rays go on; no materials */
#define KB_SURFACE_BLEND 16u       /* one of two others, chosen by a random number where a ray hits */

/* What a shape's bsdf comes to: the materials of its two sides and its opacity. Of a blend front and back are those of
   its first surface, for images of materials; it has KB_SURFACE_THERMAL if one of the two has, and no opacity. */
typedef struct {
  kb_u32 front;                       /* material index; null surfaces: KB_NONE */
  kb_u32 back;                        /* material index, or KB_NONE: black from behind */
  kb_u32 flags;                       /* KB_SURFACE_* */
  kb_u32 opacity_ref;                 /* bitmap reference, or KB_NONE for the constant */
  float opacity;                      /* 1: no mask */
  kb_u32 front_thermal, back_thermal; /* KB_SURFACE_THERMAL: KbThermal (thermal.h), or KB_NONE */
  kb_u32 first, second;               /* KB_SURFACE_BLEND: surfaces, which may be blends themselves */
  kb_u32 weight_ref;                  /* of the second: bitmap reference, or KB_NONE for the constant */
  float weight;
  kb_u32 reserved;
} KB_ALIGNED(16) KbSurface;
KB_STATIC_ASSERT(sizeof(KbSurface) == 48, surface_size);

/* ---- textures --------------------------------------------------------------------------------------------------
   A texel is (c0, c1, c2, scale): value(lambda) = scale * S((c0 y + c1) y + c2), S(v) = 1/2 + v / (2 sqrt(1 + v^2)),
   with y = clamp(lambda_nm, 360, 830) - KB_TEXTURE_CENTRE_NM: about any other wavelength the terms of saturated colours are a thousand
   times their sum, and no coefficients in single precision would do. A flat texel has c0 = c1 = 0, c2 = 1e10 (S == 1), scale = value. Lookups are
   bilinear in the evaluated spectra, as in Mitsuba 3.

   Spectral texels are `values` floats in an array of their own. KB_TEXTURE_BANDS: the spectrum at the band centres of
   a band set, linear between them. KB_TEXTURE_WEIGHTS: weights of the spectra first_row, first_row + 1 ...; they carry
   the unit of emission themselves. */
#define KB_TEXTURE_CENTRE_NM 595.0f
#define KB_WRAP_REPEAT 0u
#define KB_WRAP_MIRROR 1u
#define KB_WRAP_CLAMP 2u
#define KB_TEXTURE_NEAREST 1u
#define KB_TEXTURE_ENVMAP 2u /* columns repeat, rows clamp, rows align-corners */
#define KB_TEXTURE_BANDS 4u
#define KB_TEXTURE_WEIGHTS 8u
#define KB_TEXTURE_NUMBERS 16u /* no spectra: numbers, which are the bounds; no texels */
#define KB_TEXTURE_NORMALS 32u /* texels are normals: (x, y, z, 1) */
/* Values at the vertices of a mesh: two texels for each row of a triangle, (v0, v1) and (v2, v2), which the weights (1 - fx) (1 - fy) ...
   of a lookup interpolate with fy = b2, fx = b1 / (b0 + b1); with KB_TEXTURE_NEAREST one texel per triangle. */
#define KB_TEXTURE_TRIANGLES 64u
#define KB_TRIANGLES_ACROSS 32768u /* at most side by side */
#define KB_TEXTURE_SPECTRAL (KB_TEXTURE_BANDS | KB_TEXTURE_WEIGHTS)
#define KB_VALUE_UNIT 16u /* floats: spectral texels of a texture begin at a multiple of it */

typedef struct {
  kb_u32 width, height;
  kb_u32 first_texel;    /* into the texel array, row 0 = v 0 = top; 0 of spectral texels and numbers */
  kb_u32 wrap;           /* KB_WRAP_* */
  kb_u32 flags;          /* KB_TEXTURE_* */
  kb_u32 illuminant_row; /* spectrum multiplied on top (D65 for RGB emission), or KB_NONE */
  float to_uv[6];        /* row-major 2x3: uv' = M (u, v, 1) */
  kb_u32 first_bound;    /* into the bounds of texels, in the order of the texels */
  kb_u32 values;         /* spectral texels: floats of one */
  kb_u32 first_row;      /* KB_TEXTURE_BANDS: the band set; KB_TEXTURE_WEIGHTS: row of the first spectrum */
  kb_u32 first_value;    /* spectral texels: where they begin on a device, in units of KB_VALUE_UNIT floats */
} KB_ALIGNED(16) KbTexture;
KB_STATIC_ASSERT(sizeof(KbTexture) == 64, texture_size);

typedef struct {
  kb_u32 ref0, ref1; /* named spectra */
  float to_uv[6];
} KB_ALIGNED(16) KbCheckerboard;
KB_STATIC_ASSERT(sizeof(KbCheckerboard) == 32, checkerboard_size);

/* ---- shapes ----------------------------------------------------------------------------------------------------- */
enum KbShapeType { KB_SHAPE_MESH = 0, KB_SHAPE_SPHERE = 1, KB_SHAPE_DISK = 2, KB_SHAPE_CYLINDER = 3 };

#define KB_SHAPE_FLIP_NORMALS 1u /* turns all normals; spheres: also set by a to_world that mirrors */
#define KB_SHAPE_HAS_NORMALS 2u  /* mesh: interpolated normals */
#define KB_SHAPE_HAS_UVS 4u
#define KB_SHAPE_LIT_BOTH_SIDES 8u /* as a light: both sides are sampled */
#define KB_SHAPE_NULL 16u          /* its surface is KB_SURFACE_NULL */
#define KB_SHAPE_MIRRORED 32u      /* mesh: clockwise seen from its front (before KB_SHAPE_FLIP_NORMALS) */
#define KB_SHAPE_INSTANCED 64u     /* mesh: its vertices are not in the world; to_world puts them there */

/* Whether the normal that the order of a triangle's corners gives points to its back. */
KB_FN bool kb_winding_is_turned(kb_u32 shape_flags) {
  return ((shape_flags & KB_SHAPE_FLIP_NORMALS) != 0u) != ((shape_flags & KB_SHAPE_MIRRORED) != 0u);
}

/* Rectangles and cubes are meshes. Of meshes the matrices matter where KB_SHAPE_INSTANCED. For sphere, disk and cylinder, to_world maps the canonical shape (unit sphere;
   unit disk in z = 0; unit-radius cylinder along z in [0, 1]) to the world. */
typedef struct {
  kb_u32 type;           /* KbShapeType */
  kb_u32 flags;          /* KB_SHAPE_* */
  kb_u32 surface;        /* index into surfaces */
  kb_u32 emitter;        /* area emitter, or KB_NONE */
  kb_u32 first_triangle; /* mesh: into the triangle array (3 vertex indices each, absolute) */
  kb_u32 triangle_count;
  kb_u32 first_cdf;   /* emitting mesh: into area_cdf, triangle_count + 1 entries from 0 to 1; else KB_NONE */
  float area;         /* m^2 */
  float to_world[12]; /* row-major 3x4 */
  float to_object[12];
} KB_ALIGNED(16) KbShape;
KB_STATIC_ASSERT(sizeof(KbShape) == 128, shape_size);

/* ---- emitters --------------------------------------------------------------------------------------------------- */
enum KbEmitterType {
  KB_EMITTER_AREA = 0,
  KB_EMITTER_CONSTANT = 1,
  KB_EMITTER_ENVMAP = 2,
  KB_EMITTER_POINT = 3,
  KB_EMITTER_SPOT = 4,
  KB_EMITTER_DIRECTIONAL = 5,
  KB_EMITTER_THERMAL = 6, /* a shape with a temperature of its own; what it emits is its surface's */
  KB_EMITTER_SUN = 7, /* a directional light with an angular radius; suns are the last emitters of a scene */
  KB_EMITTER_PROJECTOR = 8
};

/* Suns of a scene: a ray that escapes may meet all of them. */
#define KB_MOST_SUNS 16u

typedef struct {
  kb_u32 type;         /* KbEmitterType */
  kb_u32 ref;          /* radiance, intensity or irradiance: spectrum or bitmap reference (per nm) */
  kb_u32 shape;        /* area: shape index */
  float select_pdf;    /* probability that next-event estimation selects this emitter */
  float one_minus_cos; /* sun: of its angular radius */
  float scale; /* sun: radiance over irradiance, 1/sr; projector: irradiance on its image plane over ref */
  float cutoff_angle; /* spot, rad: no light beyond */
  float beam_width;   /* spot, rad: full intensity inside */
  float to_world[12]; /* point, spot: position in the last column; directional, sun: local +Z = propagation */
  /* spot with a picture, projector: x and y scaled so that the picture's borders are at x, y = +-z */
  float to_object[12];
} KB_ALIGNED(16) KbEmitter;
KB_STATIC_ASSERT(sizeof(KbEmitter) == 128, emitter_size);

/* ---- media ------------------------------------------------------------------------------------------------------
   Gases: they absorb and emit, and do not scatter. The absorption coefficient at wavelength lambda is
   S[row](lambda) times the local scale; a column is the integral of the scale along a ray, in m. */
enum KbMediumType {
  KB_MEDIUM_EMPTY = 0, /* no gas: the inside of a glass body in an atmosphere */
  KB_MEDIUM_HOMOGENEOUS = 1,
  KB_MEDIUM_GRID = 2, /* plume: temperature and scale at the nodes of a lattice */
  KB_MEDIUM_JET = 3   /* plume: an analytic jet, see shared/plume.h */
};

#define KB_PLUME_LADDER 4

typedef struct {
  kb_u32 type;                    /* KbMediumType */
  kb_u32 row;                     /* absorption at scale 1, 1/m */
  kb_u32 emit_row;                /* Planck's law at reference_k, or KB_NONE: does not emit */
  float scale;                    /* of all columns */
  float reference_k;              /* temperature of emit_row; the hottest of a plume */
  kb_u32 first_node;              /* grid: into the node array */
  kb_u32 nodes[3];                /* grid: along x, y, z; x varies fastest */
  float temperature_k, ambient_k; /* jet: on the axis at its beginning, and around it */
  float radius, spread, length;   /* jet: in its own coordinates */
  float second[KB_PLUME_LADDER]; /* plume: hc / (k lambda reference_k) at the wavelengths that cells follow */
  kb_u32 reserved[2];
  float to_local[12]; /* world to the jet's coordinates, or to node numbers */
} KB_ALIGNED(16) KbMedium;
KB_STATIC_ASSERT(sizeof(KbMedium) == 128, medium_size);

/* ---- camera ----------------------------------------------------------------------------------------------------- */
#define KB_CAMERA_PERSPECTIVE 0u
#define KB_CAMERA_THINLENS 1u
#define KB_CAMERA_ORTHOGRAPHIC 2u

#define KB_FILTER_BOX 0u
#define KB_FILTER_TENT 1u
#define KB_FILTER_GAUSSIAN 2u
#define KB_FILTER_TABULATED 3u /* may be negative: film/signed_filter.hpp */

/* local +Z views, +Y is up, +X is the image's LEFT. Film position s in [0,1]^2 of the full (uncropped) film, s_y down. */
typedef struct {
  kb_u32 type;                           /* KB_CAMERA_* */
  kb_u32 film_width, film_height;        /* full film, pixels */
  kb_u32 filter;                         /* KB_FILTER_* */
  float filter_radius;                   /* pixels */
  float filter_stddev;                   /* gaussian: pixels */
  float tan_half_fov_x;                  /* perspective: half the image plane's width at distance 1 */
  float principal_x, principal_y;        /* offsets as fractions of the film */
  float near_clip, far_clip;             /* m, along the view direction */
  float aperture_radius, focus_distance; /* thinlens, m */
  kb_u32 reserved0, reserved1, reserved2;
  float to_world[12]; /* row-major 3x4, may scale for orthographic cameras */
  kb_u32 reserved[4];
} KbCamera;
KB_STATIC_ASSERT(sizeof(KbCamera) == 128, camera_size);

#include "shared/path_vertex.h"

#endif
