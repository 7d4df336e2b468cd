import { expect, test } from 'vitest'
import { corners, type Placed, scaled, slope, turn } from '../src/board_underlay'

const placed: Placed = { middle: [10, 20], size: [40, 20], angle: 0 }

test('a picture is scaled about the corner opposite to the one that is dragged', () => {
  expect(corners(placed)).toEqual([
    [-10, 10],
    [30, 10],
    [30, 30],
    [-10, 30],
  ])
  const larger = scaled(placed, 2, [70, 50], 1)
  expect(larger.size).toEqual([80, 40])
  expect(corners(larger)[0]).toEqual([-10, 10])
  expect(corners(larger)[2]).toEqual([70, 50])
  // A turned one as well, and none vanishes or is turned over.
  const aslant = { ...placed, angle: 30 }
  const [fixed] = corners(aslant)
  expect(corners(scaled(aslant, 2, [90, 90], 1))[0][0]).toBeCloseTo(fixed[0], 12)
  expect(scaled(placed, 2, [-500, -500], 5).size).toEqual([10, 5])
})

test('lines along the axes give angles, and the turn of a picture', () => {
  expect(
    slope([
      [0, 0],
      [2, 2],
    ]),
  ).toBe(45)
  expect(
    slope([
      [0, 0],
      [10, -1],
    ]),
  ).toBe(354.3)
  expect(turn([3, 95], [0, 90])).toBeCloseTo(-4)
  expect(turn([359, 91], [0, 90])).toBeCloseTo(0)
  expect(Math.abs(turn([181, 269], [0, 90]))).toBeCloseTo(180)
})
