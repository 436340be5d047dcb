"""The GLSL 3.30 programs.

Light is computed in linear colours. Textures are decoded from sRGB by the hardware, other colours come
in already linear, and every program encodes what it writes, because a window's framebuffer can't be
relied on to do so. Blending therefore happens between encoded colours, as in any paint program.

A software rasteriser runs both sides of every branch, so what differs between surfaces is chosen when a
program is compiled, not while it runs.
"""

from __future__ import annotations

from osgode.graph.frame import MAX_LIGHTS

POSITION, NORMAL, UV, ROWS = 0, 1, 2, 3
"""Locations of the vertex attributes; the three rows of an instance's matrix start at ROWS."""

FRAME_FIELDS = {
    "view_projection": 4,
    "eye": 1,  # and the haze's inverse length
    "to_sun": 1,  # and the texels along a shadow map's edge
    "sun": 1,
    "ambient": 1,
    "horizon": 1,
    "zenith": 1,
    "light_axes": 3,
    "cascades": 2,
    "corner_to_world": 3,
    "lights": 3 * MAX_LIGHTS,  # place and 1 / reach squared; colour and steepness of the cone; direction and its offset
}
"""The uniform block that all programs share: how many 4-vectors each field takes, in order."""

_FRAME = (
    f"#version 330 core\n#define LAMPS {3 * MAX_LIGHTS}"
    """
layout(std140) uniform Frame {
    mat4 u_view_projection;
    vec4 u_eye;
    vec4 u_to_sun;
    vec4 u_sun;
    vec4 u_ambient;
    vec4 u_horizon;
    vec4 u_zenith;
    vec4 u_light_axes[3];
    vec4 u_cascades[2];
    vec4 u_corner_to_world[3];
    vec4 u_lights[LAMPS];
};

vec3 to_light(vec3 v) {
    return vec3(dot(u_light_axes[0].xyz, v), dot(u_light_axes[1].xyz, v), dot(u_light_axes[2].xyz, v));
}
"""
)

_INSTANCE = """
layout(location = 0) in vec3 in_position;
layout(location = 3) in vec4 in_row0;
layout(location = 4) in vec4 in_row1;
layout(location = 5) in vec4 in_row2;

vec3 to_world(vec3 p) {
    vec4 v = vec4(p, 1.0);
    return vec3(dot(in_row0, v), dot(in_row1, v), dot(in_row2, v));
}
"""

_ENCODE = """
// sRGB's 1.055 c^(1/2.4) - 0.055 by square roots, fitted: nowhere off by more than 0.00005, a hundredth of a step of a
// byte. A software rasteriser takes a twelfth of its time less than with powers.
vec3 encode(vec3 linear) {
    vec3 c = clamp(linear, 0.0, 1.0), half_power = sqrt(c), fourth = sqrt(half_power), eighth = sqrt(fourth);
    vec3 curve = 0.6423831 * half_power + 0.71209063 * fourth - 0.33686177 * eighth - 0.0175689 * c;
    return mix(12.92 * c, curve, step(0.0031308, c));
}
"""

_SURFACE_VERTEX = """
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_uv;

out vec3 v_world;
out vec3 v_normal;
out vec2 v_uv;
out vec3 v_light;

void main() {
    v_world = to_world(in_position);
    // The cofactors are the inverse transpose times the determinant. The sign of the determinant is
    // wanted: a mirrored instance also swaps front and back faces, and the fragment shader undoes both.
    v_normal = vec3(
        dot(cross(in_row1.xyz, in_row2.xyz), in_normal),
        dot(cross(in_row2.xyz, in_row0.xyz), in_normal),
        dot(cross(in_row0.xyz, in_row1.xyz), in_normal));
    v_uv = in_uv;
    v_light = to_light(v_world);
    gl_Position = u_view_projection * vec4(v_world, 1.0);
}
"""

_SURFACE_FRAGMENT = """
in vec3 v_world;
in vec3 v_normal;
in vec2 v_uv;
in vec3 v_light;

uniform vec4 u_colour;
#ifdef TEXTURED
uniform sampler2D u_texture;
#endif
#ifdef LIT
uniform float u_shininess;
#endif
#ifdef SHADOWED
uniform sampler2DShadow u_shadow_map;
#endif

out vec4 out_colour;

#ifdef SHADOWED
// The share of sunlight that arrives: a 3x3 tent filter from four bilinear comparisons.
float sunlight(vec3 normal) {
    vec3 fine = abs(v_light - u_cascades[0].xyz) * u_cascades[0].w;
    float tile = step(0.97, max(fine.x, max(fine.y, fine.z)));
    vec4 cascade = mix(u_cascades[0], u_cascades[1], tile);
    float texels = u_to_sun.w;
    float texel = 2.0 / (cascade.w * texels);
    // A point is looked up a little off its surface, more so where light grazes it: this is what keeps
    // a surface from shadowing itself, and unlike a bias along the light it opens no gap at contacts.
    vec3 n = to_light(normal);
    float grazing = sqrt(max(1.0 - n.z * n.z, 0.0));
    vec3 p = (v_light + n * (texel * (0.3 + 1.6 * grazing)) - cascade.xyz) * cascade.w;

    vec2 grid = (p.xy * 0.5 + 0.5) * texels;
    vec2 base = floor(grid + 0.5);
    vec2 f = grid + 0.5 - base;
    vec2 w0 = 3.0 - 2.0 * f;
    vec2 w1 = 1.0 + 2.0 * f;
    vec2 scale = vec2(0.5, 1.0) / texels;
    vec2 corner = vec2(0.5 * tile, 0.0);
    vec2 t0 = corner + (base - 1.5 + (2.0 - f) / w0) * scale;
    vec2 t1 = corner + (base + 0.5 + f / w1) * scale;
    float depth = 0.5 - 0.5 * p.z;
    float sum = w0.x * w0.y * texture(u_shadow_map, vec3(t0, depth))
              + w1.x * w0.y * texture(u_shadow_map, vec3(t1.x, t0.y, depth))
              + w0.x * w1.y * texture(u_shadow_map, vec3(t0.x, t1.y, depth))
              + w1.x * w1.y * texture(u_shadow_map, vec3(t1, depth));
    // Beyond the coarse map there are no shadows; they fade out before.
    float edge = max(abs(p.x), max(abs(p.y), abs(p.z)));
    return mix(sum / 16.0, 1.0, tile * smoothstep(0.7, 0.97, edge));
}
#endif

#ifdef LIT
// What the ground throws back upwards.
const vec3 GROUND = vec3(0.50, 0.45, 0.38);

vec3 shade(vec3 colour, vec3 to_eye) {
    vec3 n = normalize(gl_FrontFacing ? v_normal : -v_normal);
    vec3 to_sun = u_to_sun.xyz;
    vec3 sun = u_sun.rgb * max(dot(n, to_sun), 0.0);
#ifdef SHADOWED
    sun *= sunlight(n);
#endif
    vec3 sky = u_ambient.rgb * mix(GROUND, vec3(1.0), 0.5 + 0.5 * n.y);
    float highlight = max(dot(n, normalize(to_sun + to_eye)), 0.0);
    float strength = u_shininess * mix(0.3, 2.0, u_shininess);
    float power = exp2(2.0 + 8.0 * u_shininess);
    vec3 shine = sun * pow(highlight, power);
#ifdef LIGHTS
    for (int k = 0; k < 3 * LIGHTS; k += 3) {
        vec3 way = u_lights[k].xyz - v_world;
        float square = max(dot(way, way), 1e-8);
        vec3 towards = way * inversesqrt(square);
        float fade = max(1.0 - square * u_lights[k].w, 0.0);
        float cone = clamp(u_lights[k + 2].w - u_lights[k + 1].w * dot(towards, u_lights[k + 2].xyz), 0.0, 1.0);
        vec3 lamp = u_lights[k + 1].rgb * (fade * fade * cone * max(dot(n, towards), 0.0));
        sun += lamp;
        shine += lamp * pow(max(dot(n, normalize(towards + to_eye)), 0.0), power);
    }
#endif
    vec3 c = colour * (sky + sun);
#ifdef POLISHED
    // The sky and the ground, mirrored: more at grazing angles, and in the surface's own colour elsewhere.
    float polish = 2.0 * u_shininess - 1.0;
    float along = 1.0 - max(dot(n, to_eye), 0.0);
    float fresnel = along * along * along * along;
    vec3 mirrored = u_ambient.rgb * GROUND;
    vec3 way = reflect(-to_eye, n);
    vec3 above = mix(u_zenith.rgb, u_horizon.rgb, exp(-3.5 * max(way.y, 0.0)));
    mirrored = mix(mirrored, above, smoothstep(-0.15, 0.1, way.y));
    c = mix(c, mirrored * mix(colour, vec3(1.0), fresnel), polish * mix(0.6, 0.9, fresnel));
#endif
    c += shine * strength;
    // What is lit more than fully isn't cut off: from 0.8 on it bends over towards 1.
    vec3 over = max(c - 0.8, 0.0);
    return min(c, 0.8) + over / (1.0 + 5.0 * over);
}
#endif

void main() {
    vec4 base = u_colour;
#ifdef TEXTURED
    base *= texture(u_texture, v_uv);
#endif
#ifdef CUTOUT
    if (base.a < 0.5) {
        discard;
    }
#endif
    vec3 to_eye = u_eye.xyz - v_world;
    float away = length(to_eye);
    vec3 colour = base.rgb;
#ifdef LIT
    colour = shade(colour, to_eye / away);
#endif
    float thickness = away * u_eye.w;
    colour = mix(u_horizon.rgb, colour, exp(-thickness * thickness));
    out_colour = vec4(encode(colour), base.a);
}
"""

_SPRITE_VERTEX = """
layout(location = 0) in vec4 in_place;
layout(location = 1) in vec4 in_colour;
layout(location = 2) in vec4 in_streak;

out vec2 v_corner;
out vec4 v_colour;
out float v_haze;
out vec3 v_side;
out vec3 v_along;
out vec3 v_towards;

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    vec3 way = u_eye.xyz - in_place.xyz;
    float away = length(way);
    vec3 to_eye = way / max(away, 1e-6);
    // What is seen of the streak; a round one stands upright in the picture.
    vec3 streak = in_streak.xyz - to_eye * dot(in_streak.xyz, to_eye);
    float drawn = length(streak);
    vec3 up = abs(to_eye.y) < 0.999 ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0);
    vec3 along = drawn > 1e-5 ? streak / drawn : normalize(up - to_eye * dot(up, to_eye));
    vec3 side = cross(along, to_eye);
    vec3 place = in_place.xyz + corner.x * in_place.w * side + corner.y * (in_place.w + 0.5 * drawn) * along;
    v_corner = corner;
    vec3 c = in_colour.rgb;
    c = mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
    // Before the eye it fades out, so that nobody runs into a wall of it.
    v_colour = vec4(c, in_colour.a * smoothstep(0.2, 1.0, away / max(2.0 * in_place.w, 0.3)));
    float thickness = away * u_eye.w;
    v_haze = exp(-thickness * thickness);
    v_side = side;
    v_along = along;
    v_towards = to_eye;
    gl_Position = u_view_projection * vec4(place, 1.0);
}
"""

_SPRITE_FRAGMENT = """
in vec2 v_corner;
in vec4 v_colour;
in float v_haze;
in vec3 v_side;
in vec3 v_along;
in vec3 v_towards;

out vec4 out_colour;

void main() {
    float inner = max(1.0 - dot(v_corner, v_corner), 0.0);
    float alpha = v_colour.a * inner * inner;
#ifdef ADDITIVE
    out_colour = vec4(encode(v_colour.rgb) * (alpha * v_haze), 0.0);
#else
    // As a ball that lets light through: brighter towards the sun, but nowhere black.
    vec3 n = v_side * v_corner.x + v_along * v_corner.y + v_towards * sqrt(inner);
    vec3 light = u_ambient.rgb * (0.85 + 0.15 * n.y) + u_sun.rgb * (0.4 + 0.35 * dot(n, u_to_sun.xyz));
    vec3 colour = mix(u_horizon.rgb, v_colour.rgb * light, v_haze);
    out_colour = vec4(encode(colour) * alpha, alpha);
#endif
}
"""

_SHADOW_VERTEX = """
uniform vec4 u_cascade;

void main() {
    vec3 p = (to_light(to_world(in_position)) - u_cascade.xyz) * u_cascade.w;
    gl_Position = vec4(p.xy, -p.z, 1.0);
}
"""

_SKY_VERTEX = """
out vec3 v_direction;

void main() {
    // One triangle that covers the picture, on the far plane.
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    vec3 v = vec3(corner, 1.0);
    v_direction = vec3(
        dot(u_corner_to_world[0].xyz, v), dot(u_corner_to_world[1].xyz, v), dot(u_corner_to_world[2].xyz, v));
    gl_Position = vec4(corner, 1.0, 1.0);
}
"""

_SKY_FRAGMENT = """
in vec3 v_direction;

out vec4 out_colour;

void main() {
    vec3 direction = normalize(v_direction);
    vec3 sky = mix(u_zenith.rgb, u_horizon.rgb, exp(-3.5 * max(direction.y, 0.0)));
    float towards = max(dot(direction, u_to_sun.xyz), 0.0);
    float glow = 0.12 * pow(towards, 24.0) + 0.3 * pow(towards, 400.0) + smoothstep(0.9994, 0.9997, towards);
    out_colour = vec4(encode(sky + u_sun.rgb * glow), 1.0);
}
"""

SHADOW_VERTEX = _FRAME + _INSTANCE + _SHADOW_VERTEX
SHADOW_FRAGMENT = """#version 330 core
void main() {}
"""
SKY_VERTEX = _FRAME + _SKY_VERTEX
SKY_FRAGMENT = _FRAME + _ENCODE + _SKY_FRAGMENT

SPRITE_VERTEX = _FRAME + _SPRITE_VERTEX
SPRITE_FRAGMENTS = tuple(_FRAME + define + _ENCODE + _SPRITE_FRAGMENT for define in ("", "#define ADDITIVE\n"))
"""For those that hide what is behind them, and for those that add to it."""

OVERLAY_VERTEX = """#version 330 core
layout(location = 0) in vec2 in_place;
layout(location = 1) in vec2 in_uv;
layout(location = 2) in vec4 in_colour;

uniform vec2 u_size;

out vec2 v_uv;
out vec4 v_colour;

void main() {
    v_uv = in_uv;
    v_colour = in_colour;
    gl_Position = vec4(in_place.x / u_size.x * 2.0 - 1.0, 1.0 - in_place.y / u_size.y * 2.0, 0.0, 1.0);
}
"""

OVERLAY_FRAGMENT = (
    """#version 330 core
in vec2 v_uv;
in vec4 v_colour;

uniform sampler2D u_texture;

out vec4 out_colour;
"""
    + _ENCODE
    + """
void main() {
    vec4 texel = texture(u_texture, v_uv);
    out_colour = v_colour * vec4(encode(texel.rgb), texel.a);
}
"""
)

LINE_VERTEX = (
    _FRAME
    + """
layout(location = 0) in vec3 in_start;
layout(location = 1) in vec3 in_end;
layout(location = 2) in vec4 in_colour;

uniform vec2 u_half;
uniform vec4 u_near;
uniform vec2 u_width;
uniform float u_nearer;

out vec4 v_colour;
out float v_across;

void main() {
    // What lies on a surface must not be hidden by it: nearer to the eye, at the same place of the picture.
    vec3 start = mix(in_start, u_eye.xyz, u_nearer);
    vec3 end = mix(in_end, u_eye.xyz, u_nearer);
    // Behind the eye there is no place in the picture: the line is cut off at the near plane.
    float a = dot(u_near, vec4(start, 1.0)), b = dot(u_near, vec4(end, 1.0));
    if (a < 0.0 && b < 0.0) {
        gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
        return;
    }
    vec3 whole = end - start;
    if (a < 0.0) {
        start += whole * (a / (a - b));
    } else if (b < 0.0) {
        end -= whole * (b / (b - a));
    }
    vec4 p = u_view_projection * vec4(start, 1.0), q = u_view_projection * vec4(end, 1.0);
    vec2 along = (q.xy / q.w - p.xy / p.w) * u_half;
    float pixels = length(along);
    along = pixels > 1e-6 ? along / pixels : vec2(1.0, 0.0);
    float side = float(gl_VertexID & 1) * 2.0 - 1.0, last = float(gl_VertexID >> 1) * 2.0 - 1.0;
    float reach = 0.5 * (u_width.x + u_width.y);
    vec4 corner = last > 0.0 ? q : p;
    // Longer by half its width, so that corners are closed.
    vec2 off = vec2(-along.y, along.x) * (side * reach) + along * (last * 0.5 * u_width.x);
    corner.xy += off / u_half * corner.w;
    gl_Position = corner;
    v_colour = in_colour;
    v_across = side * reach;
}
"""
)

LINE_FRAGMENT = """#version 330 core
in vec4 v_colour;
in float v_across;

uniform vec2 u_width;

out vec4 out_colour;

void main() {
    float inside = clamp((0.5 * (u_width.x + u_width.y) - abs(v_across)) / u_width.y, 0.0, 1.0);
    out_colour = vec4(v_colour.rgb, v_colour.a * inside);
}
"""


def surface(*features: str) -> tuple[str, str]:
    """The vertex and the fragment shader of surfaces.

    With some of TEXTURED, CUTOUT, LIT, SHADOWED, POLISHED, and LIGHTS with the number of lights beside the sun.
    """
    defines = "".join(f"#define {feature}\n" for feature in features)
    return _FRAME + _INSTANCE + _SURFACE_VERTEX, _FRAME + defines + _ENCODE + _SURFACE_FRAGMENT
