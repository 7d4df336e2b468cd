// What a plane across an axis cuts of the triangles that are drawn, and which of it encloses material.

/** Triangles as they are drawn: positions relative to an origin; an image is mirrored by its signs. */
export interface Cuttable {
  position: Float32Array
  triangle: Uint32Array
  origin: [number, number, number]
  signs: [number, number, number]
}

export interface Cut {
  /** Ends of segments in space, six numbers each. */
  segments: number[]
  /** For each segment, whether it is part of closed lines only: these enclose material by the even-odd rule. */
  closed: boolean[]
}

/** Ends of lines nearer than this share of the model's size are one place. */
const SAME_PLACE = 1e-9
/** Open ends nearer than this share of the model's size are joined: edges of neighbours that differ by their facets. */
const JOINED = 2e-4
/** Open ends that are looked through for a partner. */
const MOST_OPEN = 4000

type Emit = (ax: number, ay: number, az: number, bx: number, by: number, bz: number) => void

/** Hands on the segment of each triangle that the plane meets. A vertex in the plane counts as above it. */
function segmentsOf(of: Cuttable, axis: number, value: number, emit: Emit): void {
  const { position, triangle, origin, signs } = of
  const level = signs[axis] * value - origin[axis]
  const ends = [0, 0, 0, 0, 0, 0]
  for (let t = 0; t < triangle.length; t += 3) {
    let above = 0
    for (let k = 0; k < 3; k++) if (position[3 * triangle[t + k] + axis] >= level) above |= 1 << k
    if (above === 0 || above === 7) continue
    let found = 0
    for (let k = 0; k < 3; k++) {
      const next = (k + 1) % 3
      if (((above >> k) & 1) === ((above >> next) & 1)) continue
      // From below upward, so that both triangles at an edge find the same place, to the bit.
      const [low, high] = (above >> k) & 1 ? [next, k] : [k, next]
      const [a, b] = [3 * triangle[t + low], 3 * triangle[t + high]]
      const share = (level - position[a + axis]) / (position[b + axis] - position[a + axis])
      for (let c = 0; c < 3; c++) {
        const x = c === axis ? level : position[a + c] + share * (position[b + c] - position[a + c])
        ends[3 * found + c] = signs[c] * (x + origin[c])
      }
      found++
    }
    emit(ends[0], ends[1], ends[2], ends[3], ends[4], ends[5])
  }
}

class Places {
  private readonly known = new Map<string, number>()
  readonly at: number[][] = []
  readonly degree: number[] = []
  private readonly root: number[] = []

  constructor(
    private readonly axes: [number, number],
    private readonly grid: number,
  ) {}

  find(p: number[]): number {
    const [u, v] = this.axes.map((c) => Math.round(p[c] / this.grid))
    const key = `${u},${v}`
    let found = this.known.get(key)
    if (found === undefined) {
      found = this.at.length
      this.known.set(key, found)
      this.at.push(p)
      this.degree.push(0)
      this.root.push(found)
    }
    return found
  }

  group(k: number): number {
    let at = k
    while (this.root[at] !== at) {
      this.root[at] = this.root[this.root[at]]
      at = this.root[at]
    }
    return at
  }

  join(a: number, b: number): void {
    this.degree[a]++
    this.degree[b]++
    this.root[this.group(a)] = this.group(b)
  }

  /** Pairs of open ends that are nearer than `within`, the nearest first. */
  partners(within: number): [number, number][] {
    const open = this.degree.flatMap((d, k) => (d % 2 ? [k] : [])).slice(0, MOST_OPEN)
    const [u, v] = this.axes
    const pairs: [number, number, number][] = []
    for (let i = 0; i < open.length; i++)
      for (let j = i + 1; j < open.length; j++) {
        const [p, q] = [this.at[open[i]], this.at[open[j]]]
        const d = Math.hypot(p[u] - q[u], p[v] - q[v])
        if (d <= within) pairs.push([d, open[i], open[j]])
      }
    const taken = new Set<number>()
    const found: [number, number][] = []
    for (const [, i, j] of pairs.sort((a, b) => a[0] - b[0])) {
      if (taken.has(i) || taken.has(j)) continue
      taken.add(i).add(j)
      found.push([i, j])
    }
    return found
  }
}

/**
 * Cuts triangles by the plane where a coordinate has a value.
 *
 * `size` is the model's, by which ends of lines are told apart. Lines that stay open enclose nothing, and neither does
 * what is joined to them.
 */
export function cut(all: Cuttable[], axis: number, value: number, size: number): Cut {
  const places = new Places([(axis + 1) % 3, (axis + 2) % 3], SAME_PLACE * size || 1)
  const segments: number[] = []
  const first: number[] = []
  const add = (a: number, b: number, pa: number[], pb: number[]) => {
    if (a === b) return
    places.join(a, b)
    first.push(a)
    segments.push(...pa, ...pb)
  }
  for (const of of all)
    segmentsOf(of, axis, value, (ax, ay, az, bx, by, bz) => {
      const [p, q] = [
        [ax, ay, az],
        [bx, by, bz],
      ]
      add(places.find(p), places.find(q), p, q)
    })
  for (const [a, b] of places.partners(JOINED * size)) add(a, b, places.at[a], places.at[b])
  const open = new Set<number>()
  places.degree.forEach((d, k) => d % 2 && open.add(places.group(k)))
  return { segments, closed: first.map((k) => !open.has(places.group(k))) }
}
