// What the generator writes: meshes and images, byte by byte, little-endian on every machine.
#include <bit>
#include <fstream>
#include <stdexcept>

#include "scenes/generator/image.hpp"
#include "scenes/generator/mesh.hpp"

namespace kiloband::generator {
namespace {

void put_bits(std::string& out, uint32_t bits) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<char>(bits >> shift & 0xff));
}

void put(std::string& out, double value) {
  put_bits(out, std::bit_cast<uint32_t>(static_cast<float>(value)));
}

std::string ply_header(const Mesh& mesh) {
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                       std::to_string(mesh.positions.size()) +
                       "\nproperty float x\nproperty float y\nproperty float z\n"
                       "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.uvs.empty()) header += "property float u\nproperty float v\n";
  return header + "element face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

void save(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

void write_ply(const Mesh& mesh, const std::filesystem::path& file) {
  std::string out = ply_header(mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (const Vec3& v : {mesh.positions[i], mesh.normals[i]}) {
      put(out, v.x);
      put(out, v.y);
      put(out, v.z);
    }
    if (!mesh.uvs.empty()) {
      put(out, mesh.uvs[i].x);
      put(out, mesh.uvs[i].y);
    }
  }
  for (const auto& t : mesh.triangles) {
    out.push_back(3);
    for (const uint32_t v : t) put_bits(out, v);
  }
  save(file, out);
}

void write_image(const Image& image, const std::filesystem::path& file) {
  const std::string size = std::to_string(image.width) + " " + std::to_string(image.height) + "\n";
  const bool is_float = file.extension() == ".pfm";
  std::string out = is_float ? "PF\n" + size + "-1.0\n" : "P6\n" + size + "255\n";
  for (int row = 0; row < image.height; ++row) {
    const int y = is_float ? image.height - 1 - row : row;  // PFM starts at the bottom
    for (int x = 0; x < image.width; ++x) {
      const Vec3 colour = image.at(x, y);
      for (const double c : {colour.x, colour.y, colour.z}) {
        if (is_float) {
          put(out, c);
        } else {
          out.push_back(static_cast<char>(static_cast<int>(clamp(c, 0, 1) * 255 + 0.5)));
        }
      }
    }
  }
  save(file, out);
}

}  // namespace kiloband::generator
