#include "tests/support/cube_files.hpp"

namespace kiloband::test {

void write_cube(const std::filesystem::path& file, uint32_t width, uint32_t height, const ChannelList& bands,
                const BandValue& value, Quantity quantity) {
  CubeInfo info;
  info.width = width;
  info.height = height;
  info.quantity = quantity;
  for (const Channel& band : bands) info.bands.push_back({band, false});
  std::vector<float> integrals;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      for (std::size_t b = 0; b < bands.size(); ++b)
        integrals.push_back(static_cast<float>(value(x, y, b) * bands[b].width_nm()));
  const auto writer = create_cube_writer(file, info, height);
  writer->write_rows({0, height, integrals, {}, {}});
  writer->finish();
}

}  // namespace kiloband::test
