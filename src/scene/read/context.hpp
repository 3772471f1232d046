// What the readers of all entities share: the tree, loaded files, entities that several objects refer to.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "scene/description/description.hpp"
#include "scene/read/object/object.hpp"

namespace kiloband {

struct ReadContext {
  SceneTree& tree;
  const DiagnosticSink& sink;
  std::optional<std::pair<uint32_t, uint32_t>> film_size;  // see ReadOptions
  std::map<const Node*, std::shared_ptr<const Bsdf>> bsdfs;
  std::map<const Node*, Texture> textures;                    // bitmaps and checkerboards
  std::map<std::string, std::shared_ptr<const Mesh>> meshes;  // by file and options
  std::map<std::pair<std::filesystem::path, bool>, std::shared_ptr<const Image>> images;  // by file and raw
  /// By file and whether its values are weights.
  std::map<std::pair<std::filesystem::path, bool>, std::shared_ptr<const SpectralImage>> spectral_images;
  std::map<const Node*, std::shared_ptr<const Medium>> media;
  std::map<const Node*, std::shared_ptr<const ShapeGroup>> groups;  // null: being read
  /// Spectra and textures that passed the checks of their use (SpectrumUse): what many objects
  /// refer to is read once.
  std::map<std::pair<const Node*, int>, Texture> checked = {};
  std::map<std::pair<std::filesystem::path, int>, Spectrum> spectrum_files = {};  // by file and use
  std::set<const Node*> without_uvs = {};  // textures on meshes without texture coordinates: told of once

  /// The existing file that a parameter names.
  /// throws InputError at its value
  std::filesystem::path file(const ObjectReader& object, std::string_view parameter);
  std::shared_ptr<const Image> image(const std::filesystem::path& file, bool raw, const Place& place);
  std::shared_ptr<const SpectralImage> spectral_image(const std::filesystem::path& file, bool weights,
                                                      const Place& place);
};

/// Runs a loader; its InputError gets the scene's position in front.
template <typename Loader>
auto load_at(const Place& place, Loader&& loader) {
  try {
    return loader();
  } catch (const InputError& error) {
    fail(place, error.what());
  }
}

/// How bare numbers and colours are understood, and what values are allowed.
enum class SpectrumUse {
  kReflectance,  // numbers flat, colours upsampled, all in [0, 1]
  kEmission,     // radiance: numbers and colours times D65, all >= 0
  kIrradiance,   // the same of a directional light
  kIntensity,    // the same of point and spot lights
  kAny,          // of an object that others refer to: what it is used as is not known yet
  kColour,       // numbers flat, colours of at most 1 upsampled as reflectances, all >= 0: `srgb`
  kQuantity,  // numbers flat, colours upsampled as a multiple of one of at most 0.5, all >= 0: sensor responses
  kIndex,     // the same, in files without a unit: n and k
  kAbsorption  // the same in 1/m; files may be in 1/cm
};

bool is_emission(SpectrumUse use);
/// The spectrum in a file.
/// throws InputError  see read_spectrum_file()
Spectrum read_used_file(ReadContext& context, const std::filesystem::path& file, SpectrumUse use);

/// A spectral parameter; `fallback` where the file has none.
/// throws InputError  wrong kind, value out of range with its wavelength
Spectrum read_spectrum(ReadContext& context, const ObjectReader& object, std::string_view name,
                       SpectrumUse use, const Spectrum& fallback);
/// The same where bitmaps and checkerboards are allowed as well.
/// throws InputError  also a raw bitmap of three channels: what is raw are numbers, not colours
Texture read_texture(ReadContext& context, const ObjectReader& object, std::string_view name, SpectrumUse use,
                     const Texture& fallback);
/// Any spectrum or texture element or parameter. `label` is for messages.
Texture read_texture_node(ReadContext& context, Node& parameter, const std::string& label, SpectrumUse use);
/// throws InputError at `place`  "label 0.3 at 550 nm: must be ..." for the first value that `use` forbids,
///                               or the largest if that is beyond the limit (limits.hpp)
void check_spectrum(const Spectrum& spectrum, const std::string& label, SpectrumUse use, const Place& place);

/// A <spectrum> or <texture> object whose type is a spectrum; nullopt for texture types.
std::optional<Texture> read_spectrum_object(ReadContext& context, Node& node, SpectrumUse use);
/// A <texture type="bitmap">, checkerboard or spectral_bitmap.
Texture read_texture_object(ReadContext& context, Node& node);
/// A checkerboard of two numbers, where a number is wanted, as a bitmap of 2 x 2 texels; null for any other texture. As in Mitsuba 3.9.1
/// color1 is where its colours have color0.
std::shared_ptr<const BitmapTexture> number_board(const Texture& texture);
/// A share from 0 to 1, one number for all wavelengths or a bitmap of them: of colours their luminance, of other spectra the mean of
/// their data, with a warning.
Texture read_share(ReadContext& context, const ObjectReader& object, const std::string& name,
                   const Texture& fallback);
/// A <texture type="spectral_bitmap">.
Texture read_spectral_bitmap(ReadContext& context, const ObjectReader& object);
/// throws InputError  values or mixtures above 1, endmembers that describe emission
void check_spectral_reflectance(const SpectralBitmapTexture& texture, const std::string& label,
                                const Place& place);
/// throws InputError  values above kMaxEmission, of a checkerboard of colours, too
void check_emission_texture(const Texture& texture, const std::string& label, const Place& place);
/// throws InputError  pixels of an image that, times `scale`, are above kMaxEmission
void check_emission_image(const Image& image, const std::filesystem::path& file, double scale,
                          const std::string& label, const Place& place);
void check_emission_image(const SpectralImage& image, double scale, const std::string& label,
                          const Place& place);
/// throws InputError  a bitmap or checkerboard with values above 1
void check_reflectance_texture(const Texture& texture, const std::string& label, const Place& place);

std::shared_ptr<const Bsdf> read_bsdf(ReadContext& context, Node& node);
std::shared_ptr<const Medium> read_medium(ReadContext& context, Node& node);
/// The medium inside a shape, or null.
/// throws InputError  a medium that is not named "interior"
std::shared_ptr<const Medium> read_interior(ReadContext& context, const ObjectReader& shape);
Shape read_shape(ReadContext& context, Node& node);
/// The shapes in a <shape type="merge">, which says that they may be stored together: it has no other meaning.
/// throws InputError  none, or groups and instances
std::vector<Node*> merged_shapes(Node& node);
/// A <shape type="shapegroup">; the same node is read once.
/// throws InputError  it has no shapes, shapes that emit or bound a medium, or contains itself
std::shared_ptr<const ShapeGroup> read_shape_group(ReadContext& context, Node& node);
/// A <shape type="instance">.
/// throws InputError  not one group, or a transform that its spheres, disks or cylinders cannot have
Instance read_instance(ReadContext& context, Node& node);
AreaEmitter read_area_emitter(ReadContext& context, Node& node);
ThermalEmitter read_thermal_emitter(ReadContext& context, Node& node);
/// <emitter type="thermal"> directly under the scene.
/// throws InputError  it is not one number
double read_ambient_temperature(ReadContext& context, Node& node);
/// throws InputError  `shape` has no such vertex property, or values that are no temperatures
void check_temperatures(ReadContext& context, const Shape& shape, const std::string& label,
                        const Place& place);
/// Mitsuba's weight for choosing lights: checked, with a note.
void accept_sampling_weight(const ReadContext& context, const ObjectReader& object);
/// An <emitter> of the scene; of type sunsky the sky and the sun.
std::vector<Emitter> read_emitters(ReadContext& context, Node& node);
/// The transform of an emitter that is not a surface.
/// throws InputError  to_world shears, or scales differently along its axes
Transform rotation_and_position(const ObjectReader& object);
/// Full angle across an image's width, rad, from fov and fov_axis or focal_length. aspect: width over height
double read_fov(const ObjectReader& object, double aspect);
Sensor read_sensor(ReadContext& context, Node& node);
Film read_film(ReadContext& context, Node& node);
/// What a sensor without <film> has.
Film default_film(const ReadContext& context);
struct ReadIntegrator {
  Integrator integrator;
  uint64_t splitting =
      1;  // how many of our samples one of the scene's samples stands for (`direct` splits each)
  RequestedImages requested;
};

ReadIntegrator read_integrator(ReadContext& context, Node& node);
/// The samples per pixel of a <sampler>.
uint64_t read_sampler(ReadContext& context, Node& node);

/// Columns 0 to 2 have equal length and are perpendicular, within 1e-4: rotation, uniform scale, mirroring.
bool is_similarity(const glm::dmat3& m);

/// Accepts parameters of old files that no longer mean anything: one warning each.
void accept_obsolete(const ReadContext& context, const ObjectReader& object,
                     std::initializer_list<std::string_view> names);

}  // namespace kiloband
