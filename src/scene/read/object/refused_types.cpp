#include "scene/read/object/refused_types.hpp"

#include <algorithm>
#include <iterator>

namespace kiloband {
namespace {

struct RefusedType {
  std::string_view tag, type, why;
};

constexpr std::string_view kNoPolarisation =
    "light has no polarisation here; 'dielectric', 'conductor' or 'plastic' reflect the same of light that has none";
constexpr std::string_view kNoScattering =
    "nothing scatters in a volume here; 'absorbing' is a medium that absorbs";
constexpr std::string_view kNoCurves = "there are no curves; cylinders or a mesh of them have the same form";
constexpr std::string_view kSamePath = "'path' gives the same image";
constexpr std::string_view kOldLobe =
    "of old files; 'roughconductor', 'roughplastic' or 'principled' come near";

constexpr RefusedType kRefused[] = {
    {"bsdf", "hair", "there is no such model; 'roughdielectric' or 'principled' come near"},
    {"bsdf", "measured",
     "there is no such model; 'roughconductor' and 'principled' have parameters to be fitted"},
    {"bsdf", "measured_polarized", kNoPolarisation},
    {"bsdf", "polarizer",
     "light has no polarisation here; of light that has none it passes half: a 'mask' of opacity 0.5 around a black 'diffuse'"},
    {"bsdf", "retarder", "light has no polarisation here; of light that has none it passes all: 'null'"},
    {"bsdf", "circular",
     "light has no polarisation here; of light that has none it passes half: a 'mask' of opacity 0.5 around a black 'diffuse'"},
    {"bsdf", "pplastic", "light has no polarisation here; 'roughplastic' comes near"},
    {"bsdf", "phong", kOldLobe},
    {"bsdf", "ward", kOldLobe},
    {"bsdf", "hk", "of old files; nothing scatters in a layer here"},
    {"bsdf", "irawan", "of old files; there is no model of cloth"},
    {"bsdf", "coating", "of old files; 'principled' has a clearcoat, 'plastic' a coating of a diffuse base"},
    {"bsdf", "roughcoating",
     "of old files; 'principled' has a clearcoat, 'roughplastic' a coating of a diffuse base"},
    {"bsdf", "roughdiffuse", "of old files; 'diffuse' without roughness, 'principled' with it"},
    {"bsdf", "difftrans", "of old files; 'principledthin' with diff_trans passes diffuse light"},
    {"emitter", "sun", "it is read in files of versions below 2; use sunsky with sky_scale 0"},
    {"emitter", "sky", "it is read in files of versions below 2; use sunsky with sun_scale 0"},
    {"emitter", "timed_sunsky", "nothing moves here; use sunsky, at one time"},
    {"emitter", "directionalarea",
     "no path from a camera finds light of a single direction from an area; Mitsuba 3.9.1's path "
     "integrator renders it black, too"},
    {"shape", "linearcurve", kNoCurves},
    {"shape", "bsplinecurve", kNoCurves},
    {"shape", "hair", kNoCurves},
    {"shape", "sdfgrid", "there are no distance fields; a mesh of the surface is read"},
    {"shape", "ellipsoids", "there are no volumes of splats; a mesh is read"},
    {"shape", "ellipsoidsmesh", "there are no volumes of splats; a mesh is read"},
    {"shape", "heightfield", "of old files; a mesh is read"},
    {"texture", "volume",
     "nothing is looked up in space; a bitmap, or a mesh_attribute of the mesh's vertices, is read"},
    {"texture", "scale", "of old files; the factor can go into the picture"},
    {"texture", "wireframe", "of old files; there is no such texture"},
    {"texture", "gridtexture", "of old files; a 'bitmap' of the lines is read"},
    {"sensor", "irradiancemeter",
     "only cameras with a film; radiance of an even surface with a 'diffuse' of reflectance 1 is its irradiance over pi"},
    {"sensor", "distant", "only cameras with a film; 'orthographic' sees what leaves in one direction"},
    {"sensor", "batch", "one camera a scene; -D can choose among several"},
    {"sensor", "spherical", "of old files; 'perspective' sees up to 180 degrees"},
    {"sensor", "telecentric", "of old files; 'orthographic' is one without a lens"},
    {"sensor", "fluencemeter", "of old files; only cameras with a film"},
    {"film", "ldrfilm", "it is read in files of versions below 2; use hdrfilm, --preview writes PNG"},
    {"film", "mfilm", "of old files; use hdrfilm"},
    {"integrator", "ptracer", "paths begin at the camera here; 'path' gives its image"},
    {"integrator", "stokes", "light has no polarisation here; 'path' gives the first component without it"},
    {"integrator", "depth", "--aov depth gives its image"},
    {"integrator", "direct_projective", "nothing is differentiated; 'direct' has the same image"},
    {"integrator", "prb_projective", "nothing is differentiated; 'path' has the same image"},
    {"integrator", "bdpt", kSamePath},
    {"integrator", "mlt", kSamePath},
    {"integrator", "pssmlt", kSamePath},
    {"integrator", "erpt", kSamePath},
    {"integrator", "photonmapper", kSamePath},
    {"integrator", "ppm", kSamePath},
    {"integrator", "sppm", kSamePath},
    {"integrator", "vpl", kSamePath},
    {"integrator", "irrcache", kSamePath},
    {"integrator", "adaptive", "'path' and --target-error give its image"},
    {"medium", "heterogeneous", kNoScattering},
};

}  // namespace

std::string_view why_refused(std::string_view tag, std::string_view type) {
  // A texture may be written as a <spectrum>.
  const std::string_view kind = tag == "spectrum" ? "texture" : tag;
  const auto found = std::ranges::find_if(
      kRefused, [&](const RefusedType& refused) { return refused.tag == kind && refused.type == type; });
  return found == std::end(kRefused) ? std::string_view{} : found->why;
}

}  // namespace kiloband
