// Rays against triangles: boxes of runs of triangles, so that a million are looked through in a moment.
//
// Neighbours in the list are neighbours in space, as panels come row by row: a run has a small box.

const RUN = 64
const GROUP = 64

export interface Triangles {
  position: Float32Array
  triangle: Uint32Array
}

export interface Hit {
  /** The way along the ray, in lengths of its direction. */
  t: number
  /** The first index of the triangle, and the weights of its corners. */
  at: number
  weights: [number, number, number]
}

type Triple = [number, number, number]

/** The boxes of runs, and of groups of runs: low x, y, z, high x, y, z each. */
interface Boxes {
  runs: Float64Array
  groups: Float64Array
}

const known = new WeakMap<Float32Array, Boxes>()

function boxes({ position, triangle }: Triangles): Boxes {
  const before = known.get(position)
  if (before) return before
  const count = Math.ceil(triangle.length / 3 / RUN)
  const runs = new Float64Array(6 * count)
  const groups = new Float64Array(6 * Math.ceil(count / GROUP))
  for (const all of [runs, groups]) for (let k = 0; k < all.length; k++) all[k] = k % 6 < 3 ? Infinity : -Infinity
  for (let run = 0; run < count; run++) {
    const [b, g] = [6 * run, 6 * Math.floor(run / GROUP)]
    const end = Math.min(triangle.length, 3 * RUN * (run + 1))
    for (let k = 3 * RUN * run; k < end; k++) {
      const v = 3 * triangle[k]
      for (let c = 0; c < 3; c++) {
        const x = position[v + c]
        if (x < runs[b + c]) runs[b + c] = x
        if (x > runs[b + 3 + c]) runs[b + 3 + c] = x
      }
    }
    for (let c = 0; c < 3; c++) {
      if (runs[b + c] < groups[g + c]) groups[g + c] = runs[b + c]
      if (runs[b + 3 + c] > groups[g + 3 + c]) groups[g + 3 + c] = runs[b + 3 + c]
    }
  }
  const made = { runs, groups }
  known.set(position, made)
  return made
}

function meets(all: Float64Array, k: number, o: Triple, inverse: Triple, most: number): boolean {
  let [near, far] = [0, most]
  for (let c = 0; c < 3; c++) {
    let a = (all[6 * k + c] - o[c]) * inverse[c]
    let b = (all[6 * k + 3 + c] - o[c]) * inverse[c]
    // 0 times infinity: the ray runs in the side of the box.
    if (Number.isNaN(a)) a = -Infinity
    if (Number.isNaN(b)) b = Infinity
    if (a > b) [a, b] = [b, a]
    if (a > near) near = a
    if (b < far) far = b
  }
  // Rounding must not hide a flat run.
  return near <= far * (1 + 1e-12) + 1e-12
}

/** The nearest triangle that a ray meets, from either side, of those that `kept` keeps by their way along it. */
export function hit(
  of: Triangles,
  o: Triple,
  d: Triple,
  most = Infinity,
  kept: (t: number) => boolean = () => true,
): Hit | null {
  const { position, triangle } = of
  if (triangle.length === 0) return null
  const { runs, groups } = boxes(of)
  const inverse: Triple = [1 / d[0], 1 / d[1], 1 / d[2]]
  let best: Hit | null = null
  let least = most
  for (let g = 0; g < groups.length / 6; g++) {
    if (!meets(groups, g, o, inverse, least)) continue
    const last = Math.min(runs.length / 6, GROUP * (g + 1))
    for (let run = GROUP * g; run < last; run++) {
      if (!meets(runs, run, o, inverse, least)) continue
      const end = Math.min(triangle.length, 3 * RUN * (run + 1))
      for (let at = 3 * RUN * run; at < end; at += 3) {
        // Moller and Trumbore 1997.
        const [a, b, c] = [3 * triangle[at], 3 * triangle[at + 1], 3 * triangle[at + 2]]
        const [ax, ay, az] = [position[a], position[a + 1], position[a + 2]]
        const [ex, ey, ez] = [position[b] - ax, position[b + 1] - ay, position[b + 2] - az]
        const [fx, fy, fz] = [position[c] - ax, position[c + 1] - ay, position[c + 2] - az]
        const [px, py, pz] = [d[1] * fz - d[2] * fy, d[2] * fx - d[0] * fz, d[0] * fy - d[1] * fx]
        const det = ex * px + ey * py + ez * pz
        if (det === 0) continue
        const [sx, sy, sz] = [o[0] - ax, o[1] - ay, o[2] - az]
        const v = (sx * px + sy * py + sz * pz) / det
        if (v < 0 || v > 1) continue
        const [qx, qy, qz] = [sy * ez - sz * ey, sz * ex - sx * ez, sx * ey - sy * ex]
        const w = (d[0] * qx + d[1] * qy + d[2] * qz) / det
        if (w < 0 || v + w > 1) continue
        const t = (fx * qx + fy * qy + fz * qz) / det
        if (t < 0 || t >= least || !kept(t)) continue
        least = t
        best = { t, at, weights: [1 - v - w, v, w] }
      }
    }
  }
  return best
}
