import { expect, test } from 'vitest'
import { panes } from '../src/panes'

test('each place of the picture is in one view', () => {
  for (const [width, height] of [
    [801, 601],
    [800, 600],
    [3, 2],
    [1, 1],
  ])
    for (const four of [false, true]) {
      const all = panes(width, height, four)
      expect(all.reduce((sum, p) => sum + p.width * p.height, 0)).toBe(width * height)
      for (let x = 0; x < Math.min(width, 9); x++)
        for (const y of [0, height - 1]) {
          const at = all.filter((p) => x >= p.left && x < p.left + p.width && y >= p.top && y < p.top + p.height)
          expect(at.length).toBe(1)
        }
    }
})
