// From scene-linear light to what is stored in the target.
layout(constant_id = LIMBER_VIEW_CONSTANT_ENCODE) const uint kEncode = 1;

// Straight up to a knee, then an exponential shoulder: colours of a picture stay as painted, and
// highlights roll off as on film instead of clipping.
vec3 ToneMap(vec3 light) {
  const float knee = 0.62;
  const vec3 over = max(light - knee, 0.0);
  const vec3 shoulder = knee + (1.0 - knee) * (1.0 - exp(-over / (1.0 - knee)));
  return mix(light, shoulder, greaterThan(light, vec3(knee)));
}

vec3 EncodeSrgb(vec3 linear_color) {
  const vec3 low = 12.92 * linear_color;
  const vec3 high = 1.055 * pow(max(linear_color, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055;
  return mix(low, high, greaterThan(linear_color, vec3(0.0031308)));
}

// Half a step of ordered noise hides the bands of soft gradients.
float Dither(vec2 pixel) {
  return fract(52.9829189 * fract(dot(floor(pixel), vec2(0.06711056, 0.00583715)))) - 0.5;
}

vec3 ToTarget(vec3 linear_color, vec2 pixel) {
  const vec3 color = clamp(linear_color, 0.0, 1.0);
  if (kEncode == 0) return color;
  return EncodeSrgb(color) + Dither(pixel) / 255.0;
}
