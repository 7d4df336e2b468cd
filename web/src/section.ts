// A section of the picture: a plane across an axis that is dragged, the half before it taken away, the cut hatched.

import { Vector3 } from 'three'
import { ink } from './colour'
import { type Cuttable, cut } from './cut'
import { h, shown } from './dom'
import { model } from './state'
import type { View } from './view'

export interface SectionActions {
  say(words: string): void
  /** The number that a text means. */
  typed(text: string): Promise<number>
  /** The section was begun or ended. */
  changed(): void
}

/** The face of the cut is this share of the model's size inside what is kept, so that the clipping plane spares it. */
const LIFT = 2e-5
/** An axis that is seen shorter than this, in picture points for the model's size, is dragged up and down instead. */
const SEEN = 24

export class SectionPlane {
  private readonly knob = h('div', { class: 'knob', title: 'Drag the plane of the section', hidden: true })
  private slider = h('input', { type: 'range' })
  private field = h('input', { type: 'text' })

  constructor(
    private readonly view: View,
    private readonly panel: HTMLElement,
    private readonly act: SectionActions,
  ) {
    view.canvas.parentElement!.append(this.knob)
    this.knob.addEventListener('pointerdown', (e) => this.drag(e))
  }

  /** The axis that is cut across; null where nothing is. */
  get axis(): number | null {
    return this.view.clip?.axis ?? null
  }

  /** Cuts across an axis through the middle of what is seen, or no more. */
  cut(axis: number | null): void {
    const { view } = this
    const on = axis !== null && !view.box.isEmpty()
    this.panel.hidden = this.knob.hidden = !on
    if (!on) {
      view.clip = null
      this.show()
      this.act.changed()
      return
    }
    const [low, high] = this.range(axis)
    // The half that is nearer to the eye hides the cut.
    view.clip = { axis, value: (low + high) / 2, flip: view.camera.towards.getComponent(axis) < 0 }
    this.build(axis, low, high)
    this.show()
    this.act.changed()
  }

  private range(axis: number): [number, number] {
    const { min, max } = this.view.box
    return [min.getComponent(axis), max.getComponent(axis)]
  }

  private build(axis: number, low: number, high: number): void {
    const name = 'xyz'[axis]
    this.slider = h('input', { type: 'range', min: low, max: high, step: 'any', 'aria-label': `section at ${name}` })
    this.slider.addEventListener('input', () => this.move(this.slider.valueAsNumber))
    this.field = h('input', { type: 'text', class: 'number', 'aria-label': `section at ${name}, value` })
    const enter = async () => {
      try {
        if (this.field.value !== this.words()) this.move(await this.act.typed(this.field.value))
      } catch (error) {
        this.act.say((error as Error).message)
      }
      this.show()
    }
    this.field.addEventListener('keydown', (e) => e.key === 'Enter' && void enter())
    this.field.addEventListener('blur', () => void enter())
    const flip = () => {
      this.view.clip!.flip = !this.view.clip!.flip
      this.show()
    }
    this.panel.replaceChildren(
      `${name} =`,
      this.field,
      model.unit,
      this.slider,
      h('button', { onclick: flip }, 'Flip'),
      h(
        'button',
        { class: 'icon', 'aria-label': 'no section', title: 'No section (Esc)', onclick: () => this.cut(null) },
        '×',
      ),
    )
  }

  private words(): string {
    return shown(this.view.clip?.value ?? 0, 5)
  }

  private move(value: number): void {
    const { clip } = this.view
    if (!clip) return
    const [low, high] = this.range(clip.axis)
    clip.value = Math.max(low, Math.min(high, value))
    this.show()
  }

  /** Follows the model and the plane. */
  show(): void {
    const { view } = this
    const { clip } = view
    if (!clip) {
      view.overlay('section', null)
      view.overlay('section-frame', null)
      view.cap.fill(null)
      view.dots()
      return
    }
    this.slider.value = String(clip.value)
    if (document.activeElement !== this.field) this.field.value = this.words()
    const size = view.box.getSize(new Vector3()).length()
    const found = cut(this.drawn(), clip.axis, clip.value, size)
    view.cap.fill(found, clip.axis, (clip.flip ? 1 : -1) * LIFT * size)
    const runs = found.closed.map((_, k) => found.segments.slice(6 * k, 6 * k + 6))
    view.overlay('section', runs, ink('cut'), 1.8)
    view.overlay('section-frame', [this.frame(clip.axis, clip.value)], ink('guide'), 1)
    view.dots()
  }

  /** The triangles that are seen, and those of the mirror images. */
  private drawn(): Cuttable[] {
    return this.view.images().flatMap((signs) =>
      [...this.view.items.values()]
        .filter((i) => i.kind === 'patch' && this.view.seen(i))
        .map((i) => ({
          position: i.position,
          triangle: i.triangle,
          origin: i.origin.toArray() as [number, number, number],
          signs,
        })),
    )
  }

  /** The outline of the plane within the model's box, a little larger. */
  private frame(axis: number, value: number): number[] {
    const box = this.view.box.clone().expandByScalar(0.04 * this.view.box.getSize(new Vector3()).length())
    const [u, v] = [(axis + 1) % 3, (axis + 2) % 3]
    return [
      [0, 0],
      [1, 0],
      [1, 1],
      [0, 1],
      [0, 0],
    ].flatMap(([a, b]) => {
      const p = [0, 0, 0]
      p[axis] = value
      p[u] = (a ? box.max : box.min).getComponent(u)
      p[v] = (b ? box.max : box.min).getComponent(v)
      return p
    })
  }

  /** Puts the knob at the highest corner of the plane, after each frame. */
  placed(): void {
    const { clip } = this.view
    if (!clip || this.view.box.isEmpty()) return
    const frame = this.frame(clip.axis, clip.value)
    const corners = [0, 1, 2, 3].map((k) => this.view.project(new Vector3().fromArray(frame, 3 * k)))
    const [x, y] = corners.reduce((best, at) => (at[1] - 0.5 * at[0] < best[1] - 0.5 * best[0] ? at : best))
    const { clientWidth, clientHeight } = this.view.canvas
    const within = (at: number, most: number) => Math.max(14, Math.min(most - 14, at))
    this.knob.style.transform = `translate(${within(x, clientWidth)}px, ${within(y, clientHeight)}px)`
  }

  private drag(e: PointerEvent): void {
    const { clip } = this.view
    if (!clip || e.button !== 0) return
    e.preventDefault()
    this.knob.setPointerCapture(e.pointerId)
    const size = this.view.box.getSize(new Vector3()).length()
    const middle = this.view.box.getCenter(new Vector3()).setComponent(clip.axis, clip.value)
    const [ax, ay] = this.view.project(middle)
    const [bx, by] = this.view.project(middle.clone().setComponent(clip.axis, clip.value + size))
    let way = [bx - ax, by - ay]
    if (Math.hypot(...way) < SEEN) way = [0, -this.view.height]
    const length = way[0] ** 2 + way[1] ** 2
    const begin = clip.value
    const move = (m: PointerEvent) =>
      this.move(begin + (size * ((m.clientX - e.clientX) * way[0] + (m.clientY - e.clientY) * way[1])) / length)
    this.knob.addEventListener('pointermove', move)
    const end = () => this.knob.removeEventListener('pointermove', move)
    this.knob.addEventListener('pointerup', end, { once: true })
    this.knob.addEventListener('pointercancel', end, { once: true })
  }
}
