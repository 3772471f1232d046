#include "validation/faults/table.hpp"

#include <algorithm>
#include <iterator>

#include "shared/planted_faults.h"

namespace kiloband::faults {
namespace {

// What should notice a fault. Means and variances are compared by pixel, tile and image.
constexpr std::string_view kMeans = "means of the two backends; closed forms";
constexpr std::string_view kBackends = "means of the two backends";
constexpr std::string_view kTheory = "closed forms alone";
constexpr std::string_view kVariances = "variances of the two backends";
constexpr std::string_view kPixels = "pixel tests";
constexpr std::string_view kTiles = "tile tests";

// clang-format off
constexpr PlantedFault kFaults[] = {
    // ---- film and channels
    {KB_PLANTED_CHANNEL_SHIFT, "channel-shift", kBoth, "channel k of the film gets the values of channel k + 1",
     "spectra that are not flat", "diffuse_room", kMeans},
    {KB_PLANTED_FILM_STALLS, "film-stalls", kBoth, "sums of samples keep 8 bits, never rounded up: small terms are lost",
     "anything; OpenCL: the methods dpept-*", "diffuse_room", kMeans},
    {KB_PLANTED_SAMPLE_DROPPED, "sample-dropped", kBoth,
     "the first sample of a replicate (OpenCL: of a round) is counted, but not added", "anything; OpenCL: the methods dpept-*",
     "diffuse_room", kMeans},
    {KB_PLANTED_TILE_BIAS, "tile-bias", kBoth, "the tile of 8 x 8 pixels at (8, 8) is 1 % too bright",
     "16 x 16 pixels", "diffuse_room", kTiles},
    {KB_PLANTED_PIXEL_BIAS, "pixel-bias", kBoth, "the pixel (9, 13) is 5 % too bright", "16 x 16 pixels", "diffuse_room",
     kPixels},
    {KB_PLANTED_MU_SHORT, "mu-short", kBoth, "wavelength offsets cover [0, 0.95) of each channel", "spectra that are not flat",
     "diffuse_room", kMeans},
    {KB_PLANTED_MU_CENTRE, "mu-centre", kShared, "the wavelength is the channel's centre, for every path",
     "spectra that bend within a channel", "metals", kTheory},
    // ---- random numbers
    {KB_PLANTED_REPLICATES_EQUAL, "replicates-equal", kBoth, "all replicates have the random numbers of the first",
     "two replicates", "diffuse_room", kVariances},
    {KB_PLANTED_SAMPLES_REPEATED, "samples-repeated", kBoth, "every second sample is the one before it once more",
     "anything", "diffuse_room", kVariances},
    {KB_PLANTED_NUMBERS_REUSED, "numbers-reused", kBoth, "directions of all bounces come from the numbers of the first",
     "two bounces", "diffuse_room", kMeans},
    {KB_PLANTED_LENS_NUMBERS, "lens-numbers", kBoth, "the lens is sampled with the numbers of the film position",
     "thin lens", "constant_sky", kBackends},
    // ---- camera
    {KB_PLANTED_FILTER_OFFSET, "filter-offset", kBoth, "film positions are half a pixel to the right", "edges", "diffuse_room",
     kMeans},
    {KB_PLANTED_FILTER_SIGN, "filter-sign", kBoth, "paths have no sign where the reconstruction filter is negative",
     "mitchell, catmullrom or lanczos filter", "mitchell", kMeans},
    {KB_PLANTED_METER_CONE, "meter-cone", kShared, "radiance meters see a cone of one degree", "radiancemeter", "meter", kTheory},
    // ---- what is read
    {KB_PLANTED_MERGE_LAST, "merge-last", kShared, "the last of merged shapes is left out", "merge", "stored_otherwise", kTheory},
    {KB_PLANTED_STRIP_WINDING, "strip-winding", kShared, "every second triangle of a strip shows its back",
     "PLY file with triangle strips", "stored_otherwise", kTheory},
    {KB_PLANTED_CREASES_SMOOTH, "creases-smooth", kShared, "normals are smoothed over creases", "max_smooth_angle",
     "stored_otherwise", kTheory},
    {KB_PLANTED_MIXTURE_WEIGHTS, "mixture-weights", kShared, "weights of mixtures are in the reverse order", "mixturebsdf",
     "stored_otherwise", kTheory},
    // ---- paths
    {KB_PLANTED_DEPTH_SHORT, "depth-short", kBoth, "the last bounce is missing", "max_depth", "diffuse_room", kMeans},
    {KB_PLANTED_ROULETTE, "roulette", kBoth, "survivors of Russian roulette are not weighted up", "rr_depth below max_depth",
     "unlimited_depth", kMeans},
    {KB_PLANTED_TWO_SIDED, "two-sided", kBoth, "the normal is not turned behind two-sided surfaces: they are black there",
     "twosided", "sheets", kMeans},
    {KB_PLANTED_BUMP_SLOPE, "bump-slope", kBoth, "the slope of bump maps along v has the wrong sign", "bumpmap", "bumps", kMeans},
    {KB_PLANTED_INSTANCE_NORMAL, "instance-normal", kBoth, "vertex normals of instances are not turned into the world", "instances", "instances",
     kMeans},
    {KB_PLANTED_ATTRIBUTE_CORNERS, "attribute-corners", kBoth, "values at a triangle's second vertex get the weight of its third, and the reverse",
     "mesh_attribute of vertices", "attributes", kMeans},
    // ---- lights
    {KB_PLANTED_LIGHT_PDF, "light-pdf", kBoth, "the density of light samples is 0.5 % too large", "light samples", "diffuse_room",
     kMeans},
    {KB_PLANTED_LIGHT_SKIPPED, "light-skipped", kBoth, "the last light is never sampled, but MIS counts on it", "a light",
     "glowing_shapes", kMeans},
    {KB_PLANTED_LIGHT_AREA, "light-area", kBoth, "areas of lights are 1 % too large in densities",
     "area lights that are no spheres", "diffuse_room", kMeans},
    {KB_PLANTED_LIGHT_BACK, "light-back", kBoth, "area lights are seen from behind", "the back of an area light",
     "glowing_shapes", kMeans},
    {KB_PLANTED_LIGHT_HIDDEN, "light-hidden", kBoth, "hidden lights shine through what hides them", "shadows; no gas",
     "diffuse_room", kMeans},
    {KB_PLANTED_INVERSE_SQUARE, "inverse-square", kBoth, "point and spot lights fall off with the distance, not its square",
     "point or spot light", "delta_lights", kMeans},
    {KB_PLANTED_ENVMAP_SINE, "envmap-sine", kBoth, "the density of environment maps lacks sin theta of the Jacobian",
     "environment map", "envmap", kMeans},
    {KB_PLANTED_TRIANGLE_WARP, "triangle-warp", kShared, "points on triangles are not uniform", "area light that is a mesh",
     "diffuse_room", kTheory},
    {KB_PLANTED_MIS_DOUBLE, "mis-double", kBoth, "BSDF samples that meet a light have MIS weight 1", "lights with an area",
     "diffuse_room", kMeans},
    {KB_PLANTED_MIS_SELECTION, "mis-selection", kBoth,
     "MIS weights of BSDF samples forget that lights are chosen: they do not sum to 1", "two area lights", "glowing_shapes",
     kMeans},
    {KB_PLANTED_TREE_AT_HITS, "tree-at-hits", kBoth,
     "lights are chosen by the light tree, but MIS weights of BSDF samples count with their power", "16 lights", "many_lights", kMeans},
    {KB_PLANTED_FACING_AT_HITS, "facing-at-hits", kBoth,
     "environment maps are sampled for the facing of receivers, but MIS weights of BSDF samples count on those of any facing", "environment map",
     "envmap", kMeans},
    {KB_PLANTED_SUN_MISSED, "sun-missed", kBoth, "rays that escape do not meet suns, but MIS of light samples counts on it",
     "directional light with an angular_radius", "suns", kMeans},
    {KB_PLANTED_PICTURE_MIRRORED, "picture-mirrored", kBoth, "pictures of spots and projectors are mirrored from left to right",
     "spot with a texture, projector", "projected_lights", kMeans},
    // ---- scattering
    {KB_PLANTED_COSINE, "missing-cosine", kBoth, "diffuse reflection of light samples lacks the cosine", "diffuse", "diffuse_room",
     kMeans},
    {KB_PLANTED_BSDF_WEIGHT, "bsdf-weight", kBoth, "diffuse BSDF samples weigh 0.5 % too much (their density is too small)",
     "diffuse, two bounces", "diffuse_room", kMeans},
    {KB_PLANTED_MIXTURE_PDF, "mixture-pdf", kBoth, "the density of rough plastic ignores its specular lobe", "roughplastic",
     "plastics", kMeans},
    {KB_PLANTED_ROUGHNESS_SQUARED, "roughness-squared", kBoth, "alpha is squared", "rough metal, glass or plastic", "metals",
     kBackends},
    {KB_PLANTED_ROUGHNESS_AXES, "roughness-axes", kBoth, "the map of alpha_u is taken for both axes", "a texture as alpha_u or alpha_v",
     "roughness_maps", kMeans},
    {KB_PLANTED_SCHLICK_POWER, "schlick-power", kBoth, "(1 - cos)^4 instead of (1 - cos)^5", "principled materials", "principled",
     kMeans},
    {KB_PLANTED_TINTED_ROOT, "tinted-root", kBoth, "refracted light has the base colour instead of its root", "principled spec_trans",
     "principled", kMeans},
    {KB_PLANTED_FRESNEL_NK, "fresnel-nk", kBoth, "n and k are exchanged", "metal", "metals", kMeans},
    {KB_PLANTED_REFRACTION_INVERTED, "refraction-inverted", kBoth, "rays bend away where they should bend towards the normal",
     "smooth dielectric", "glasses", kMeans},
    {KB_PLANTED_RADIANCE_SCALING, "radiance-scaling", kBoth, "radiance is not scaled by the index where rays leave glass",
     "smooth dielectric", "glasses", kMeans},
    {KB_PLANTED_TOTAL_REFLECTION, "total-reflection", kBoth, "total reflection counts as transmission, and is lost",
     "smooth dielectric seen from inside", "lenses", kMeans},
    // ---- dispersion
    {KB_PLANTED_CHANNELS_GO_ON, "channels-go-on", kBoth, "all channels go on behind a degradation", "smooth dispersive dielectric",
     "prism", kMeans},
    {KB_PLANTED_CHANNEL_PROBABILITY, "channel-probability", kBoth, "the surviving channel is not divided by its probability",
     "smooth dispersive dielectric", "prism", kMeans},
    {KB_PLANTED_CHANNEL_EVEN, "channel-even", kBoth, "the surviving channel is divided by 1 / K, however it was chosen",
     "smooth dispersive dielectric, coloured surfaces", "prism", kMeans},
    {KB_PLANTED_CHANNEL_INDEX, "channel-index", kBoth, "refraction goes by the index of the next channel",
     "smooth dispersive dielectric", "prism", kMeans},
    {KB_PLANTED_HERO_DEFENSIVE, "hero-defensive", kBoth, "spectral MIS leaves the defensive part out of its density",
     "rough dispersive dielectric", "rough_dispersion", kMeans},
    // ---- spectra and textures
    {KB_PLANTED_SPECTRUM_NEAREST, "spectrum-nearest", kBoth, "tables of spectra give the nearest entry", "tabulated spectra",
     "diffuse_room", kMeans},
    {KB_PLANTED_TEXTURE_ROWS, "texture-rows", kBoth, "rows of bitmaps are in the wrong order", "bitmap", "pictures", kMeans},
    {KB_PLANTED_TEXTURE_UNFILTERED, "texture-unfiltered", kBoth, "bilinear lookups give one texel", "bilinear bitmap", "pictures",
     kBackends},
    // ---- thermal emission and gas
    {KB_PLANTED_EMISSIVITY_WAVELENGTH, "emissivity-wavelength", kShared, "emissivity 1 - rho is that of 25 nm below",
     "thermal emission of a coloured surface", "thermal", kTheory},
    {KB_PLANTED_PLANCK_SECOND, "planck-second", kBoth, "the second constant of Planck's law is rounded to 0.0144 m K",
     "thermal emission without temperature field", "thermal", kMeans},
    {KB_PLANTED_GAS_SHADOW, "gas-shadow", kBoth, "light samples are not attenuated by gas", "gas and lights", "gases", kMeans},
    {KB_PLANTED_GAS_FIRST, "gas-first", kBoth, "gas does not emit between the camera and the first surface", "hot gas, no plume",
     "gases", kMeans},
    {KB_PLANTED_GAS_HIDDEN, "gas-hidden", kBoth, "null boundaries hide light samples", "lights behind null boundaries", "gases", kMeans},
};
// clang-format on
static_assert(std::size(kFaults) + 1 == KB_PLANTED_COUNT, "every fault is in the table");

}  // namespace

std::span<const PlantedFault> planted_faults() {
  return kFaults;
}

const PlantedFault* find_fault(std::string_view name) {
  const auto place = std::ranges::find(kFaults, name, &PlantedFault::name);
  return place == std::end(kFaults) ? nullptr : place;
}

const PlantedFault* find_fault(uint32_t number) {
  const auto place = std::ranges::find(kFaults, number, &PlantedFault::number);
  return place == std::end(kFaults) ? nullptr : place;
}

}  // namespace kiloband::faults
