// Texture coordinates for a closed surface, and a picture painted over it.
#pragma once

#include "generate/canvas.h"
#include "generate/surface.h"

#include <array>
#include <functional>
#include <vector>

namespace limber::content {

// A surface cut into charts, each flat enough to be projected along an axis. Vertices on a cut
// appear once per chart.
struct Atlas {
  std::vector<uint32_t> surface_vertex;  // per atlas vertex: the surface's vertex it copies
  std::vector<Vector2d> pixels;          // per atlas vertex: place in the picture, y downwards
  std::vector<uint32_t> triangles;       // atlas vertices, in the surface's triangle order
  int num_charts = 0;
  double pixels_per_unit = 0;
};

// Cuts and packs into width x height pixels. `part(p)` numbers the body parts, so that no chart
// runs from a limb in front of the body onto the body behind it; `scale(chart axis)` is the share
// of detail that charts facing +x, -x, +y, -y, +z, -z get.
Atlas MakeAtlas(const Surface& surface, const std::function<int(const Vector3d&)>& part,
                const std::array<double, 6>& scale, int width, int height);

// Paints `colour` of points of the surface into the atlas's part of `image`, a few pixels beyond
// the edges of the charts as well, so that no seam shows. Pixels that no chart reaches stay.
void PaintAtlas(const Surface& surface, const Atlas& atlas,
                const std::function<Colour(const Vector3d&)>& colour, Image* image);

}  // namespace limber::content
