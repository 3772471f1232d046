#include "cube/exr/exr_scan.hpp"

#include <OpenEXR/ImfAttribute.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "cube/cube_layout.hpp"
#include "cube/cube_text.hpp"
#include "cube/exr/exr_stream.hpp"

namespace kiloband {
namespace {

constexpr uint32_t kDeepOrMultiPart = 0x800 | 0x1000;  // bits of the version field
constexpr uint32_t kMagic = 20000630;
// No codec of EXR shrinks data by more (zlib reaches 1032); small chunks are allowed anyway.
constexpr uint64_t kMaxCompression = 2000;
constexpr uint64_t kAlwaysAllowedChunk = uint64_t{1} << 26;
constexpr uint64_t kMaxChunk = (uint64_t{1} << 31) - 1;

[[noreturn]] void damaged(const InputFileBytes& file, const std::string& why) {
  throw InputError(file.path().string() + ": not a readable EXR file: " + why);
}

template <class Number>
Number read_number(const InputFileBytes& file, ExrInputStream& stream) {
  Number value = 0;
  if (file.size() < sizeof value || stream.tellg() > file.size() - sizeof value)
    damaged(file, "the file ends too early");
  stream.read(reinterpret_cast<char*>(&value), sizeof value);
  return value;
}

/// A zero-terminated name.
std::string read_name(const InputFileBytes& file, ExrInputStream& stream) {
  constexpr std::size_t kLongest = 255;
  std::string name;
  while (name.size() <= kLongest) {
    const auto letter = read_number<char>(file, stream);
    if (letter == 0) return name;
    name += letter;
  }
  damaged(file, "an attribute's name is too long");
}

/// OpenEXR goes on where a value of its type ends, wherever the stated size says: what follows would be taken
/// for names and sizes of attributes that nobody has checked.
void check_attribute_end(const InputFileBytes& file, ExrInputStream& stream, const std::string& name,
                         const std::string& type, uint32_t size, int version) {
  if (!Imf::Attribute::knownType(type.c_str())) return;
  const uint64_t end = stream.tellg() + size;
  const std::unique_ptr<Imf::Attribute> attribute(Imf::Attribute::newAttribute(type.c_str()));
  attribute->readValueFrom(stream, static_cast<int>(size), version);
  if (stream.tellg() != end)
    damaged(file, "attribute '" + printable(name) + "' does not have the size that it states");
}

/// Walks over the attributes; returns the offset behind the header.
uint64_t walk_header(const InputFileBytes& file, ExrInputStream& stream) {
  if (read_number<uint32_t>(file, stream) != kMagic) damaged(file, "it does not begin as one");
  const auto version = read_number<uint32_t>(file, stream);
  if (version & kDeepOrMultiPart)
    throw InputError(file.path().string() + ": deep and multi-part EXR files cannot be read as cubes");
  Imf::staticInitialize();  // makes the types of attributes known
  for (std::string name = read_name(file, stream); !name.empty(); name = read_name(file, stream)) {
    const std::string type = read_name(file, stream);
    const auto size = read_number<uint32_t>(file, stream);
    const uint64_t begin = stream.tellg();
    if (size > file.size() - begin) damaged(file, "an attribute is larger than the file");
    check_attribute_end(file, stream, name, type, size, static_cast<int>(version));
    stream.seekg(begin + size);
  }
  return stream.tellg();
}

/// Lines that a compression of scan-line files packs together; fixed by the file format.
uint64_t lines_per_chunk(Imf::Compression compression) {
  switch (compression) {
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return 1;
  }
}

/// Bytes of one pixel.
uint64_t check_channels(const InputFileBytes& file, const Imf::Header& header) {
  uint64_t bytes = 0, count = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c, ++count) {
    if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
      throw InputError(file.path().string() + ": channel '" + c.name() +
                       "' is subsampled, which cubes are not");
    bytes += c.channel().type == Imf::HALF ? 2 : 4;
  }
  if (count > 2 * kMaxChannels + kMaxAuxPlanes)
    throw InputError(file.path().string() + ": " + std::to_string(count) + " channels are too many");
  return bytes;
}

uint64_t divide_up(uint64_t a, uint64_t b) {
  return (a + b - 1) / b;
}

/// Image, tile and chunk sizes.
void check_sizes(const InputFileBytes& file, ExrStorage& storage) {
  const Imf::Header& header = storage.header;
  const auto& window = header.dataWindow();
  const int64_t width = int64_t{window.max.x} - window.min.x + 1;
  const int64_t height = int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxImageEdge || height > kMaxImageEdge)
    throw InputError(file.path().string() + ": image size " + std::to_string(width) + "x" +
                     std::to_string(height) + ": must be between 1 and " + std::to_string(kMaxImageEdge));
  const uint64_t bytes_per_pixel = check_channels(file, header);
  uint64_t chunk_width = static_cast<uint64_t>(width), chunk_height = lines_per_chunk(header.compression());
  if (storage.tiled) {
    const Imf::TileDescription& tile = header.tileDescription();
    if (tile.xSize < 1 || tile.ySize < 1) damaged(file, "tiles without pixels");
    storage.tile_width = tile.xSize;
    storage.tile_height = tile.ySize;
    chunk_width = tile.xSize;
    chunk_height = tile.ySize;
  }
  storage.chunks = divide_up(static_cast<uint64_t>(width), chunk_width) *
                   divide_up(static_cast<uint64_t>(height), chunk_height);
  if (chunk_width > kMaxChunk || chunk_height > kMaxChunk || bytes_per_pixel > kMaxChunk)
    damaged(file, "tiles are too large");
  const double chunk = static_cast<double>(chunk_width) * chunk_height * bytes_per_pixel;
  const uint64_t allowed = std::max(kAlwaysAllowedChunk, std::min(kMaxChunk, kMaxCompression * file.size()));
  if (chunk > static_cast<double>(allowed)) damaged(file, "tiles or blocks of lines are too large");
  // Every chunk has an entry in the table (8 bytes) and a head (at least 8).
  if (storage.chunks > file.size() / 16) damaged(file, "the file is too small for its image");
  if (header.compression() == Imf::NO_COMPRESSION &&
      static_cast<double>(width) * static_cast<double>(height) * bytes_per_pixel >
          static_cast<double>(file.size()))
    damaged(file, "the file is too small for its image");
}

/// An entry of 0 is a chunk that was never written; the chunk that lies last must end inside the file.
void check_offsets(const InputFileBytes& file, const ExrStorage& storage, uint64_t table) {
  if (storage.chunks * 8 > file.size() - table) damaged(file, "the file ends too early");
  std::vector<uint64_t> offsets(storage.chunks);
  file.read_at(table, {reinterpret_cast<char*>(offsets.data()), offsets.size() * 8});
  if (std::find(offsets.begin(), offsets.end(), uint64_t{0}) != offsets.end())
    throw InputError(file.path().string() +
                     ": the EXR file is incomplete: parts of the image were never written");
  const uint64_t last = *std::max_element(offsets.begin(), offsets.end());
  const uint64_t head = storage.tiled ? 20 : 8;  // the size of the data is the head's last entry
  uint32_t size = 0;
  const bool head_inside = last < file.size() && head <= file.size() - last;
  if (head_inside) file.read_at(last + head - 4, {reinterpret_cast<char*>(&size), sizeof size});
  if (!head_inside || size > file.size() - last - head)
    throw InputError(file.path().string() + ": the EXR file is incomplete: it ends before its last pixels");
}

}  // namespace

ExrStorage scan_exr(const InputFileBytes& file) {
  ExrInputStream stream(file);
  ExrStorage storage;
  uint64_t table = 0;
  try {
    table = walk_header(file, stream);
    stream.seekg(4);
    int version = read_number<int>(file, stream);
    storage.header.readFrom(stream, version);
    storage.tiled = Imf::isTiled(version);
    if (storage.tiled && !storage.header.hasTileDescription()) damaged(file, "tiles without a size");
    check_sizes(file, storage);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // OpenEXR's
    stream.rethrow_failure();
    damaged(file, error.what());
  }
  check_offsets(file, storage, table);
  return storage;
}

}  // namespace kiloband
