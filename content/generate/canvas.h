// Drawing in code: colours, soft discs and strokes, and pictures as PNG.
#pragma once

#include "generate/character.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace limber::content {

using Colour = Eigen::Vector4d;  // sRGB in [0, 1], straight alpha

// From 0xRRGGBB, opaque.
Colour Hex(uint32_t rgb);

// Lays `paint` over `*ground` with the given coverage in [0, 1].
void Cover(const Colour& paint, double coverage, Colour* ground);

// Coverage of the inside of a signed distance with an edge `softness` wide, centred on the edge.
double Inside(double distance, double softness);

// Fills a picture by `colour(x, y)` of pixel coordinates, averaged over samples x samples places in
// each pixel.
Image Paint(int width, int height, int samples,
            const std::function<Colour(double, double)>& colour);

void SetPixel(const Colour& colour, int x, int y, Image* image);

// The picture as the bytes of a PNG file: RGB where every pixel is opaque, RGBA otherwise.
std::vector<uint8_t> EncodePng(const Image& image);

// Signed distances in the plane, negative inside.
double SegmentDistance(const Vector2d& p, const Vector2d& a, const Vector2d& b);
// A segment with a radius at each end.
double TaperDistance(const Vector2d& p, const Vector2d& a, const Vector2d& b, double radius_a,
                     double radius_b);
// Approximate away from the edge, exact enough for an outline.
double EllipseDistance(const Vector2d& p, const Vector2d& centre, const Vector2d& radii);
// A triangle with rounded corners; corners counter-clockwise.
double TriangleDistance(const Vector2d& p, const Vector2d& a, const Vector2d& b, const Vector2d& c);
// Distance from the arc of the circle (centre, radius) between two angles, radians, from < to.
double ArcDistance(const Vector2d& p, const Vector2d& centre, double radius, double from,
                   double to);

}  // namespace limber::content
