#include "pictures/readers/row_input.hpp"

namespace kiloband {

void name_channels(PictureInput::Spec& spec, int count) {
  spec.channels = count < 3 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  if (count % 2 == 1) return;
  spec.alpha_channel = count - 1;
  spec.channels.emplace_back("A");
}

}  // namespace kiloband
