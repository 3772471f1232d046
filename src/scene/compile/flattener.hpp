// The steps of flattening; see flatten.cpp for their order. Internal to src/scene.
#pragma once

#include <map>
#include <memory>
#include <tuple>

#include "scene/compile/extent.hpp"
#include "scene/compile/flat_scene.hpp"
#include "scene/compile/spectra/spectrum_table_builder.hpp"
#include "scene/optics/coating.hpp"

namespace kiloband {

/// Turns a SceneDescription into the arrays of a FlatScene. Shared BSDFs and textures are flattened once.
class Flattener {
 public:
  Flattener(const SceneDescription& description, const CompileOptions& options);
  FlatScene run();

 private:
  // texture/textures.cpp
  uint32_t reference(const Texture& texture, const SpectrumSource& use);
  /// What a bitmap's values stand for; one image used in two ways is flattened twice.
  enum class BitmapUse { kReflectance, kEmission, kPicture, kOpacity, kRoughness, kHeight, kNormals };
  /// height: that a value of 1 stands for (kHeight)
  uint32_t bitmap(const std::shared_ptr<const BitmapTexture>& texture, BitmapUse use, float height = 1);
  static KbFloat4 texel_of(const float* rgb, BitmapUse use, float height);
  float texel_bound(const KbFloat4& texel) const;
  // texture/attributes.cpp
  /// What was compiled of a bsdf for every mesh, or for this one; or null.
  const uint32_t* find_of_mesh(const auto& known, const void* bsdf, auto key) {
    const auto for_all = known.find({bsdf, key, nullptr});
    if (for_all != known.end()) return &for_all->second;
    const auto for_this = known.find({bsdf, key, mesh_});
    if (for_this == known.end()) return nullptr;
    ++mesh_lookups_;
    return &for_this->second;
  }
  /// share: an opacity or a weight, which of a colour is the luminance
  uint32_t mesh_attribute(const std::shared_ptr<const MeshAttributeTexture>& texture,
                          const SpectrumSource& use, bool share = false);
  static KbFloat4 attribute_texel(const std::vector<const std::vector<float>*>& parts, std::size_t at,
                                  double unit, bool share);
  void finish_attribute(const KbTexture& record, std::size_t count, bool emits);
  // texture/spectral_textures.cpp
  uint32_t spectral_bitmap(const std::shared_ptr<const SpectralBitmapTexture>& texture,
                           const SpectrumSource& use);
  uint32_t add_spectral_texture(const SpectralBitmapTexture& texture, const SpectrumSource& use,
                                double scale);
  void add_bands(KbTexture& record, const SpectralBitmapTexture& texture, const SpectrumSource& use,
                 double scale);
  void add_weights(KbTexture& record, const SpectralBitmapTexture& texture, const SpectrumSource& use);
  uint32_t first_value_unit(const SpectralImage& image, const SourcePosition& position);
  void add_spectral_environment(KbEmitter& record, const SpectralEnvmapEmitter& emitter,
                                const SpectrumSource& use);

  // texture/textures.cpp
  uint32_t checkerboard(const std::shared_ptr<const CheckerboardTexture>& texture, const SpectrumSource& use);
  double texture_mean(const Texture& texture);   // over the guide bands; a bitmap's by its texels' values
  double texture_bound(const Texture& texture);  // over guide bands and channels
  uint32_t d65_row();

  // material/materials.cpp
  uint32_t material(const std::shared_ptr<const Bsdf>& bsdf, bool compensated, const std::string& outer_id);
  KbBump bump(const BumpedBsdf& bumped);
  KbRoughness roughness_maps(const Bsdf& scattering);
  KbMaterial make(const DiffuseBsdf& model, const std::string& name, const SourcePosition& position);
  KbMaterial make(const ConductorBsdf& model, const std::string& name, const SourcePosition& position);
  KbMaterial make(const DielectricBsdf& model, const std::string& name, const SourcePosition& position);
  KbMaterial make(const PlasticBsdf& model, const std::string& name, const SourcePosition& position);
  // material/principled.cpp
  KbMaterial make(const PrincipledBsdf& model, const std::string& name, const SourcePosition& position);
  /// The material's table.
  std::vector<float> principled_numbers(const PrincipledBsdf& model, const std::string& name,
                                        const SourcePosition& position);
  void add_principled_maps(const PrincipledBsdf& model);

  // material/surfaces.cpp
  /// heat: of the shape, or KB_NONE. Materials and surfaces with different heat are different.
  uint32_t surface(const std::shared_ptr<const Bsdf>& bsdf, uint32_t heat);
  /// A number, or a reference to a bitmap: a share from 0 to 1.
  void set_share(const Texture& texture, const SpectrumSource& use, uint32_t& ref, float& constant);
  uint32_t new_surface(const std::shared_ptr<const Bsdf>& bsdf, uint32_t heat);
  uint32_t blend(const BlendBsdf& model, const Bsdf& bsdf, uint32_t heat);
  double mean_weight(const KbSurface& blend) const;

  // material/material_tables.cpp
  uint32_t append_table(const std::vector<float>& table);
  const Coating& coating(const KbMaterial& material);
  const std::vector<float>& conductor_bound(const KbMaterial& material);
  void set_tables(KbMaterial& material, const std::vector<float>& compensation);

  // material/thermal.cpp
  /// A temperature: of shapes that have the same, number or field.
  struct Heat {
    double temperature_k = 0;
    uint32_t field = KB_NONE, field_offset = 0;
    double mean_k = 0;  // of a field
  };
  /// Index of the shape's temperature, or KB_NONE where it does not emit by Kirchhoff's law.
  uint32_t heat_of(const Shape& shape);
  uint32_t image_heat(const std::shared_ptr<const BitmapTexture>& image);
  uint32_t vertex_heat(const std::vector<float>& temperatures);
  /// The row of an emissivity times Planck's law; of fields, of the emissivity alone.
  uint32_t emission_row(uint32_t heat, const RegularTable& emissivity, const std::string& name);
  uint32_t black_row(uint32_t heat);
  /// What 1 - a reflectance emits; KB_NONE where that is 0.
  uint32_t complement(uint32_t ref, uint32_t heat);
  uint32_t complement_row(uint32_t row, uint32_t heat);
  uint32_t complement_bitmap(uint32_t index, uint32_t heat);
  uint32_t complement_checkerboard(uint32_t index, uint32_t heat);
  /// The thermal record of a material, or of a black back; KB_NONE where nothing is emitted.
  uint32_t thermal(const std::shared_ptr<const Bsdf>& bsdf, uint32_t material, uint32_t heat);
  uint32_t black(uint32_t heat);
  uint32_t add_thermal(KbThermal record, uint32_t heat);
  KbThermal thermal_of(const KbMaterial& material, const std::string& name, uint32_t heat);
  KbThermal thermal_of_metal(const KbMaterial& material, const std::string& name, uint32_t heat);
  uint32_t nonlinear_complement(const KbMaterial& material, uint32_t heat);
  void check_thermal(const Bsdf& bsdf, const KbMaterial& material) const;
  void warn_of_ratio(const Bsdf& bsdf, const KbMaterial& material) const;
  void require_emission_data(const Texture& texture, const SpectrumSource& use) const;
  /// Returns the compensation table.
  std::vector<float> compensate(KbMaterial& material, const Bsdf& bsdf);
  void add_thermal_emitter(uint32_t shape_index);
  double emissivity_estimate(uint32_t thermal, double lambda_nm) const;
  double side_estimate(const KbSurface& surface, bool front, double lambda_nm) const;
  bool emits(const KbSurface& surface) const;
  double reference_estimate(uint32_t ref, double lambda_nm) const;

  // place.cpp
  /// throws InputError  places and sizes that single precision cannot take
  void check_places();
  void set_origin();
  Transform placed(const Transform& to_world) const;

  // shapes.cpp
  void add_shapes();
  KbShape begin_shape(const Shape& shape, uint32_t heat);
  static void set_transforms(KbShape& record, const Transform& to_world);
  void add_record(const KbShape& record, const Shape& shape, uint32_t heat, const std::string& instance);
  void add_analytic(const Shape& shape, const Transform& to_world, const std::string& instance);
  void add_mesh(KbShape& record, const Shape& shape, const Transform& to_world);
  void add_areas(KbShape& record, const Shape& shape);
  void compute_bounds();

  // instances.cpp
  struct FlatMesh {
    const Shape* shape;
    KbShape record;  // without transforms
    uint32_t heat;
  };
  /// A group whose meshes are stored.
  struct FlatGroup {
    uint32_t index = KB_NONE;  // of FlatScene::groups
    glm::dvec3 middle{0};      // of the group's coordinates: where those of its meshes begin
    std::vector<FlatMesh> meshes;
  };
  void add_instances();
  const FlatGroup& flat_group(const ShapeGroup& group);
  /// to_world: of the scene, m
  void add_instance(const Instance& instance, const Transform& to_world);

  // media.cpp
  void add_media();
  uint32_t medium(const std::shared_ptr<const Medium>& medium, uint32_t boundary);
  uint32_t gas_emission_row(double temperature_k, uint32_t boundary, const std::string& name);
  uint32_t add_medium(const KbMedium& record, const std::string& name, const SourcePosition& position);
  bool refracting_materials(const KbSurface& surface, std::vector<uint32_t>& found) const;
  uint32_t interior(uint32_t shape_index);
  void set_grid(KbMedium& record, const GridField& grid);
  void set_jet(KbMedium& record, const JetField& jet);
  void set_ladder(KbMedium& record) const;

  // emitters.cpp
  void add_emitters();
  void add_ambient_environment();
  void add_suns();
  void add_area_emitter(uint32_t shape_index);
  void add_environment_map(KbEmitter& record, const EnvmapEmitter& emitter, const SpectrumSource& use);
  // projected_lights.cpp
  void add_spot_picture(KbEmitter& record, const SpotEmitter& spot, double solid_angle,
                        const SpectrumSource& use);
  void add_projector(KbEmitter& record, const ProjectorEmitter& projector, const SpectrumSource& use);
  /// A picture times a spectrum, and what it emits if its mean is over `factor`.
  uint32_t picture(const Texture& texture, const Spectrum& light, double factor, const SpectrumSource& use);
  uint32_t bitmap_picture(const std::shared_ptr<const BitmapTexture>& texture, const Spectrum& light,
                          double factor, const SpectrumSource& use);
  uint32_t checkerboard_picture(const CheckerboardTexture& texture, const Spectrum& light, double factor,
                                const SpectrumSource& use);

  // emitters.cpp
  KbEmitter make_emitter(const Emitter& emitter);
  void select_emitters();
  void select_with_tree(std::vector<double> shares);
  // tree_lights.cpp
  std::size_t tree_light_count() const;
  bool wants_light_tree() const;
  double add_light_tree(std::vector<double>& shares);
  void set_channel_scales();

  // camera.cpp
  void set_camera();
  void set_filter();

  // channel_bins.cpp
  void set_channel_bins();
  void add_spares();

  const SceneDescription& in_;
  const CompileOptions& options_;
  FlatScene out_;
  SpectrumTableBuilder spectra_;
  /// By bsdf, heat, and of a bsdf with mesh attributes the mesh.
  std::map<std::tuple<const void*, uint32_t, const void*>, uint32_t> surfaces_;
  std::vector<std::shared_ptr<const Bsdf>> distributed_;  // blends moved outwards: keys of the above
  /// By bsdf, compensation, and of a bsdf with mesh attributes the mesh.
  std::map<std::tuple<const void*, bool, const void*>, uint32_t> materials_;
  const Mesh* mesh_ = nullptr;    // of the shape that is compiled
  std::size_t mesh_lookups_ = 0;  // how often something of it was asked for
  std::map<std::tuple<const void*, const void*, BitmapUse>, uint32_t> attributes_;  // by texture and mesh
  std::map<std::tuple<uint32_t, float, float>, Coating> coatings_;  // by distribution, roughness, index
  std::map<std::pair<uint32_t, uint32_t>, std::vector<float>> conductor_bounds_;  // by rows of n and k
  std::map<std::pair<const void*, bool>, uint32_t> checkerboards_;                // and whether it emits
  std::map<std::pair<const void*, uint32_t>, uint32_t> media_;  // by medium and the boundary's material
  std::vector<Heat> heats_;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> emission_rows_, complements_,
      thermals_;                                    // by what and heat
  std::map<uint32_t, uint32_t> complement_texels_;  // first texel of the complement, by bitmap
  std::map<const void*, uint32_t> image_heats_;
  std::vector<uint32_t> heat_of_shape_;
  std::vector<const Shape*> sources_;  // by shape record
  std::size_t plain_positions_ = 0;    // those that follow are of groups, in coordinates of their own
  GroupExtents group_extents_;
  std::map<const ShapeGroup*, FlatGroup> flat_groups_;
  std::map<const Shape*, uint32_t> interiors_;  // that are not a medium's: of shapes that instances repeat
  std::map<std::tuple<const void*, BitmapUse, float>, uint32_t> bitmaps_;
  std::map<std::pair<const void*, bool>, uint32_t> spectral_bitmaps_;  // by texture and whether it emits
  uint32_t d65_row_ = KB_NONE;
  /// A sum of spectra.
  using WeightedSpectra = std::vector<std::pair<Spectrum, double>>;
  /// Per emitter: the spectrum that stands for its colour and the factor that makes it a power (W/nm);
  /// mixtures have further terms.
  struct EmitterPower {
    Spectrum spectrum;
    double factor;
    WeightedSpectra more = {};
    std::vector<double> by_band = {};  // if not empty: power in each guide band (W) instead
  };
  static EmitterPower scaled_power(const WeightedSpectra& colour, double factor);
  static double band_power(const EmitterPower& power, const Channel& band);  // W

  std::vector<EmitterPower> powers_;
  std::map<uint32_t, WeightedSpectra> texture_colours_;   // of spectral textures: their mean
  std::vector<Spectrum> emission_peaks_;                  // the largest value of spectral textures that emit
  std::map<uint32_t, double> emission_row_factors_;       // largest weight of rows that are endmembers
  uint64_t value_units_ = 0;                              // of spectral texels, see KbTexture::first_value
  std::vector<double> texture_means_, texture_bounds_;    // per bitmap: mean value, largest texel bound
  double raw_emission_peak_ = 0, rgb_emission_peak_ = 0;  // largest texel scale of emitting bitmaps
};

/// Without references and tables.
KbMaterial empty_material(uint32_t type);

/// "bsdf 'wall'", for messages.
std::string describe(const Bsdf& bsdf);

/// KbTexture::first_texel of a bitmap of `count` texels after `before` others.
/// name  the bitmap's, for messages
/// throws InputError  the last texel's index does not fit into 32 bits
uint32_t first_texel_index(std::size_t before, std::size_t count, const SourcePosition& position,
                           const std::string& name);

/// Moved so that the origin, in the scene file's coordinates, is at 0.
Transform placed_at(const std::array<double, 3>& origin, const Transform& to_world);
/// throws InputError  a place or size that single precision cannot take
void check_camera_place(const Sensor& sensor);

/// Row-major 3x4 of an affine transform.
void store_transform(const Transform& transform, float (&out)[12]);
/// Row-major 2x3.
/// The number that a colour is where one is wanted: Rec. 709 with D65's white, as Mitsuba's.
float luminance_of(const float* rgb);

void store_uv_transform(const glm::dmat3& to_uv, float (&out)[6]);
/// to_world and its inverse.
void set_emitter_transforms(KbEmitter& record, const Transform& to_world);

}  // namespace kiloband
