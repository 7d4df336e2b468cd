import { Box3, Vector3 } from 'three'
import { expect, test } from 'vitest'
import { area, Ground, gridLines, round } from '../src/ground'

test('cells are 1, 2 or 5 times a power of ten', () => {
  for (const [length, cell] of [
    [1, 1],
    [1.9, 1],
    [2, 2],
    [4.99, 2],
    [5, 5],
    [99, 50],
    [0.03, 0.02],
  ])
    expect(round(length)).toBeCloseTo(cell, 12)
})

test('a grid has lines at multiples of its cell over the whole area', () => {
  const box = new Box3(new Vector3(-3, 0, 1), new Vector3(27, 8, 4))
  const [x0, y0, x1, y1] = area(box)
  const flat = gridLines([x0, y0, x1, y1])
  const ends = Array.from({ length: flat.length / 3 }, (_, k) => [...flat.subarray(3 * k, 3 * k + 3)])
  expect(ends.every(([x, y, z]) => x % 2 === 0 && y % 2 === 0 && z === 0)).toBe(true)
  expect(Math.min(...ends.map((p) => p[0]))).toBeLessThanOrEqual(x0)
  expect(Math.max(...ends.map((p) => p[1]))).toBeGreaterThanOrEqual(y1)
})

test('water is of floating models only, and both are toggled', () => {
  const ground = new Ground()
  const box = new Box3(new Vector3(0, -1, -1), new Vector3(9, 1, 1))
  ground.water = ground.grid = true
  ground.follow(box, false, false)
  expect(ground.shown).toEqual({ water: false, grid: true })
  ground.follow(box, true, true)
  expect(ground.shown).toEqual({ water: true, grid: true })
  expect(ground.within(box).max.x).toBeGreaterThan(9)
  ground.water = ground.grid = false
  ground.follow(box, true, false)
  expect(ground.within(box)).toBe(box)
})
