// Handles at the selected point: arrows along the axes, and squares in the planes between them.

import type { Vector3 } from 'three'
import { AXIS_INKS } from './colour'
import { h, s } from './dom'
import type { View } from './view'

/** Picture points from the point to the tip of an arrow. */
const REACH = 62
/** An arrow or square that is seen shorter than this share of its length is left out. */
const SEEN = 0.2

export class Gumball {
  readonly element = h('div', { class: 'gumball' })
  private readonly svg = s('svg', { 'aria-hidden': 'true' })
  private drawn = ''

  /** `grip`: a handle was pressed: along an axis, or in the plane across one. */
  constructor(
    private readonly view: View,
    private readonly at: () => Vector3 | null,
    private readonly grip: (e: PointerEvent, axis: number | null, plane: number | null) => void,
  ) {
    this.element.append(this.svg)
    // The browser would drag what is selected in the page, and take the focus from the picture.
    this.element.addEventListener('mousedown', (e) => e.preventDefault())
  }

  draw(): void {
    const place = this.at()
    const [x, y] = place ? this.view.project(place) : [0, 0]
    const { right, up } = this.view.camera
    const key = place ? [x, y, ...right.toArray(), ...up.toArray()].map((n) => n.toFixed(2)).join() : ''
    if (key === this.drawn) return
    this.drawn = key
    this.svg.replaceChildren()
    if (!place) return
    const ways = [0, 1, 2].map((k) => [REACH * right.getComponent(k), -REACH * up.getComponent(k)])
    const handle = (part: SVGElement, words: string, axis: number | null, plane: number | null) => {
      part.setAttribute('data-handle', words)
      part.append(s('title', {}, words))
      part.addEventListener('pointerdown', (e) => {
        if ((e as PointerEvent).button !== 0) return
        e.stopPropagation()
        this.grip(e as PointerEvent, axis, plane)
      })
      this.svg.append(part)
    }
    for (let k = 0; k < 3; k++) {
      const [dx, dy] = ways[k]
      const length = Math.hypot(dx, dy)
      if (length < SEEN * REACH) continue
      const [ux, uy] = [dx / length, dy / length]
      const [tx, ty] = [x + dx, y + dy]
      const head = `${tx},${ty} ${tx - 10 * ux + 4.5 * uy},${ty - 10 * uy - 4.5 * ux} ${tx - 10 * ux - 4.5 * uy},${ty - 10 * uy + 4.5 * ux}`
      const line = (width: number, ink: string) =>
        s('line', {
          x1: x + 9 * ux,
          y1: y + 9 * uy,
          x2: tx - 6 * ux,
          y2: ty - 6 * uy,
          stroke: ink,
          'stroke-width': width,
        })
      handle(
        s(
          'g',
          { class: 'axis' },
          line(12, 'transparent'),
          line(2.4, AXIS_INKS[k]),
          s('polygon', { points: head, fill: AXIS_INKS[k] }),
        ),
        `along ${'xyz'[k]}`,
        k,
        null,
      )
    }
    // Over the arrows, which pass beside them in some views.
    for (let k = 0; k < 3; k++) {
      const [a, b] = [ways[(k + 1) % 3], ways[(k + 2) % 3]]
      if (Math.abs(a[0] * b[1] - a[1] * b[0]) < SEEN * REACH * REACH) continue
      const corners = [
        [0.3, 0.3],
        [0.52, 0.3],
        [0.52, 0.52],
        [0.3, 0.52],
      ].map(([m, n]) => `${x + m * a[0] + n * b[0]},${y + m * a[1] + n * b[1]}`)
      handle(
        s('polygon', { points: corners.join(' '), fill: AXIS_INKS[k], class: 'plane' }),
        `in the plane ${'xyz'.replace('xyz'[k], '')}`,
        null,
        k,
      )
    }
  }
}
