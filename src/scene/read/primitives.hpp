// Rectangle and cube as meshes in local coordinates.
#pragma once

#include "scene/mesh/mesh.hpp"

namespace kiloband {

/// [-1,1]^2 in z = 0, normal +Z, uv = ((x+1)/2, (y+1)/2).
Mesh make_rectangle();
/// [-1,1]^3, normals outward. Each face has four vertices of its own and uv over [0,1]^2 as in Mitsuba 3.9.1 (what it shows of
/// pictures): seen from outside, u goes clockwise to v. Vertex normals are absent, so that faces are flat.
Mesh make_cube();

}  // namespace kiloband
