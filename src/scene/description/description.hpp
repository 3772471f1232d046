// SceneDescription: the scene as the user wrote it, checked and loaded; what the reader produces and flattening reads.
#pragma once

#include <array>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/diagnostics.hpp"
#include "scene/image/image.hpp"
#include "scene/image/spectral_image.hpp"
#include "scene/mesh/mesh.hpp"
#include "shared/principled.h"
#include "spectral/channels.hpp"
#include "spectral/spectrum.hpp"

namespace kiloband {

/// Column-major as glm has it; maps local to parent coordinates.
using Transform = glm::dmat4;

// ---- textures ----
enum class WrapMode { kRepeat, kMirror, kClamp };

/// The largest radiance of a scene: Planck's law reaches 4e10 W m^-2 sr^-1 nm^-1 at kMaxTemperatureK, the sun has 3e4. Of irradiance and
/// intensity too.
inline constexpr double kMaxEmission = 1e15;

struct BitmapTexture {
  std::string id;
  SourcePosition position;
  std::filesystem::path file;
  std::shared_ptr<const Image> image;
  bool nearest = false;
  WrapMode wrap = WrapMode::kRepeat;
  bool raw = false;  // values are taken as they are: spectrally flat; of 3 channels numbers and normals alone
  glm::dmat3 to_uv{1.0};
};

struct CheckerboardTexture {
  std::string id;
  SourcePosition position;
  Spectrum color0 = Spectrum::constant(0.4);
  Spectrum color1 = Spectrum::constant(0.2);
  glm::dmat3 to_uv{1.0};
};

/// Texels are spectra: those of an image's bands, or mixtures of endmembers whose weights are
/// the image's values.
struct SpectralBitmapTexture {
  std::string id;
  SourcePosition position;
  std::shared_ptr<const SpectralImage> image;
  std::vector<Spectrum> endmembers;  // as many as the image has values; empty: the values are bands
  bool extrapolate = false;          // bands: the end values continue beyond the outermost edges
  bool nearest = false;
  WrapMode wrap = WrapMode::kRepeat;
  glm::dmat3 to_uv{1.0};
};

/// Values at the vertices or faces of the mesh that has the material or lamp: vertex_NAME or face_NAME, as Mitsuba names them. Three are a
/// colour, one is flat; times scale.
struct MeshAttributeTexture {
  std::string id;
  SourcePosition position;
  std::string name;
  double scale = 1;
};

/// A spectral parameter. For emission a bitmap is upsampled per texel and multiplied by D65 as in Mitsuba; a
/// spectral bitmap is taken as it is.
using Texture =
    std::variant<Spectrum, std::shared_ptr<const BitmapTexture>, std::shared_ptr<const CheckerboardTexture>,
                 std::shared_ptr<const SpectralBitmapTexture>, std::shared_ptr<const MeshAttributeTexture>>;

// ---- BSDFs ----
enum class Microfacet { kBeckmann, kGgx };

struct Roughness {
  Microfacet distribution = Microfacet::kBeckmann;
  double alpha_u = 0.1;
  double alpha_v = 0.1;
  /// Instead of the numbers: values over the surface, of colours the luminance. One image for both is isotropic.
  std::shared_ptr<const BitmapTexture> map_u, map_v;
  bool sample_visible = true;
};

struct DiffuseBsdf {
  Texture reflectance = Spectrum::constant(0.5);
};
/// roughness absent: smooth. eta 0, k 1 is the perfect mirror (F = 1).
struct ConductorBsdf {
  Spectrum eta = Spectrum::constant(0);
  Spectrum k = Spectrum::constant(1);
  Texture specular_reflectance = Spectrum::constant(1);
  std::optional<Roughness> roughness;
  std::string material;  // whose index it is, as the scene names it; empty: given by numbers
};
/// Indices are spectra; both constant: no dispersion. thin: a pane without thickness, seen from outside on both
/// sides, smooth; what it reflects and transmits has been reflected in it any number of times.
struct DielectricBsdf {
  Spectrum int_ior = Spectrum::constant(1.5046);
  Spectrum ext_ior = Spectrum::constant(1.000277);
  Texture specular_reflectance = Spectrum::constant(1);
  Texture specular_transmittance = Spectrum::constant(1);
  std::optional<Roughness> roughness;
  std::string material;           // inside, as the scene names it; empty: given by a number
  std::optional<Spectrum> int_k;  // that its file gives; nothing absorbs here
  bool thin = false;
};
struct PlasticBsdf {
  Texture diffuse_reflectance = Spectrum::constant(0.5);
  Texture specular_reflectance = Spectrum::constant(1);
  double int_ior = 1.49;
  double ext_ior = 1.000277;
  bool nonlinear = false;
  std::optional<Roughness> roughness;
};

/// A number of a material, or a bitmap of them: values over the surface, of colours the luminance.
struct MappedNumber {
  double number = 0;
  std::shared_ptr<const BitmapTexture> map;
};

/// The model and its numbers: shared/principled.h.
struct PrincipledBsdf {
  Texture base_color = Spectrum::constant(0.5);
  std::array<MappedNumber, KB_PRINCIPLED_LUMINANCE> numbers;  // by KbPrincipledNumber
  std::array<double, KB_PRINCIPLED_NUMBERS - KB_PRINCIPLED_RATES> rates{1, 1, 1, 1};
  bool thin = false;
};

/// To the other side of its surface.
inline bool passes_light(const PrincipledBsdf& bsdf) {
  const MappedNumber& trans = bsdf.numbers[KB_PRINCIPLED_SPEC_TRANS];
  const MappedNumber& metallic = bsdf.numbers[KB_PRINCIPLED_METALLIC];
  return bsdf.thin || ((trans.map || trans.number > 0) && (metallic.map || metallic.number < 1));
}

/// Nothing but a boundary between media: rays go on as if it were not there.
struct NullBsdf {};

struct Bsdf;
/// back absent: the front is used on both sides.
struct TwoSidedBsdf {
  std::shared_ptr<const Bsdf> front;
  std::shared_ptr<const Bsdf> back;
};
/// opacity: a constant (the mean of a spectrum over the guide bands) or a bitmap read as one channel.
struct MaskBsdf {
  Texture opacity = Spectrum::constant(0.5);
  std::shared_ptr<const Bsdf> nested;
};

/// (1 - weight) first + weight second. weight: as a mask's opacity.
struct BlendBsdf {
  Texture weight = Spectrum::constant(0.5);
  std::shared_ptr<const Bsdf> first, second;
};

/// The nested bsdf in a shading frame that a texture turns: by the slope of heights, or to normals that it has. nested:
/// scatters by itself (no twosided, mask or blend: these are moved outwards).
struct BumpedBsdf {
  std::shared_ptr<const BitmapTexture> texture;
  bool normals = false;  // 2 rgb - 1, in the shading frame; else heights
  double scale = 1;      // of heights: m
  bool flip = true;      // invalid normals
  bool shadow = true;    // Estevez, Lecocq, Fajardo 2019
  bool around_two_sided = false;
  std::shared_ptr<const Bsdf> nested;
};

struct Bsdf {
  std::string id;  // for messages; empty if unnamed
  SourcePosition position;
  std::variant<DiffuseBsdf, ConductorBsdf, DielectricBsdf, PlasticBsdf, PrincipledBsdf, TwoSidedBsdf,
               MaskBsdf, BlendBsdf, BumpedBsdf, NullBsdf>
      model;
};

// ---- media ----
/// Temperature and scale at the nodes of a lattice that spans [0, 1]^3 of the local
/// coordinates; linear between.
struct GridField {
  std::array<uint32_t, 3> nodes{};  // along x, y, z, at least 2 each
  struct Node {
    float temperature_k, scale;
  };
  std::vector<Node> values;  // x varies fastest
  Transform to_world{1.0};
};
/// A round jet along local +Z from z = 0 to z = length; see shared/plume.h.
struct JetField {
  double temperature_k = 0;  // on the axis at z = 0
  double ambient_k = 0;
  double radius = 0;  // width at z = 0, m
  double spread = 0;  // growth of the width per metre
  double length = 0;  // m
  Transform to_world{1.0};
};

/// How the lines of a gas are met by the wavelength that a channel has on a path.
enum class GasSpectrum {
  kSampled,     // the coefficient at that very wavelength
  kCorrelatedK  // the coefficients of a channel in ascending order over mu
};

/// A gas: absorbs and emits, does not scatter.
struct Medium {
  std::string id;
  SourcePosition position;
  Spectrum absorption;  // 1/m at scale 1
  double scale = 1;
  std::optional<double> temperature_k;  // homogeneous; absent: does not emit
  GasSpectrum spectrum = GasSpectrum::kSampled;
  std::variant<std::monostate, GridField, JetField> field;  // none: homogeneous
};

// ---- emitters ----
struct AreaEmitter {
  Texture radiance;  // W m^-2 sr^-1 nm^-1, on the normal side
};
/// Emission by Kirchhoff's law, eps(lambda, theta) B(lambda, T): T is a constant,
/// an image or a property of vertices.
struct ThermalEmitter {
  double temperature_k = 0;                      // where neither of the following is given
  std::shared_ptr<const BitmapTexture> texture;  // one channel, raw values in K; or null
  std::string attribute;                         // vertex property in K; or empty
};
struct ConstantEmitter {
  Spectrum radiance;
};
struct EnvmapEmitter {
  std::shared_ptr<const Image> image;  // linear RGB lat-long
  std::filesystem::path file;
  double scale = 1;
  Transform to_world{1.0};
};
struct SpectralEnvmapEmitter {
  std::shared_ptr<const SpectralImage> image;  // lat-long
  double scale = 1;
  Transform to_world{1.0};
};
struct PointEmitter {
  Spectrum intensity;  // W sr^-1 nm^-1
  glm::dvec3 position{0};
};
struct SpotEmitter {
  Spectrum intensity;       // on the axis
  double cutoff_angle = 0;  // rad
  double beam_width = 0;    // rad
  /// A picture over the square around the cone that the intensity is multiplied by; a spectral bitmap is the intensity.
  std::optional<Texture> texture;
  Transform to_world{1.0};
};
struct ProjectorEmitter {
  Texture irradiance;  // W m^-2 nm^-1; a bitmap is spectrally flat, or times D65
  bool d65 = false;
  double scale = 1;  // pi times it and the irradiance are what a plane at distance 1 gets
  double tan_half_x = 0, tan_half_y = 0;
  Transform to_world{1.0};
};
struct DirectionalEmitter {
  Spectrum irradiance;            // W m^-2 nm^-1 on a plane perpendicular to direction
  glm::dvec3 direction{0, 0, 1};  // of propagation, unit, world
  double angular_radius = 0;      // rad, of the disc that the light comes from; 0: a single direction
};

/// Emitters other than area lights.
struct Emitter {
  std::string id;
  SourcePosition position;
  std::variant<ConstantEmitter, EnvmapEmitter, SpectralEnvmapEmitter, PointEmitter, SpotEmitter,
               ProjectorEmitter, DirectionalEmitter>
      model;
};

// ---- shapes ----
/// Vertices in local coordinates.
struct MeshShape {
  std::shared_ptr<const Mesh> mesh;
};
/// Canonical: radius 1 at the origin (centre and radius are folded into to_world; scale is uniform, checked).
struct SphereShape {};
struct DiskShape {};      // radius 1 in z = 0, normal +Z
struct CylinderShape {};  // radius 1 about z from 0 to 1, no caps, normals outward (p0, p1, radius folded in)

struct Shape {
  std::string id;
  SourcePosition position;
  Transform to_world{1.0};
  bool flip_normals = false;
  std::shared_ptr<const Bsdf> bsdf;  // never null: the default is filled in
  std::optional<AreaEmitter> emitter;
  std::optional<ThermalEmitter> thermal;   // never together with `emitter`
  SourcePosition emitter_position;         // of either
  std::shared_ptr<const Medium> interior;  // null: none
  std::variant<MeshShape, SphereShape, DiskShape, CylinderShape> geometry;
};

struct ShapeGroup;

/// A group of shapes, put into the scene (or into another group) once more.
struct Instance {
  std::string id;
  SourcePosition position;
  Transform to_world{1.0};
  std::shared_ptr<const ShapeGroup> group;  // never null
};

/// Shapes that are in the scene only where instances put them. None of them emits on its own or bounds a medium.
struct ShapeGroup {
  std::string id;
  SourcePosition position;
  std::vector<Shape> shapes;
  std::vector<Instance> instances;   // of other groups
  bool has_analytic_shapes = false;  // or one of the groups has: spheres, disks, cylinders
};

// ---- sensor, film, integrator ----
enum class FilterType { kBox, kTent, kGaussian, kMitchell, kLanczos };

struct Film {
  uint32_t width = 768;
  uint32_t height = 576;
  uint32_t crop_x = 0, crop_y = 0;           // offset of the crop window, pixels
  uint32_t crop_width = 0, crop_height = 0;  // size of the rendered image; the reader fills in the default
  FilterType filter = FilterType::kBox;
  double filter_radius = 0.5;                     // pixels
  double filter_stddev = 0.5;                     // gaussian
  double filter_b = 1.0 / 3, filter_c = 1.0 / 3;  // mitchell
  /// bandfilm's channels, or a specfilm's constant responses as channels; empty: the program's default.
  ChannelList channels;
  /// specfilm responses that are not constant inside their range (or not 1): named, summed from sub-channels.
  /// These are the channels without a name, after the named ones: between all knots of all responses,
  /// at most 5 nm wide.
  std::vector<std::pair<std::string, Spectrum>> responses;
};

struct PerspectiveSensor {
  double fov_x = 0;  // rad, full angle across the film's width (fov_axis is resolved against the full film)
};
struct ThinLensSensor {
  double fov_x = 0;
  double aperture_radius = 0;  // m
  double focus_distance = 0;   // m
};
struct OrthographicSensor {};

struct Sensor {
  SourcePosition position;
  Transform to_world{1.0};
  double near_clip = 0.01, far_clip = 1e4;
  double principal_point_x = 0, principal_point_y = 0;
  std::variant<PerspectiveSensor, ThinLensSensor, OrthographicSensor> model;
  Film film;
  uint64_t sample_count = 4;
};

/// How next-event estimation chooses lights.
enum class LightSelection {
  kAutomatic,  // by the light tree where it pays: from 16 lights on, triangles counted
  kPower,      // by their power
  kTree        // by the light tree (shared/light_tree.h), if there are two lights for it
};

struct Integrator {
  int max_depth = -1;  // -1: unlimited; 1: emission only
  int rr_depth = 5;
  bool hide_emitters = false;
  LightSelection light_selection = LightSelection::kAutomatic;
};

/// What the scene's integrators add to the image.
struct RequestedImages {
  bool variance = false;               // of the mean
  std::vector<std::string> auxiliary;  // depth, normal, object: as --aov names them
};

struct SceneDescription {
  std::filesystem::path file;
  std::vector<Shape> shapes;
  std::vector<Instance> instances;
  std::vector<Emitter> emitters;
  /// What every shape without an emitter of its own has, and what is seen where there is nothing
  /// and no environment.
  std::optional<double> ambient_temperature_k;
  SourcePosition ambient_position;
  std::shared_ptr<const Medium> atmosphere;  // outside all shapes; null: none
  Sensor sensor;
  Integrator integrator;
  RequestedImages requested;
};

}  // namespace kiloband
