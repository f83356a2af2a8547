#include "generate/canvas.h"

#include "generate/shaping.h"

#include <algorithm>
#include <cmath>
#include <numbers>

// NOLINTBEGIN(readability-identifier-naming): stb's own names
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
// NOLINTEND(readability-identifier-naming)
#include <stb_image_write.h>

namespace limber::content {
namespace {

uint8_t ToByte(double value) {
  return static_cast<uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

void Append(void* context, void* data, int size) {
  auto* bytes = static_cast<std::vector<uint8_t>*>(context);
  const auto* from = static_cast<const uint8_t*>(data);
  bytes->insert(bytes->end(), from, from + size);
}

}  // namespace

Colour Hex(uint32_t rgb) {
  return {(rgb >> 16 & 255) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0, 1};
}

void Cover(const Colour& paint, double coverage, Colour* ground) {
  const double over = std::clamp(coverage, 0.0, 1.0) * paint[3];
  const double alpha = over + (*ground)[3] * (1 - over);
  if (alpha <= 0) return;
  ground->head<3>() =
      (paint.head<3>() * over + ground->head<3>() * ((*ground)[3] * (1 - over))) / alpha;
  (*ground)[3] = alpha;
}

double Inside(double distance, double softness) {
  return 1 - SmoothStep(-softness / 2, softness / 2, distance);
}

void SetPixel(const Colour& colour, int x, int y, Image* image) {
  uint8_t* pixel = &image->rgba[4 * (static_cast<size_t>(y) * image->width + x)];
  for (int c = 0; c < 4; ++c)
    pixel[c] = ToByte(colour[c]);
}

Image Paint(int width, int height, int samples,
            const std::function<Colour(double, double)>& colour) {
  Image image;
  image.width = width;
  image.height = height;
  image.rgba.resize(4 * static_cast<size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Colour sum = Colour::Zero(), plain = Colour::Zero();
      for (int i = 0; i < samples * samples; ++i) {
        const int column = i % samples, row = i / samples;
        Colour sample = colour(x + (column + 0.5) / samples, y + (row + 0.5) / samples);
        plain += sample;
        sample.head<3>() *= sample[3];
        sum += sample;
      }
      // Colours count by their alpha; where nothing is opaque, the plain mean keeps edges clean.
      if (sum[3] > 0) {
        sum.head<3>() /= sum[3];
      } else {
        sum.head<3>() = plain.head<3>() / (samples * samples);
      }
      sum[3] /= samples * samples;
      SetPixel(sum, x, y, &image);
    }
  }
  return image;
}

std::vector<uint8_t> EncodePng(const Image& image) {
  const size_t num_pixels = static_cast<size_t>(image.width) * image.height;
  bool opaque = true;
  for (size_t i = 0; i < num_pixels; ++i)
    opaque = opaque && image.rgba[4 * i + 3] == 255;
  const int channels = opaque ? 3 : 4;
  std::vector<uint8_t> pixels;
  pixels.reserve(channels * num_pixels);
  for (size_t i = 0; i < num_pixels; ++i) {
    for (int c = 0; c < channels; ++c)
      pixels.push_back(image.rgba[4 * i + c]);
  }
  std::vector<uint8_t> bytes;
  stbi_write_png_compression_level = 64;  // longer searches for matches: a seventh smaller
  stbi_write_png_to_func(Append, &bytes, image.width, image.height, channels, pixels.data(),
                         channels * image.width);
  return bytes;
}

double SegmentDistance(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  return TaperDistance(p, a, b, 0, 0);
}

double TaperDistance(const Vector2d& p, const Vector2d& a, const Vector2d& b, double radius_a,
                     double radius_b) {
  const Vector2d along = b - a;
  const double t = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - a - t * along).norm() - Mix(radius_a, radius_b, t);
}

double EllipseDistance(const Vector2d& p, const Vector2d& centre, const Vector2d& radii) {
  const Vector2d q = p - centre;
  const double k0 = q.cwiseQuotient(radii).norm();
  const double k1 = q.cwiseQuotient(radii.cwiseAbs2()).norm();
  return k1 > 0 ? k0 * (k0 - 1) / k1 : -radii.minCoeff();
}

double TriangleDistance(const Vector2d& p, const Vector2d& a, const Vector2d& b,
                        const Vector2d& c) {
  const Vector2d corner[3] = {a, b, c};
  double edge = 1e30, outside = -1e30;
  for (int k = 0; k < 3; ++k) {
    const Vector2d from = corner[k], along = corner[(k + 1) % 3] - from;
    edge = std::min(edge, SegmentDistance(p, from, corner[(k + 1) % 3]));
    outside = std::max(outside, along.y() * (p - from).x() - along.x() * (p - from).y());
  }
  return outside > 0 ? edge : -edge;
}

double ArcDistance(const Vector2d& p, const Vector2d& centre, double radius, double from,
                   double to) {
  const Vector2d q = p - centre;
  double angle = std::atan2(q.y(), q.x());
  const double middle = (from + to) / 2;
  while (angle < middle - std::numbers::pi)
    angle += 2 * std::numbers::pi;
  while (angle > middle + std::numbers::pi)
    angle -= 2 * std::numbers::pi;
  angle = std::clamp(angle, from, to);
  return (q - radius * Vector2d(std::cos(angle), std::sin(angle))).norm();
}

}  // namespace limber::content
