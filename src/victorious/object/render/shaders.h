// Private to render/: the shaders of the render passes (GLSL 3.30). Camera frame: x right, y down, z forward, metres.
#pragma once

namespace victorious::shaders {

inline constexpr const char* kMeshVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 colour;
uniform mat4 camera_from_mesh;
uniform mat4 clip_from_camera;
out vec3 point_in_camera;
out vec3 normal_in_camera;
out vec2 texture_uv;
out vec4 vertex_colour;
void main() {
  vec4 point = camera_from_mesh * vec4(position, 1.0);
  point_in_camera = point.xyz;
  normal_in_camera = mat3(camera_from_mesh) * normal;
  texture_uv = uv;
  vertex_colour = colour;
  gl_Position = clip_from_camera * point;
}
)";

// Common part of the fragment shaders of all passes over the meshes; prepended to their own source.
inline constexpr const char* kMeshFragmentHead = R"(#version 330 core
in vec3 point_in_camera;
in vec3 normal_in_camera;
in vec2 texture_uv;
in vec4 vertex_colour;
uniform vec4 base_colour;
uniform sampler2D base_texture;
uniform vec2 alpha_range;  // fragments with alpha outside [x, y) are discarded
// Anisotropic filtering: the mean of several samples along the longer axis of the pixel's footprint, at the mipmap
// level of its shorter axis. Done here because results of drivers differ, and Mesa's software renderer takes a hundred
// times the time for thin triangles.
vec4 TextureColour() {
  const float kMaxSamples = 8.0;
  vec2 size = vec2(textureSize(base_texture, 0));
  vec2 right = dFdx(texture_uv);
  vec2 down = dFdy(texture_uv);
  float right_texels = length(right * size);
  float down_texels = length(down * size);
  vec2 along = right_texels > down_texels ? right : down;
  float longer = max(right_texels, down_texels);
  float shorter = max(min(right_texels, down_texels), 1.0);
  float samples = clamp(ceil(longer / shorter), 1.0, kMaxSamples);
  float level = log2(max(longer / samples, shorter));
  vec4 sum = vec4(0.0);
  for (float i = 0.5; i < samples; i += 1.0) {
    sum += textureLod(base_texture, texture_uv + (i / samples - 0.5) * along, level);
  }
  return sum / samples;
}
vec4 SurfaceColour() {
  vec4 colour = base_colour * vertex_colour * TextureColour();
  if (colour.a < alpha_range.x || colour.a >= alpha_range.y) discard;
  return colour;
}
)";

// SunVisibility() for kColourFragment, the visible fraction of the sun at the point: here 1, no shadow map.
inline constexpr const char* kNoShadow = R"(
float SunVisibility(vec3 face) { return 1.0; }
)";

// SunVisibility() with a shadow map: percentage-closer filtering with nine filtered depth comparisons in the tangent
// plane of the surface. Each sample compares the map with the depth of the tangent plane, which avoids self-shadowing
// (receiver-plane depth). The bias is the maximum distance of the map's depth from the plane within a texel.
inline constexpr const char* kShadow = R"(
uniform sampler2DShadow sun_depth;
uniform mat4 sun_from_camera;
uniform vec3 sun_low;   // minimum corner and size of the map's box in the sun frame, m
uniform vec3 sun_size;
uniform vec2 texel_m;
uniform vec2 step_m;    // between neighbouring samples
const vec2 kSampleOffsets[9] = vec2[](vec2(-1, -1), vec2(1, -1), vec2(-1, 1), vec2(1, 1), vec2(0, 0),
                               vec2(0, -1), vec2(-1, 0), vec2(1, 0), vec2(0, 1));
const int kFirstSamples = 5;  // if these agree, the others are skipped
float SunVisibility(vec3 face) {
  const float kMinCosine = 0.02;  // cosine; surfaces at more grazing angles get hardly any sun
  vec3 normal = mat3(sun_from_camera) * normalize(face);
  vec3 point = (sun_from_camera * vec4(point_in_camera, 1.0)).xyz - sun_low;
  vec2 slope = normal.xy / max(-normal.z, kMinCosine);
  float bias = dot(abs(slope) + 0.1, texel_m);
  int samples = normal.z < 0.0 ? 9 : 0;
  float seen = 0.0;
  float taken = 0.0;
  for (int i = 0; i < samples; ++i) {
    if (i == kFirstSamples && (seen == 0.0 || seen == taken)) break;
    vec2 aside = kSampleOffsets[i] * step_m;
    seen += texture(sun_depth, (point + vec3(aside, dot(slope, aside) - bias)) / sun_size);
    taken += 1.0;
  }
  return seen / max(taken, 1.0);
}
)";

inline constexpr const char* kColourFragment = R"(
uniform bool double_sided;
uniform bool blended;
uniform vec3 up_in_camera;
uniform vec3 to_sun_in_camera;
uniform vec3 light;  // sky, ground, sun
out vec4 result;
void main() {
  vec4 colour = SurfaceColour();
  vec3 normal = normalize(normal_in_camera);
  // The geometric normal towards the camera, for either winding of the triangle.
  vec3 face = cross(dFdx(point_in_camera), dFdy(point_in_camera));
  if (dot(face, point_in_camera) > 0.0) face = -face;
  if (double_sided && dot(face, normal) < 0.0) normal = -normal;
  float dome = mix(light.y, light.x, 0.5 + 0.5 * dot(normal, up_in_camera));
  float sun = light.z * max(0.0, dot(normal, to_sun_in_camera)) * SunVisibility(face);
  result = vec4(colour.rgb * (dome + sun), blended ? colour.a : 1.0);
}
)";

inline constexpr const char* kDepthFragment = R"(
uniform float instance;
out vec2 result;
void main() {
  SurfaceColour();
  result = vec2(point_in_camera.z, instance);
}
)";

// kDepthFragment for opaque materials: without the texture, which costs most of the time in software.
inline constexpr const char* kOpaqueDepthFragment = R"(#version 330 core
in vec3 point_in_camera;
uniform float instance;
out vec2 result;
void main() { result = vec2(point_in_camera.z, instance); }
)";

// Fragment shaders of the shadow map pass, depth only. kMaskedCaster discards by alpha and follows kMeshFragmentHead.
inline constexpr const char* kOpaqueCaster = R"(#version 330 core
void main() {}
)";
inline constexpr const char* kMaskedCaster = R"(
void main() { SurfaceColour(); }
)";

inline constexpr const char* kScreenVertex = R"(#version 330 core
void main() {
  vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);  // one triangle that covers the viewport
  gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
)";

// Resolve pass: the mean of a pixel's samples, converted to sRGB (IEC 61966-2-1), channel order blue, green, red.
inline constexpr const char* kResolveFragment = R"(#version 330 core
uniform sampler2D samples;
uniform int supersampling;
out vec4 result;
vec3 SrgbFromLinear(vec3 linear) {
  vec3 value = clamp(linear, 0.0, 1.0);
  return mix(12.92 * value, 1.055 * pow(value, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, value));
}
void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * supersampling;
  vec4 sum = vec4(0.0);
  for (int y = 0; y < supersampling; ++y) {
    for (int x = 0; x < supersampling; ++x) {
      vec4 colour = texelFetch(samples, first + ivec2(x, y), 0);
      sum += vec4(min(colour.rgb, 1.0), colour.a);
    }
  }
  vec4 mean = sum / float(supersampling * supersampling);
  result = vec4(SrgbFromLinear(mean.rgb).bgr, mean.a);
}
)";

}  // namespace victorious::shaders
