// The solids that fit an ambiguous wireframe, small and beside each other; a click chooses one.

import { Vector3 } from 'three'
import type { SolidFacts } from './board_solid'
import { h, s } from './dom'

/** Size of a small picture, in picture points. */
const [WIDE, HIGH, MARGIN] = [88, 66, 5]

export interface Shape {
  vertices: number[]
  quads: number[]
}

/** The faces of a solid as they are seen along a direction, those behind first: corners, and how light they are. */
export function faces(
  { vertices, quads }: Shape,
  direction: Vector3,
): { corners: [number, number][]; light: number }[] {
  const d = direction.clone().normalize()
  const right = new Vector3(-d.y, d.x, 0)
  if (right.length() < 1e-9) right.set(1, 0, 0)
  right.normalize()
  const up = d.clone().cross(right)
  const places = Array.from({ length: vertices.length / 3 }, (_, k) => new Vector3(...vertices.slice(3 * k, 3 * k + 3)))
  const flat = places.map((p): [number, number] => [p.dot(right), -p.dot(up)])
  const span = (k: 0 | 1) => [Math.min(...flat.map((p) => p[k])), Math.max(...flat.map((p) => p[k]))]
  const [[x0, x1], [y0, y1]] = [span(0), span(1)]
  const scale = Math.min((WIDE - 2 * MARGIN) / (x1 - x0 || 1), (HIGH - 2 * MARGIN) / (y1 - y0 || 1))
  const put = ([x, y]: [number, number]): [number, number] => [
    WIDE / 2 + scale * (x - (x0 + x1) / 2),
    HIGH / 2 + scale * (y - (y0 + y1) / 2),
  ]
  const all = Array.from({ length: quads.length / 4 }, (_, k) => quads.slice(4 * k, 4 * k + 4)).map((face) => {
    const [a, b, c] = face.map((i) => places[i])
    const normal = b.clone().sub(a).cross(c.clone().sub(a)).normalize()
    const depth = face.reduce((sum, i) => sum + places[i].dot(d), 0) / 4
    return {
      depth,
      corners: face.map((i) => put(flat[i])),
      light: normal.dot(new Vector3(0.3, -0.5, 0.8).normalize()),
      seen: normal.dot(d) > 0,
    }
  })
  return all.filter((f) => f.seen).sort((a, b) => a.depth - b.depth)
}

/** A row of small pictures; nothing for a wireframe that one solid fits. */
export function candidates(solid: SolidFacts, direction: Vector3, choose: (n: number) => void): HTMLElement[] {
  const all = solid.candidates ?? []
  const shown = JSON.stringify(solid.quads)
  return all.map((shape, k) => {
    const polygons = faces(shape, direction).map((f) =>
      s('polygon', {
        points: f.corners.map((c) => c.map((x) => x.toFixed(1)).join()).join(' '),
        fill: `hsl(210 30% ${Math.round(62 + 18 * f.light)}%)`,
      }),
    )
    const words = `solid ${k + 1} of ${all.length}`
    return h(
      'button',
      {
        'aria-label': words,
        title: solid.exact ? `Choose ${words}` : `${words}: it can be chosen when no dimension is missing`,
        'aria-pressed': JSON.stringify(shape.quads) === shown,
        disabled: !solid.exact,
        onclick: () => choose(k + 1),
      },
      s('svg', { viewBox: `0 0 ${WIDE} ${HIGH}`, width: WIDE, height: HIGH }, ...polygons) as unknown as HTMLElement,
    )
  })
}
