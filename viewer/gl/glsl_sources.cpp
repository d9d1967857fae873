// GLSL of all passes. Light is computed linear and written as sRGB into 8-bit targets by the shader itself.
#include "viewer/gl/shader.hpp"

namespace enamel::view::glsl {

const std::string_view kModelVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal_quality;  // snorm16: unit normal, quality; below 0: soft tissue's
uniform mat4 view;
uniform mat4 projection;
out vec3 position_view;
out vec3 normal_view;
out float quality;
out float soft;
void main() {
  vec4 p = view * vec4(position, 1.0);
  position_view = p.xyz;
  normal_view = mat3(view) * normal_quality.xyz;
  quality = abs(normal_quality.w);
  soft = normal_quality.w < 0.0 ? 1.0 : 0.0;
  gl_Position = projection * p;
}
)";

const std::string_view kModelFragment = R"(
in vec3 position_view;
in vec3 normal_view;
in float quality;
in float soft;
uniform float hide_soft;   // 1: soft tissue is left out
uniform vec3 soft_tone;
uniform vec3 albedo;       // linear, as the ramp is
uniform vec3 ramp_low;     // quality 0, 0.5, 1
uniform vec3 ramp_mid;
uniform vec3 ramp_high;
uniform float ramp_share;  // 0 = albedo, 1 = quality map
uniform float gloss;       // 0 = matte
uniform float mm_per_px;
out vec4 colour;

// Powers are what shading costs in software: whole ones are products, the display's gamma of
// 2.2 is a fit of roots, within 0.7 grey levels. Alpha is brightness, for the filter of edges.
vec3 display(vec3 c) {
  vec3 a = sqrt(c);
  return 0.99035 * a + 0.07811 * sqrt(a) - 0.06980 * c;
}

void main() {
  if (soft * hide_soft > 0.5) discard;
  vec3 v = normalize(-position_view);
  vec3 n = normalize(normal_view);
  if (!gl_FrontFacing) {
    // Seen through a hole: the surface's back, cold and dark, so that a gap is never taken for a tooth.
    float facing = abs(dot(n, v));
    colour.rgb = display(vec3(0.020, 0.026, 0.036) * (0.5 + facing));
    colour.a = dot(colour.rgb, vec3(0.299, 0.587, 0.114));
    return;
  }
  vec3 ramp = quality < 0.5 ? mix(ramp_low, ramp_mid, clamp(2.0 * quality, 0.0, 1.0))
                            : mix(ramp_mid, ramp_high, clamp(2.0 * quality - 1.0, 0.0, 1.0));
  bool is_soft = soft > 0.5;
  vec3 base = mix(is_soft ? soft_tone : albedo, ramp, ramp_share);
  // Stripes on the screen, 1.2 mm apart: told without colour, and under the quality map.
  if (is_soft && fract((gl_FragCoord.x + gl_FragCoord.y) * mm_per_px / 1.2) < 0.4) base *= 0.72;

  // Concave places (fissures, gaps between teeth) gather less light: curvature from the normal's change over a pixel.
  vec3 dx = dFdx(n);
  vec3 dy = dFdy(n);
  float curvature = (dx.x + dy.y) / max(mm_per_px, 1e-4);  // 1/mm, negative = hollow
  float hollow = clamp(1.0 + 0.22 * clamp(curvature, -1.8, 0.0) + 0.07 * clamp(curvature, 0.0, 1.2), 0.55, 1.1);

  const vec3 key_dir = normalize(vec3(-0.45, 0.72, 0.62));
  const vec3 fill_dir = normalize(vec3(0.85, 0.05, 0.52));
  float wrap = 0.18;  // light that scatters inside enamel
  float key = max((dot(n, key_dir) + wrap) / (1.0 + wrap), 0.0);
  float fill = max(dot(n, fill_dir), 0.0);
  float facing = max(dot(n, v), 0.0);
  vec3 ambient = mix(vec3(0.105, 0.080, 0.072), vec3(0.175, 0.185, 0.205), 0.5 + 0.5 * n.y);
  vec3 light = ambient + key * vec3(0.80, 0.765, 0.715) + fill * vec3(0.105, 0.125, 0.155) + facing * vec3(0.10);
  float away = 1.0 - facing;
  float rim = away * away * away * sqrt(away) * (0.35 + 0.65 * max(n.y, 0.0));
  vec3 shaded = base * light * hollow + rim * vec3(0.10, 0.115, 0.135);

  vec3 h = normalize(key_dir + v);
  float nh = max(dot(n, h), 0.0);
  float nh2 = nh * nh;
  float nh4 = nh2 * nh2;
  float nh8 = nh4 * nh4;
  float nh16 = nh8 * nh8;
  float nh64 = nh16 * nh16 * nh16 * nh16;
  shaded += gloss * (0.16 * nh64 * nh4 * nh2 + 0.045 * nh8 * nh4 * nh2) * vec3(1.0, 0.98, 0.95);
  // Shoulder: highlights keep their shape instead of clipping.
  shaded = shaded * (1.0 + shaded * 0.12) / (1.0 + shaded * 0.42);
  shaded *= 1.16;
  colour.rgb = display(clamp(shaded, 0.0, 1.0));
  colour.a = dot(colour.rgb, vec3(0.299, 0.587, 0.114));
}
)";

const std::string_view kLineVertex = R"(
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec2 corner;  // x: 0 = from, 1 = to; y: side -1 or +1
layout(location = 3) in vec4 tint;
uniform mat4 view_projection;
uniform vec2 viewport;    // px
uniform float width_px;   // 0: plain triangles, `from` is the vertex
out vec4 tint_here;
out float across;
void main() {
  tint_here = tint;
  across = 0.0;
  vec4 a = view_projection * vec4(from, 1.0);
  if (width_px <= 0.0) {
    gl_Position = a;
    return;
  }
  vec4 b = view_projection * vec4(to, 1.0);
  const float near_w = 0.5;  // a line that comes from behind the eye is cut before it
  if (a.w < near_w && b.w < near_w) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  if (a.w < near_w) { a = mix(a, b, (near_w - a.w) / (b.w - a.w)); }
  if (b.w < near_w) { b = mix(b, a, (near_w - b.w) / (a.w - b.w)); }
  vec2 along = (b.xy / b.w - a.xy / a.w) * viewport;
  float len = length(along);
  along = len > 1e-4 ? along / len : vec2(1.0, 0.0);
  vec4 p = corner.x < 0.5 ? a : b;
  float half_px = 0.5 * width_px + 1.0;  // one pixel of soft edge
  vec2 offset = (vec2(-along.y, along.x) * corner.y + along * (corner.x * 2.0 - 1.0) * 0.3) * half_px;
  p.xy += 2.0 * offset / viewport * p.w;
  across = corner.y * half_px;
  gl_Position = p;
}
)";

const std::string_view kLineFragment = R"(
in vec4 tint_here;
in float across;
uniform float width_px;
uniform float opacity;
out vec4 colour;
void main() {
  float edge = width_px > 0.0 ? clamp(0.5 * width_px + 0.5 - abs(across), 0.0, 1.0) : 1.0;
  colour = vec4(tint_here.rgb, tint_here.a * opacity * edge);
}
)";

const std::string_view kScreenVertex = R"(
out vec2 uv;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  uv = 0.5 * corner + 0.5;
  gl_Position = vec4(corner, 1.0, 1.0);
}
)";

const std::string_view kBackdropFragment = R"(
in vec2 uv;
uniform float aspect;
out vec4 colour;
void main() {
  vec2 d = (uv - vec2(0.5, 0.54)) * vec2(mix(1.0, aspect, 0.5), 1.0);
  float r = smoothstep(0.05, 0.95, length(d));
  vec3 c = mix(vec3(0.235, 0.262, 0.300), vec3(0.058, 0.067, 0.082), r);
  // Half a grey level of fixed noise keeps the gradient free of bands.
  float noise = fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453) - 0.5;
  colour = vec4(c + noise / 255.0, dot(c, vec3(0.299, 0.587, 0.114)));
}
)";

const std::string_view kOcclusionFragment = R"(
in vec2 uv;
uniform sampler2D depth;
uniform mat4 projection;
uniform mat4 unprojection;
uniform float radius_mm;
out vec4 colour;

vec3 position_at(vec2 at) {
  vec4 p = unprojection * vec4(vec3(at, textureLod(depth, at, 0.0).r) * 2.0 - 1.0, 1.0);
  return p.xyz / p.w;
}

void main() {
  float here = textureLod(depth, uv, 0.0).r;
  if (here >= 1.0) {
    colour = vec4(1.0);
    return;
  }
  vec3 p = position_at(uv);
  vec3 n = normalize(cross(dFdx(p), dFdy(p)));
  float turn = 6.2832 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  float radius_uv = 0.5 * radius_mm * projection[1][1] / -p.z;
  float aspect = projection[1][1] / projection[0][0];
  const int kTaps = 20;
  float blocked = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    float share = (float(i) + 0.5) / float(kTaps);
    float angle = turn + float(i) * 2.3999632;
    vec2 offset = vec2(cos(angle) / aspect, sin(angle)) * radius_uv * sqrt(share);
    vec3 d = position_at(uv + offset) - p;
    float away = length(d);
    float rise = dot(d, n) / max(away, 1e-4);
    blocked += max(rise - 0.12, 0.0) * smoothstep(1.6 * radius_mm, 0.4 * radius_mm, away);
  }
  colour = vec4(vec3(clamp(1.0 - 1.7 * blocked / float(kTaps), 0.0, 1.0)), 1.0);
}
)";

const std::string_view kDarkenFragment = R"(
in vec2 uv;
uniform sampler2D occlusion;
uniform vec2 scene_px;
out vec4 colour;
void main() {
  // The turned taps of the occlusion pass repeat every four pixels: a 4 x 4 mean removes them.
  float open = 0.0;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      open += texture(occlusion, uv + (vec2(x, y) - 1.5) * 1.5 / scene_px).r;
    }
  }
  open /= 16.0;
  colour = vec4(pow(open, 0.95), open, pow(open, 1.05), 1.0);  // light between teeth turns warm
}
)";

const std::string_view kQuickCompose = R"(
uniform sampler2D scene;  // alpha: brightness
uniform vec2 scene_px;
out vec4 colour;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 low = max(at - 1, ivec2(0));
  ivec2 high = min(at + 1, ivec2(scene_px) - 1);
  vec4 c = texelFetch(scene, at, 0);
  vec4 a = texelFetch(scene, low, 0);
  vec4 b = texelFetch(scene, high, 0);
  vec4 d = texelFetch(scene, ivec2(low.x, high.y), 0);
  vec4 e = texelFetch(scene, ivec2(high.x, low.y), 0);
  float least = min(min(a.a, b.a), min(d.a, e.a));
  float most = max(max(a.a, b.a), max(d.a, e.a));
  float share = clamp((most - least - 0.06) * 6.0, 0.0, 0.6);
  colour = vec4(mix(c.rgb, 0.25 * (a.rgb + b.rgb + d.rgb + e.rgb), share), 1.0);
}
)";

const std::string_view kComposeFragment = R"(
in vec2 uv;
uniform sampler2D scene;     // alpha: brightness
uniform float smooth_edges;  // 1: edge filter for a scene at the picture's own size
uniform vec2 scene_px;
out vec4 colour;

float luma(vec3 c) { return dot(c, vec3(0.299, 0.587, 0.114)); }

// FXAA, console variant: blend along the edge that the four diagonal neighbours show.
vec3 smoothed(vec3 c, float m) {
  vec2 px = 1.0 / scene_px;
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 last = ivec2(scene_px) - 1;
  ivec2 low_at = max(at - 1, ivec2(0));
  ivec2 high_at = min(at + 1, last);
  float nw = texelFetch(scene, ivec2(low_at.x, high_at.y), 0).a;
  float ne = texelFetch(scene, high_at, 0).a;
  float sw = texelFetch(scene, low_at, 0).a;
  float se = texelFetch(scene, ivec2(high_at.x, low_at.y), 0).a;
  float low = min(m, min(min(nw, ne), min(sw, se)));
  float high = max(m, max(max(nw, ne), max(sw, se)));
  if (high - low < max(0.04, high * 0.12)) {
    return c;
  }
  vec2 dir = vec2((sw + se) - (nw + ne), (nw + sw) - (ne + se));
  dir /= min(abs(dir.x), abs(dir.y)) + max((nw + ne + sw + se) * 0.03125, 0.0078);
  dir = clamp(dir, -8.0, 8.0) * px;
  vec3 a = 0.5 * (texture(scene, uv - dir / 6.0).rgb + texture(scene, uv + dir / 6.0).rgb);
  vec3 b = 0.5 * a + 0.25 * (texture(scene, uv - 0.5 * dir).rgb + texture(scene, uv + 0.5 * dir).rgb);
  float lb = luma(b);
  return lb < low || lb > high ? a : b;
}

void main() {
  if (smooth_edges > 0.5) {
    vec4 c = texelFetch(scene, ivec2(gl_FragCoord.xy), 0);
    colour = vec4(smoothed(c.rgb, c.a), 1.0);
  } else {
    colour = vec4(texture(scene, uv).rgb, 1.0);
  }
}
)";

}  // namespace enamel::view::glsl
