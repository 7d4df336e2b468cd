// Orientation and size in a corner of the picture: a cube whose faces are views, and a bar of a round length.

import type { Camera, Standard } from './camera'
import { AXIS_INKS } from './colour'
import { h, shown } from './dom'
import { model } from './state'

/** The view that looks at each face: those at +x, -x, +y, -y, +z, -z. */
const VIEWS: Standard[] = ['stern', 'body', 'starboard', 'profile', 'plan', 'bottom']
const SIZE = 88
const HALF = 23
const LONGEST_BAR = 120

export class Orientation {
  private readonly cube = h('canvas', { class: 'cube', width: 2 * SIZE, height: 2 * SIZE, 'aria-hidden': 'true' })
  private readonly bar = h('div', { class: 'scale-bar', role: 'img', 'aria-label': 'scale' })
  private over = -1
  readonly element = h('div', { class: 'orientation' }, this.cube, this.bar)

  constructor(
    private readonly seen: () => Camera,
    private readonly look: (view: Standard) => void,
    private readonly height: () => number,
  ) {}

  private get camera(): Camera {
    return this.seen()
  }

  /** The picture hears the pointer: a point that is under the cube can be dragged. */
  hover(e: MouseEvent): void {
    const face = this.at(e)
    if (face === this.over) return
    this.over = face
    this.draw()
  }

  /** True when a face was clicked. */
  click(e: MouseEvent): boolean {
    const face = this.at(e)
    if (face >= 0) this.look(VIEWS[face])
    return face >= 0
  }

  private facing(face: number): number {
    return (face % 2 ? -1 : 1) * this.camera.towards.getComponent(face >> 1)
  }

  /** A corner of the cube in the canvas, by signs. */
  private corner(p: number[]): [number, number] {
    const { right: r, up: u } = this.camera
    const along = (v: typeof r) => p.reduce((sum, x, k) => sum + x * v.getComponent(k), 0)
    return [SIZE / 2 + HALF * along(r), SIZE / 2 - HALF * along(u)]
  }

  private outline(face: number): [number, number][] {
    const [k, sign] = [face >> 1, face % 2 ? -1 : 1]
    return [
      [-1, -1],
      [1, -1],
      [1, 1],
      [-1, 1],
    ].map(([a, b]) => {
      const p = [0, 0, 0]
      ;[p[k], p[(k + 1) % 3], p[(k + 2) % 3]] = [sign, a, b]
      return this.corner(p)
    })
  }

  private at(e: MouseEvent): number {
    const box = this.cube.getBoundingClientRect()
    const [x, y] = [e.clientX - box.left, e.clientY - box.top]
    return [0, 1, 2, 3, 4, 5].findIndex((face) => this.facing(face) > 0.05 && inside(this.outline(face), x, y))
  }

  draw(): void {
    this.drawBar()
    const c = this.cube.getContext('2d')
    if (!c) return
    const style = getComputedStyle(this.cube)
    c.setTransform(2, 0, 0, 2, 0, 0)
    c.clearRect(0, 0, SIZE, SIZE)
    c.textAlign = 'center'
    c.textBaseline = 'middle'
    c.font = '600 11px system-ui'
    for (let face = 0; face < 6; face++) {
      if (this.facing(face) <= 0.02) continue
      const corners = this.outline(face)
      c.beginPath()
      corners.forEach(([x, y], k) => (k ? c.lineTo(x, y) : c.moveTo(x, y)))
      c.closePath()
      c.fillStyle = style.getPropertyValue(face === this.over ? '--accent-soft' : '--paper')
      c.strokeStyle = style.getPropertyValue('--quiet')
      c.lineWidth = 1
      c.fill()
      c.stroke()
      if (this.facing(face) < 0.25) continue
      const [x, y] = [0, 1].map((k) => corners.reduce((sum, p) => sum + p[k] / 4, 0))
      c.fillStyle = AXIS_INKS[face >> 1]
      c.fillText(`${face % 2 ? '−' : ''}${'xyz'[face >> 1]}`, x, y)
    }
  }

  private drawBar(): void {
    const grain = this.camera.grain(this.height())
    const longest = LONGEST_BAR * grain
    const power = 10 ** Math.floor(Math.log10(longest))
    const length = power * (longest >= 5 * power ? 5 : longest >= 2 * power ? 2 : 1)
    const words = `${shown(length)} ${model.unit}`.trim()
    if (this.bar.textContent !== words) this.bar.textContent = words
    this.bar.style.width = `${length / grain}px`
  }
}

function inside(corners: [number, number][], x: number, y: number): boolean {
  let odd = false
  corners.forEach(([x0, y0], k) => {
    const [x1, y1] = corners[(k + 1) % corners.length]
    if (y0 > y !== y1 > y && x < x0 + ((x1 - x0) * (y - y0)) / (y1 - y0)) odd = !odd
  })
  return odd
}
