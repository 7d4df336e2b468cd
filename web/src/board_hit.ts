// What of a drawing is meant by a place on the screen.

import type { Drawn, Place } from './board_paint'

/** A point or a line by its label. */
export interface Hit {
  point?: number
  line?: number
}

const far = (a: Place, b: Place) => Math.hypot(a[0] - b[0], a[1] - b[1])

/** The distance of a place from the stretch between two. */
function beside(at: Place, a: Place, b: Place): number {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]]
  const t = ((at[0] - a[0]) * dx + (at[1] - a[1]) * dy) / Math.max(1e-9, dx * dx + dy * dy)
  const k = Math.max(0, Math.min(1, t))
  return far(at, [a[0] + k * dx, a[1] + k * dy])
}

/**
 * The nearest point within reach, else the nearest line.
 *
 * A point leaves the middle third of its lines to them, so that short ones can be meant, too.
 */
export function hit(at: Place, places: Map<number, Place>, lines: Drawn['lines'], reach: number): Hit {
  const reaches = new Map<number, number>()
  for (const [, p, q] of lines) {
    const [a, b] = [places.get(p), places.get(q)]
    if (!a || !b) continue
    for (const end of [p, q]) reaches.set(end, Math.min(reaches.get(end) ?? reach, far(a, b) / 3))
  }
  let best = reach
  let found: Hit = {}
  for (const [id, p] of places) {
    const d = far(p, at)
    if (d <= best && d <= (reaches.get(id) ?? reach)) [best, found] = [d, { point: id }]
  }
  if (found.point) return found
  for (const [id, p, q] of lines) {
    const [a, b] = [places.get(p), places.get(q)]
    if (!a || !b) continue
    const d = beside(at, a, b)
    if (d <= best) [best, found] = [d, { line: id }]
  }
  return found
}
