// Programs of the graphics processor: surfaces with their light, stripes and sections; points.

export const VERTEX = `
#include <clipping_planes_pars_vertex>
attribute vec3 tint;
varying vec3 vNormal; varying vec3 vWorld; varying vec3 vTint;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vec4 mvPosition = viewMatrix * world;
  vWorld = world.xyz; vTint = tint;
  vNormal = mat3(modelMatrix) * normal;
  gl_Position = projectionMatrix * mvPosition;
  #include <clipping_planes_vertex>
}`

export const FRAGMENT = `
#include <clipping_planes_pars_fragment>
uniform vec3 colour; uniform float tinted; uniform int mode; uniform vec3 towards; uniform vec3 upward; uniform vec3 right;
uniform float opacity; uniform float grey; uniform float lit; uniform vec3 centre; uniform float size; uniform float stripes;
varying vec3 vNormal; varying vec3 vWorld; varying vec3 vTint;
float stripe(float x) { float w = max(fwidth(x), 1e-6); float d = abs(fract(x) - 0.5) - 0.25; return mix(smoothstep(-w, w, d), 0.5, smoothstep(0.25, 0.6, w)); }
void main() {
  #include <clipping_planes_fragment>
  vec3 n = normalize(vNormal);
  vec3 eye = isOrthographic ? towards : normalize(cameraPosition - vWorld);
  bool inside = dot(n, eye) < 0.0;
  if (inside) n = -n;
  vec3 base = mix(colour, vTint, tinted);
  if (mode == 1) { vec3 r = 2.0 * dot(n, eye) * n - eye; base = mix(vec3(0.13, 0.15, 0.18), vec3(0.96), stripe(stripes * atan(dot(r, upward), dot(r, right)) / 6.2831853)); }
  if (mode == 2) base = mix(vec3(0.16, 0.3, 0.52), vec3(0.95, 0.94, 0.9), stripe(stripes * acos(clamp(n.z, -1.0, 1.0)) / 3.14159265));
  if (mode == 3) { vec3 s = vec3(1.0, 0.0, 0.0); vec3 c = cross(s, n); float d = dot(c, centre + vec3(0.0, 0.0, size) - vWorld) / max(length(c), 1e-6); base = mix(vec3(0.2, 0.24, 0.3), vec3(0.97), stripe(0.5 * stripes * d / size)); }
  // Parallel lights along x on a ceiling over the model, as the eye sees them in it (Klass 1980).
  if (mode == 4) { vec3 r = 2.0 * dot(n, eye) * n - eye; float way = (centre.z + 3.0 * size - vWorld.z) / max(r.z, 1e-3); float y = vWorld.y + way * r.y - centre.y; base = mix(vec3(0.17, 0.2, 0.25), vec3(0.98), r.z > 1e-3 ? stripe(0.1 * stripes * y / size) : 0.0); }
  vec3 key = normalize(-0.45 * right + 0.7 * upward + 0.55 * towards);
  // By the direction of view, not by the eye: a plane is one grey in perspective, too.
  float diffuse = 0.52 + 0.16 * (0.5 + 0.5 * n.z) + 0.24 * max(dot(n, towards), 0.0) + 0.30 * max(dot(n, key), 0.0);
  float gloss = 0.09 * pow(max(dot(n, normalize(key + towards)), 0.0), 40.0);
  float shade = mix(1.0, diffuse, lit);
  vec3 c = base * shade * (inside ? 0.86 : 1.0) + (inside ? 0.0 : gloss * lit);
  float g = dot(c, vec3(0.3, 0.59, 0.11));
  c = mix(c, vec3(g) * 0.6 + 0.3, grey);
  float a = opacity < 1.0 ? opacity + (1.0 - opacity) * pow(1.0 - abs(dot(n, eye)), 3.0) : 1.0;
  gl_FragColor = vec4(c, a);
}`

export const DOT_VERTEX = `
attribute vec3 tint; varying vec3 vTint; uniform float pixels; attribute float big;
void main() { vTint = tint; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); gl_Position.z -= 2e-3 * gl_Position.w; gl_PointSize = pixels * big; }`

export const DOT_FRAGMENT = `
varying vec3 vTint;
void main() { float r = length(gl_PointCoord - 0.5); if (r > 0.5) discard; gl_FragColor = vec4(r > 0.34 ? vec3(1.0) : vTint, 1.0); }`
