// <bsdf type="principled"> and "principledthin", and numbers that may be bitmaps.
#pragma once

#include "scene/read/context.hpp"

namespace kiloband {

struct NumberRange {
  double min, max;
  const char* rule;  // "must be from ... to ..."
};

/// The bitmap that a parameter is; null where it is a number or absent.
/// throws InputError  another texture; a value of the image is outside the range
std::shared_ptr<const BitmapTexture> read_number_map(ReadContext& context, const ObjectReader& object,
                                                     std::string_view name, const NumberRange& range);

/// throws InputError  a number outside its range, `eta` together with `specular`
PrincipledBsdf read_principled(ReadContext& context, const ObjectReader& object, bool thin);

}  // namespace kiloband
