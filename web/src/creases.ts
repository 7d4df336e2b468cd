// The sides of triangles that are edges of the shape: where it turns, or ends.

/** Neighbours that turn by more than this share an edge, as the cosine of 30 degrees. */
const TURNED = Math.cos(Math.PI / 6)

/** True where all panels are triangles: their sides are no lines of the shape, but of how it was cut into triangles. */
export function isTriangulation(triangle: Uint32Array, edge: Uint32Array, rim: Uint32Array): boolean {
  // Each triangle has three sides of its own; a quadrilateral brings a diagonal that is none.
  return triangle.length > 0 && triangle.length === edge.length + rim.length / 2
}

/** A number for each vertex that those in the same place share. */
function places(position: Float32Array): Uint32Array {
  const count = position.length / 3
  const bits = new Uint32Array(position.buffer, position.byteOffset, position.length)
  const mask = (1 << Math.ceil(Math.log2(2 * count + 2))) - 1
  const table = new Int32Array(mask + 1).fill(-1)
  const found = new Uint32Array(count)
  for (let k = 0; k < count; k++) {
    const [x, y, z] = [bits[3 * k], bits[3 * k + 1], bits[3 * k + 2]]
    let slot = (Math.imul(x, 0x9e3779b1) ^ Math.imul(y, 0x85ebca6b) ^ Math.imul(z, 0xc2b2ae35)) & mask
    for (;;) {
      const at = table[slot]
      if (at < 0) {
        table[slot] = k
        found[k] = k
        break
      }
      if (bits[3 * at] === x && bits[3 * at + 1] === y && bits[3 * at + 2] === z) {
        found[k] = at
        break
      }
      slot = (slot + 1) & mask
    }
  }
  return found
}

function normalOf(position: Float32Array, triangle: Uint32Array, t: number): [number, number, number] {
  const [a, b, c] = [3 * triangle[t], 3 * triangle[t + 1], 3 * triangle[t + 2]]
  const e = [0, 1, 2].map((k) => position[b + k] - position[a + k])
  const f = [0, 1, 2].map((k) => position[c + k] - position[a + k])
  const n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
  const length = Math.hypot(...n) || 1
  return [n[0] / length, n[1] / length, n[2] / length]
}

/** Of the inner sides of triangles those at which the surface turns. */
export function creases(position: Float32Array, triangle: Uint32Array, edge: Uint32Array): Uint32Array {
  const same = places(position)
  const count = position.length / 3
  const beside = new Map<number, number[]>()
  for (let k = 0; k < edge.length; k += 2) {
    const [a, b] = [same[edge[k]], same[edge[k + 1]]]
    beside.set(Math.min(a, b) * count + Math.max(a, b), [])
  }
  for (let t = 0; t < triangle.length; t += 3)
    for (let k = 0; k < 3; k++) {
      const [a, b] = [same[triangle[t + k]], same[triangle[t + ((k + 1) % 3)]]]
      beside.get(Math.min(a, b) * count + Math.max(a, b))?.push(t)
    }
  const found: number[] = []
  for (let k = 0; k < edge.length; k += 2) {
    const [a, b] = [same[edge[k]], same[edge[k + 1]]]
    const near = beside.get(Math.min(a, b) * count + Math.max(a, b)) ?? []
    if (near.length < 2) continue
    const [n, ...others] = near.map((t) => normalOf(position, triangle, t))
    if (others.some((o) => n[0] * o[0] + n[1] * o[1] + n[2] * o[2] < TURNED)) found.push(edge[k], edge[k + 1])
  }
  return Uint32Array.from(found)
}
