import { expect, test } from 'vitest'
import { type Cut, type Cuttable, cut } from '../src/cut'

/** The area that closed segments enclose by the even-odd rule, by lines across them. */
function enclosed({ segments, closed }: Cut, axis: number, lines = 1800): number {
  const [u, v] = [(axis + 1) % 3, (axis + 2) % 3]
  const all = closed.flatMap((on, k) =>
    on ? [[segments[6 * k + u], segments[6 * k + v], segments[6 * k + 3 + u], segments[6 * k + 3 + v]]] : [],
  )
  if (!all.length) return 0
  const low = Math.min(...all.map((s) => Math.min(s[1], s[3])))
  const high = Math.max(...all.map((s) => Math.max(s[1], s[3])))
  const step = (high - low) / lines
  let area = 0
  for (let k = 0; k < lines; k++) {
    const y = low + (k + 0.5) * step
    const hits = all
      .flatMap(([a, b, c, d]) => (b <= y !== d <= y ? [a + ((y - b) / (d - b)) * (c - a)] : []))
      .sort((p, q) => p - q)
    for (let j = 0; j + 1 < hits.length; j += 2) area += (hits[j + 1] - hits[j]) * step
  }
  return area
}

/** A box from low to high in triangles, each face with vertices of its own as patches have. */
function box(low: number[], high: number[], signs: [number, number, number] = [1, 1, 1]): Cuttable {
  const [position, triangle]: number[][] = [[], []]
  for (let axis = 0; axis < 3; axis++)
    for (const end of [low, high]) {
      const first = position.length / 3
      for (const [a, b] of [
        [0, 0],
        [1, 0],
        [1, 1],
        [0, 1],
      ]) {
        const p = [0, 0, 0]
        p[axis] = end[axis]
        p[(axis + 1) % 3] = (a ? high : low)[(axis + 1) % 3]
        p[(axis + 2) % 3] = (b ? high : low)[(axis + 2) % 3]
        position.push(...p)
      }
      triangle.push(first, first + 1, first + 2, first, first + 2, first + 3)
    }
  return { position: Float32Array.from(position), triangle: Uint32Array.from(triangle), origin: [0, 0, 0], signs }
}

test('a box encloses its section across each axis', () => {
  for (const [axis, area] of [6, 3, 2].entries()) {
    const found = cut([box([0, 0, 0], [1, 2, 3])], axis, 0.4, 4)
    expect(found.closed.every(Boolean)).toBe(true)
    expect(enclosed(found, axis)).toBeCloseTo(area, 9)
  }
})

test('a cavity is left out, and what is in it counts again', () => {
  const all = [box([0, 0, 0], [9, 9, 9]), box([2, 2, 2], [7, 7, 7]), box([4, 4, 4], [5, 5, 5])]
  expect(enclosed(cut(all, 2, 4.5, 16), 2)).toBeCloseTo(81 - 25 + 1, 2)
})

test('an open shell encloses nothing, and does not spoil a closed one beside it', () => {
  const open = box([0, 0, 0], [1, 1, 1])
  open.triangle = open.triangle.slice(6)
  const found = cut([open, box([3, 0, 0], [5, 2, 2])], 2, 0.5, 6)
  expect(found.closed).toContain(false)
  expect(enclosed(found, 2)).toBeCloseTo(4, 9)
})

test('a half and its mirror image close together', () => {
  const half = box([-1, 0, -1], [1, 2, 1])
  // Without the face in the middle plane it is open.
  half.triangle = half.triangle.filter((_, k) => Math.floor(k / 6) !== 2)
  expect(enclosed(cut([half], 0, 0.3, 4), 0)).toBe(0)
  const both = cut([half, { ...half, signs: [1, -1, 1] }], 0, 0.3, 4)
  expect(both.closed.every(Boolean)).toBe(true)
  expect(enclosed(both, 0)).toBeCloseTo(8, 9)
})

test('a plane through vertices cuts once', () => {
  for (const z of [0, 1]) {
    const found = cut([box([0, 0, -1], [1, 1, 0]), box([0, 0, 0], [1, 1, 1])], 2, z, 3)
    expect(found.closed.every(Boolean)).toBe(true)
    expect([0, 1]).toContain(Math.round(1e9 * enclosed(found, 2)) / 1e9)
  }
})

test('an ellipsoid of many triangles has the area of its ellipse', () => {
  const [n, position, triangle] = [60, [] as number[], [] as number[]]
  for (let i = 0; i <= n; i++)
    for (let j = 0; j <= 2 * n; j++) {
      const [t, f] = [(Math.PI * i) / n, (Math.PI * (j % (2 * n))) / n]
      position.push(3 * Math.sin(t) * Math.cos(f), 2 * Math.sin(t) * Math.sin(f), Math.cos(t))
      const a = i * (2 * n + 1) + j
      if (i < n && j < 2 * n) triangle.push(a, a + 1, a + 2 * n + 2, a, a + 2 * n + 2, a + 2 * n + 1)
    }
  const of: Cuttable = {
    position: Float32Array.from(position),
    triangle: Uint32Array.from(triangle),
    origin: [100, 0, 0],
    signs: [1, 1, 1],
  }
  const found = cut([of], 2, 0.5, 7)
  expect(found.closed.every(Boolean)).toBe(true)
  expect(enclosed(found, 2) / (Math.PI * 6 * 0.75)).toBeCloseTo(1, 2)
})
