// The shapes that scenes are put together from. All have vertex normals (creases at 40 degrees unless
// stated), closed ones look outwards.
#pragma once

#include <functional>
#include <vector>

#include "scenes/generator/mesh.hpp"

namespace kiloband::generator {

using Ring = std::vector<Vec3>;

enum class Ends { kOpen, kCapped, kJoined };  // kJoined: the last ring is followed by the first

struct LoftOptions {
  bool ring_closed = true;
  Ends ends = Ends::kCapped;
  double crease_degrees = 40;
};

/// Skin over rings of equally many points. uv: fraction along the ring, fraction along the rings. Points at
/// equal positions (a pole) are fine. Open skins look along d(ring) x d(loft).
Mesh loft(const std::vector<Ring>& rings, const LoftOptions& options = {});
/// The same without normals, for further deformation.
Mesh loft_raw(const std::vector<Ring>& rings, const LoftOptions& options = {});

/// Surface f over [0, 1]^2, looking along df/du x df/dv.
Mesh grid(int nu, int nv, const std::function<Vec3(double u, double v)>& f, double crease_degrees = 180);

/// A rectangle for a texture, seen upright and not mirrored by whom it looks at; uv (0, 0) at the top left.
Mesh picture(Vec3 top_left, Vec3 right, Vec3 down);

/// Profile (radius, height) turned about the y axis. A profile that starts and ends on the axis gives a
/// closed mesh; one that does not is open, or joined to a ring if `joined`.
Mesh lathe(const std::vector<Vec2>& profile, int segments, bool joined = false, double crease_degrees = 40);

/// A circle of radius(t) swept along a curve, t in [0, 1] by points; the frame does not twist.
Mesh tube(const std::vector<Vec3>& curve, const std::function<double(double t)>& radius, int segments,
          Ends ends = Ends::kCapped);
/// A profile in the plane across the curve, x along `right` at the start.
Mesh sweep(const std::vector<Vec3>& curve, const std::vector<Vec2>& profile, Vec3 right,
           Ends ends = Ends::kCapped, double crease_degrees = 40);
/// Catmull-Rom curve through the points, `steps` pieces each.
std::vector<Vec3> smooth_curve(const std::vector<Vec3>& points, int steps);

/// Box of the given full size about the origin, edges rounded with `radius` in `segments` steps, faces
/// divided `divisions` times.
Mesh rounded_box(Vec3 size, double radius, int segments = 2, int divisions = 1);
/// The same without normals, for deformation.
Mesh rounded_box_raw(Vec3 size, double radius, int segments, int divisions);
/// Cylinder about the y axis between y = 0 and height, edges rounded.
Mesh rounded_cylinder(double radius, double height, double edge, int segments, int edge_segments = 3);
Mesh ball(Vec3 centre, double radius, int segments);

}  // namespace kiloband::generator
