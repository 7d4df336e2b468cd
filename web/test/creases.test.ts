import { expect, test } from 'vitest'
import { creases, isTriangulation } from '../src/creases'

/** A strip of three squares in two triangles each: flat, then bent by an angle. */
function strip(angle: number) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)]
  const line = [
    [0, 0],
    [1, 0],
    [2, 0],
    [2 + c, s],
  ]
  const position = Float32Array.from(line.flatMap(([x, z]) => [x, 0, z, x, 1, z]))
  const [triangle, edge, rim]: number[][] = [[], [], []]
  for (let k = 0; k < 3; k++) {
    const a = 2 * k
    triangle.push(a, a + 2, a + 3, a, a + 3, a + 1)
    edge.push(a, a + 3)
    rim.push(a, a + 2, a + 1, a + 3)
    if (k) edge.push(a, a + 1)
  }
  rim.push(0, 1, 6, 7)
  return { position, triangle: Uint32Array.from(triangle), edge: Uint32Array.from(edge), rim: Uint32Array.from(rim) }
}

test('only the bend is an edge', () => {
  const { position, triangle, edge, rim } = strip(1)
  expect(isTriangulation(triangle, edge, rim)).toBe(true)
  expect([...creases(position, triangle, edge)]).toEqual([4, 5])
  expect(creases(strip(0.2).position, triangle, edge).length).toBe(0)
})

test('copies of vertices at the bend do not hide it', () => {
  const { position, triangle, edge } = strip(1)
  const copied = Float32Array.from([...position, ...position.slice(12, 18)])
  const turned = triangle.map((v, k) => (k >= 12 && (v === 4 || v === 5) ? v + 4 : v))
  expect([...creases(copied, turned, edge)]).toEqual([4, 5])
})

test('quadrilaterals are no triangulation', () => {
  const { triangle, edge, rim } = strip(1)
  const sides = edge.filter((_, k) => Math.floor(k / 2) % 2 === 1 || k >= 8)
  expect(isTriangulation(triangle, sides, rim)).toBe(false)
  expect(isTriangulation(new Uint32Array(), new Uint32Array(), new Uint32Array())).toBe(false)
})
