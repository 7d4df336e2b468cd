import { Vector3 } from 'three'
import { expect, test } from 'vitest'
import { faces } from '../src/board_candidates'

const CUBE = {
  vertices: [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1],
  quads: [0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7],
}

test('the faces of a small picture are those towards the eye, within its frame', () => {
  const seen = faces(CUBE, new Vector3(1, -2, 1))
  expect(seen.length).toBe(3)
  for (const { corners } of seen)
    for (const [x, y] of corners) {
      expect(x).toBeGreaterThanOrEqual(0)
      expect(x).toBeLessThanOrEqual(88)
      expect(y).toBeGreaterThanOrEqual(0)
      expect(y).toBeLessThanOrEqual(66)
    }
  // From above one face is seen.
  expect(faces(CUBE, new Vector3(0, 0, 1)).length).toBe(1)
})
