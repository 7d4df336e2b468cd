import { expect, test } from 'vitest'
import { duplicated, labels } from '../src/board_edit'
import type { Drawn } from '../src/board_paint'

const drawn = {
  section: null,
  points: [
    [1, 0, 0],
    [2, 10, 0],
    [5, 10, 8],
    [6, 0.1, 8],
  ],
  lines: [
    [1, 1, 2, 'X', 'user', 1],
    [2, 2, 5, 'XY', 'user', 1],
    [9, 5, 6, 'X', 'auto', 0.7],
  ],
} as unknown as Drawn

test('marks are told apart by what they are of', () => {
  expect(labels(new Set(['p3', 'l12', 'p10']), 'p')).toEqual([3, 10])
  expect(labels(['p3', 'l12'], 'l')).toEqual([12])
})

test('lines that meet still meet in their copies, and given types go with them', () => {
  const made = duplicated(drawn, ['l1', 'l2'], [2, -1])
  expect(made.commands).toEqual([
    'POINT 7 AT 2 -1',
    'POINT 8 AT 12 -1',
    'POINT 9 AT 12 7',
    'LINE 10 FROM 7 TO 8 TYPE X',
    'LINE 11 FROM 8 TO 9 TYPE H',
  ])
  expect(made.chosen).toEqual(['p7', 'p8', 'p9', 'l10', 'l11'])
})

test('guessed types are guessed again, single points are copied, nothing makes nothing', () => {
  const made = duplicated(drawn, ['l9', 'p1'], [0.2, 0])
  expect(made.commands).toEqual(['POINT 7 AT 0.2 0', 'POINT 8 AT 10.2 8', 'POINT 9 AT 0.3 8', 'LINE 10 FROM 8 TO 9'])
  expect(duplicated(drawn, [], [1, 1]).commands).toEqual([])
})
