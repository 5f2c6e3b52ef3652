// A rasterised fragment: its pixel, depth, id and colour. The lighting is that of src/metric/shading.cpp.
#ifndef FRAGMENT_INPUT_GLSL
#define FRAGMENT_INPUT_GLSL
#include "scene/opaque.glsl"
#include "scene/samples.glsl"
#include "scene/texture.glsl"
layout(location = 0) in vec3 world_position;
layout(location = 1) in vec3 world_normal;
layout(location = 2) in vec2 texcoord;
layout(location = 3) in vec4 vertex_color;

struct TriangleInfo {
  uint object;
  uint id;  // number of the triangle in the RenderScene
};
struct Surface {
  vec4 color;
  uint texture_number;  // kNone: no texture
  float cutoff;
  uint is_opaque;
  uint is_unlit;
  vec3 emissive;
  uint emissive_texture;  // kNone: no texture
};
layout(std430, set = 0, binding = SLOT_TRIANGLES) readonly buffer Triangles { TriangleInfo triangles[]; };
layout(std430, set = 0, binding = SLOT_SURFACES) readonly buffer Surfaces { Surface surfaces[]; };
layout(std430, set = 0, binding = SLOT_INDICES) readonly buffer Indices { uint indices[]; };
layout(std430, set = 0, binding = SLOT_POSITIONS) readonly buffer Positions { float positions[]; };

#if defined(MARKED)
// For triangles that are drawn again: their numbers.
layout(std430, set = 0, binding = SLOT_STATE_FRONT) readonly buffer Touching { uint touching[]; };
uint fragment_triangle() { return touching[push.first_triangle + uint(gl_PrimitiveID)]; }
#else
uint fragment_triangle() { return push.first_triangle + uint(gl_PrimitiveID); }
#endif

uint fragment_pixel() { return pixel_index(uvec2(gl_FragCoord.xy)); }

uint fragment_id() {
  return 2u * (triangles[fragment_triangle()].id + 1u) + (gl_FrontFacing ? 0u : 1u);
}

vec2 screen_of(uint vertex) {
  const vec4 clip = frame.clip_from_world * vec4(positions[3u * vertex], positions[3u * vertex + 1u],
                                                 positions[3u * vertex + 2u], 1.0);
  return (clip.xy / clip.w * 0.5 + 0.5) * image_size();
}

float distance_to_line(vec2 p, vec2 a, vec2 b) {
  const vec2 along = b - a;
  const float l = length(along);
  return l > 0.0 ? abs(along.x * (p.y - a.y) - along.y * (p.x - a.x)) / l : length(p - a);
}

// Returns the share of the edge colour at this fragment. Lines are about 1.4 pixels wide.
float edge_share() {
  const uint corner = 3u * fragment_triangle();
  const vec2 a = screen_of(indices[corner]);
  const vec2 b = screen_of(indices[corner + 1u]);
  const vec2 c = screen_of(indices[corner + 2u]);
  const vec2 p = place_in_image(uvec2(gl_FragCoord.xy));
  const float d = min(distance_to_line(p, a, b), min(distance_to_line(p, b, c), distance_to_line(p, c, a)));
  return 1.0 - smoothstep(0.3, 1.1, d);
}

float to_the_48th(float x) {
  const float x4 = (x * x) * (x * x);
  const float x16 = (x4 * x4) * (x4 * x4);
  return x16 * x16 * x16;
}

// Derivatives are taken here, because they are undefined in a branch that not all pixels of a quad take.
vec3 lit_face = cross(dFdx(world_position), dFdy(world_position));
vec2 texcoord_dx = dFdx(texcoord);
vec2 texcoord_dy = dFdy(texcoord);

Surface surface_here() { return surfaces[triangles[fragment_triangle()].object]; }

// Returns colour and opacity without lighting.
vec4 base_color(Surface surface) {
  vec4 color = surface.color;
  if (!has_feature(kColored)) return color;
  color *= vertex_color;
  if (surface.texture_number != kNone)
    color *= sample_texture(surface.texture_number, texcoord, texcoord_dx, texcoord_dy);
  return color;
}

// Discards fragments that nobody can see. Every pass calls it before anything else, but after taking
// derivatives, which need the whole quad.
bool discard_unseen() {
  if (is_behind_opaque(ivec2(gl_FragCoord.xy), gl_FragCoord.z)) discard;
  if (has_feature(kCutOut)) {
    const Surface surface = surface_here();
    if (surface.cutoff > 0.0 && base_color(surface).a < surface.cutoff) discard;
  }
  return true;
}
bool is_seen = discard_unseen();

vec3 direction_to_eye() {
  return frame.eye.w != 0.0 ? normalize(frame.eye.xyz - world_position) : frame.to_viewer.xyz;
}

// Returns the unit normal on the visible side.
vec3 seen_normal(vec3 to_eye) {
  const vec3 face = dot(lit_face, to_eye) < 0.0 ? -lit_face : lit_face;
  const vec3 normal = dot(world_normal, world_normal) > 0.0 ? world_normal : face;
  return normalize(dot(normal, face) < 0.0 ? -normal : normal);
}

// Returns the opacity of a sheet of opacity `alpha`. The more the sheet is inclined, the longer is the path
// of light through it.
float seen_opacity(Surface surface, float alpha, float facing) {
  const bool translucent = surface.is_opaque == 0u && alpha < 1.0;
  return translucent ? 1.0 - exp2(log2(1.0 - alpha) / max(facing, 0.2)) : 1.0;
}

// Returns the light that the surface gives off by itself.
vec3 emitted(Surface surface) {
  vec3 light = surface.emissive;
  if (has_feature(kColored) && surface.emissive_texture != kNone)
    light *= sample_texture(surface.emissive_texture, texcoord, texcoord_dx, texcoord_dy).rgb;
  return light;
}

vec4 lit_color() {
  const Surface surface = surface_here();
  const vec4 base = base_color(surface);
  if (surface.is_unlit != 0u) return vec4(base.rgb + emitted(surface), surface.is_opaque != 0u ? 1.0 : base.a);
  const vec3 to_eye = direction_to_eye();
  const vec3 normal = seen_normal(to_eye);
  const float facing = clamp(dot(normal, to_eye), 0.0, 1.0);
  const float fill = max(dot(normal, frame.fill_light.xyz), 0.0);
  const float highlight = max(dot(normal, normalize(frame.fill_light.xyz + to_eye)), 0.0);
  const float gloss = 0.35 * to_the_48th(highlight);
  const vec3 color = base.rgb * (0.2 + 0.62 * facing + 0.45 * fill) + vec3(gloss) + emitted(surface);
  return vec4(color, seen_opacity(surface, base.a, facing));
}

const uint kWireframe = 1u;

uint fragment_color() {
  vec4 color = lit_color();
  if (kEffect == kWireframe) {
    const float edge = edge_share();
    color = vec4(mix(color.rgb, frame.line.rgb, edge), mix(color.a, 1.0, edge));
  }
  return pack_color(color);
}
#endif
