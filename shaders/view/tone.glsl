// From scene-linear light to what is stored in the target, whose texels are sRGB codes.

// Straight up to a knee, then an exponential shoulder: colours of a picture stay as painted, and
// highlights roll off as on film instead of clipping.
vec3 ToneMap(vec3 light) {
  const float knee = 0.62;
  const vec3 over = max(light - knee, 0.0);
  const vec3 shoulder = knee + (1.0 - knee) * (1.0 - exp(-over / (1.0 - knee)));
  return mix(light, shoulder, greaterThan(light, vec3(knee)));
}

// The power of 1/2.4 as a sum of square roots of square roots (least maximal error over the curve,
// a hundredth of a code): powers are dear where the "GPU" is a processor.
vec3 EncodeSrgb(vec3 linear_color) {
  const vec3 half_power = sqrt(linear_color), quarter = sqrt(half_power), eighth = sqrt(quarter);
  const vec3 high = 0.6423548 * half_power + 0.7121232 * quarter - 0.3368753 * eighth -
                    0.0175595 * linear_color;
  return mix(12.92 * linear_color, high, greaterThan(linear_color, vec3(0.0031308)));
}

// Even, deterministic noise in 0..1 (interleaved gradients: neighbours differ, no clumps).
float PixelNoise(vec2 pixel) {
  return fract(52.9829189 * fract(dot(floor(pixel), vec2(0.06711056, 0.00583715))));
}

// Half a step of noise hides the bands of soft gradients.
vec3 Dithered(vec3 encoded, vec2 pixel) { return encoded + (PixelNoise(pixel) - 0.5) / 255.0; }

vec3 ToTarget(vec3 linear_color, vec2 pixel) {
  return Dithered(EncodeSrgb(clamp(linear_color, 0.0, 1.0)), pixel);
}
