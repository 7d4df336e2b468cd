import { expect, test } from 'vitest'
import { hit } from '../src/board_hit'
import type { Drawn, Place } from '../src/board_paint'

const line = (id: number, p: number, q: number): Drawn['lines'][0] => [id, p, q, '', '', 0]
const places = new Map<number, Place>([
  [1, [0, 0]],
  [2, [12, 0]],
  [3, [200, 0]],
  [4, [12, 80]],
])
const lines = [line(1, 1, 2), line(2, 2, 3), line(3, 2, 4)]

test('the middle third of a short line is that line, its ends are points', () => {
  for (const x of [4.5, 6, 7.5]) expect(hit([x, 1], places, lines, 11)).toEqual({ line: 1 })
  expect(hit([3, 1], places, lines, 11)).toEqual({ point: 1 })
  expect(hit([9, 1], places, lines, 11)).toEqual({ point: 2 })
})

test('a point of long lines reaches as far as the pointer does', () => {
  expect(hit([190, 2], places, lines, 11)).toEqual({ point: 3 })
  expect(hit([188, 2], places, lines, 11)).toEqual({ line: 2 })
  expect(hit([12, 71], places, lines, 11)).toEqual({ point: 4 })
})

test('what is beyond the reach, or has no place, is not meant', () => {
  expect(hit([100, 12], places, lines, 11)).toEqual({})
  expect(hit([0, 50], places, [line(9, 1, 7)], 11)).toEqual({})
  expect(hit([0, 0], new Map(), [], 11)).toEqual({})
})

test('a point without lines, and a line without length', () => {
  const two = new Map<number, Place>([
    [1, [0, 0]],
    [2, [0, 0]],
  ])
  expect(hit([5, 5], two, [], 11)).toEqual({ point: 2 })
  expect(hit([5, 5], two, [line(1, 1, 2)], 11)).toEqual({ line: 1 })
})
