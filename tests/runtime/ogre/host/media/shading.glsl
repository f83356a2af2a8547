// Included by the fragment shaders.
vec3 ToLinear(vec3 colour) { return pow(colour, vec3(2.2)); }

vec3 ToScreen(vec3 light) {
  vec3 x = max(light, vec3(0.0));
  x = mix(x, 1.0 - 0.25 * exp(3.0 - 4.0 * x), step(0.75, x));  // rolls highlights off above 3/4
  float grain = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  return pow(x, vec3(1.0 / 2.2)) + (grain - 0.5) / 255.0;  // or slow gradients show steps
}

// The part of the key light that arrives: 16 neighbours in the depths seen from the light.
float Lit(sampler2D shadows, vec4 place, float softness, float bias) {
  vec3 at = place.xyz / place.w;
  at.z = min(at.z, 1.0);  // behind all that casts shadows there is light
  float lit = 0.0;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      vec2 offset = (vec2(x, y) - 1.5) * softness / vec2(textureSize(shadows, 0));
      lit += texture(shadows, at.xy + offset).r + bias >= at.z ? 1.0 / 16.0 : 0.0;
    }
  }
  return lit;
}
