// Arrows in the picture of the solid: a dimension, a depth or a position, dragged along its direction.

import { dimensioned } from './board_edit'
import type { Drawn, Mark, Place } from './board_paint'
import type { BoardSolid, Handle } from './board_solid'
import { AXIS_INKS } from './colour'
import { s, shown } from './dom'
import type { Facts } from './frame'

/** Picture points from the place of an arrow to its tip. */
const REACH = 30
/** An arrow whose direction is seen shorter than this share of its length is left out. */
const SEEN = 0.15
/** Part of a value by which a key changes it. */
const STEP = 0.01

/** An arrow on the screen. */
interface Shown {
  handle: Handle
  at: Place
  /** Picture points for a change of the value by 1. */
  unit: Place
}

interface Held extends Shown {
  value: number
}

export interface HandleActions {
  drawn(): Drawn
  /** The solid as it would be after a command. */
  tried(command: string): void
  /** The change of the text; null when the value is given up. */
  done(change: Facts | null): void
  say(words: string): void
  leave(): void
}

/** What a handle is called. */
function words({ kind, name, axis, p, q }: Handle): string {
  if (kind === 'next') return `${axis} ${p} → ${q}`
  return kind === 'place' ? `${axis} of ${name.split(' ').slice(0, 2).join(' ')}` : name
}

export class Handles {
  readonly element = s('g', { class: 'handles', role: 'group', 'aria-label': 'handles of the solid' })
  private all: Handle[] = []
  private shown: Shown[] = []
  private arrows = new Map<string, SVGElement>()
  private held: Held | null = null

  constructor(
    private readonly solid: BoardSolid,
    private readonly act: HandleActions,
  ) {}

  /** True while a value is tried. */
  get holding(): boolean {
    return this.held !== null
  }

  /** Draws the arrows of a body where its picture has them. */
  draw(handles: Handle[]): void {
    const { solid } = this
    this.all = handles
    this.shown = handles.flatMap((handle) => {
      const at = solid.place(handle.at)
      const far = solid.place(handle.at.map((x, k) => x + handle.along[k]) as typeof handle.at)
      const unit: Place = [far[0] - at[0], far[1] - at[1]]
      const whole = Math.hypot(...handle.along) * solid.scale
      return Math.hypot(...unit) > SEEN * whole ? [{ handle, at, unit }] : []
    })
    const kept = new Map<string, SVGElement>()
    for (const one of this.shown) {
      const { kind, name } = one.handle
      const key = `${kind} ${name}`
      const arrow = this.arrows.get(key) ?? this.made(key, one.handle)
      this.shape(arrow, one)
      kept.set(key, arrow)
    }
    for (const [key, arrow] of this.arrows) {
      if (kept.has(key)) continue
      const focused = arrow === document.activeElement
      arrow.remove()
      if (focused) this.act.leave()
    }
    for (const [key, arrow] of kept) if (!this.arrows.has(key)) this.element.append(arrow)
    this.arrows = kept
  }

  private made(key: string, handle: Handle): SVGElement {
    const arrow = s('g', {
      class: `handle ${handle.kind}`,
      tabindex: -1,
      role: 'slider',
      'data-handle': key,
      'aria-label': words(handle),
    })
    arrow.addEventListener('keydown', (e) => this.key(e as KeyboardEvent, key))
    arrow.addEventListener('blur', () => this.held && this.end(false))
    return arrow
  }

  private shape(arrow: SVGElement, { handle, at, unit }: Shown): void {
    const length = Math.hypot(...unit)
    const [x, y] = [unit[0] / length, unit[1] / length]
    const axis = handle.along.findIndex((c) => Math.abs(c) > 0.999 * Math.hypot(...handle.along))
    const ink = axis < 0 ? 'currentColor' : AXIS_INKS[axis]
    const way = (k: number): Place => [at[0] + k * x, at[1] + k * y]
    const [from, to] = [way(4), way(REACH - 6)]
    const tip = [way(REACH), way(REACH - 10)]
    const head = [tip[0], [tip[1][0] - 5 * y, tip[1][1] + 5 * x], [tip[1][0] + 5 * y, tip[1][1] - 5 * x]]
    const line = (width: number, stroke: string) =>
      s('line', { x1: from[0], y1: from[1], x2: to[0], y2: to[1], stroke, 'stroke-width': width })
    const value = this.held?.handle.name === handle.name ? this.held.value : handle.value
    arrow.setAttribute('aria-valuenow', String(value))
    arrow.setAttribute('aria-valuetext', shown(value, 4))
    const label = this.held?.handle.name === handle.name ? [`${words(handle)} = ${shown(value, 6)}`] : []
    arrow.replaceChildren(
      s('title', {}, `${words(handle)}: ${shown(value, 4)}`),
      line(14, 'transparent'),
      line(2.6, ink),
      s('polygon', { points: head.map((p) => p.join()).join(' '), fill: ink }),
      ...label.map((text) => s('text', { x: way(REACH + 10)[0], y: way(REACH + 10)[1] }, text)),
    )
  }

  /** The tip of an arrow on the paper, for tests. */
  tips(): Facts[] {
    return this.shown.map(({ handle, at, unit }) => {
      const length = Math.hypot(...unit)
      const middle = unit.map((c, k) => at[k] + (c / length) * (REACH / 2))
      return { ...handle, at: middle, unit }
    })
  }

  /** Takes hold of an arrow. */
  begin(key: string): boolean {
    const found = this.shown.find(({ handle }) => `${handle.kind} ${handle.name}` === key)
    this.held = found ? { ...found, value: found.handle.value } : null
    this.solid.frozen = this.held !== null
    return this.held !== null
  }

  /** The pointer is so many picture points from where it took hold. */
  move(by: Place): void {
    const { held } = this
    if (!held) return
    const [a, b] = held.unit
    const square = a * a + b * b
    const grain = 10 ** Math.ceil(Math.log10(0.5 / Math.hypot(a, b)) - 0.3)
    this.value(held, held.handle.value + (by[0] * a + by[1] * b) / square, grain)
  }

  private value(held: Held, wanted: number, grain: number): void {
    let value = Number((Math.round(wanted / grain) * grain).toPrecision(12))
    // A dimension keeps its sign, and a length is not zero.
    const { kind, value: before } = held.handle
    if (kind !== 'place' && value * before <= 0) value = Math.sign(before) * grain
    held.value = value
    this.draw(this.all)
    this.act.tried(this.command(held))
    this.act.say(`${words(held.handle)} = ${shown(value, 6)}`)
  }

  private command({ handle, value }: Held): string {
    if (handle.kind === 'next') return dimensioned(this.act.drawn(), handle as unknown as Mark, String(value))
    if (handle.kind === 'value') return `SET ${handle.name} ${value}`
    return `REFERENCE ${handle.point} ${this.moved(handle, value).join(' ')}`
  }

  private moved(handle: Handle, value: number): number[] {
    return handle.now!.map((x, k) => ('XYZ'[k] === handle.axis ? value : Number(x.toPrecision(12))))
  }

  /** Lets go: the value is written, or given up. */
  end(keep: boolean): void {
    const { held } = this
    this.held = null
    this.solid.frozen = false
    if (!held) return
    const { handle, value } = held
    if (!keep || value === handle.value) return this.act.done(null)
    const change = {
      next: { do: 'run', command: this.command(held) },
      value: { do: 'value', name: handle.name, value: String(value) },
      place: { do: 'place', point: handle.point, at: handle.kind === 'place' ? this.moved(handle, value) : [] },
    }
    this.act.done(change[handle.kind])
  }

  /** The next arrow has the focus. */
  walk(step: number): void {
    const all = [...this.arrows.values()]
    if (!all.length) return this.act.say('the picture has no handles')
    const now = all.indexOf(document.activeElement as unknown as SVGElement)
    const next = all[(now + step + all.length) % all.length] as unknown as HTMLElement
    next.focus({ preventScroll: true })
    this.act.say(`${next.getAttribute('aria-label')}: arrow keys change it, Enter keeps it`)
  }

  private key(e: KeyboardEvent, key: string): void {
    const up = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 }[e.key]
    if (e.ctrlKey || e.metaKey || e.altKey) return
    if (up) {
      if (!this.held && !this.begin(key)) return
      const held = this.held!
      const whole = Math.max(Math.abs(held.handle.value), this.solid.extent * STEP)
      const step = 10 ** Math.floor(Math.log10(whole * STEP * 2)) * (e.shiftKey ? 10 : 1)
      this.value(held, held.value + up * step, step)
    } else if (e.key === 'Enter') this.end(true)
    else if (e.key === 'Escape') {
      this.end(false)
      this.act.leave()
    } else if (e.key.toLowerCase() === 'g') this.walk(e.shiftKey ? -1 : 1)
    else return
    e.preventDefault()
    e.stopPropagation()
  }
}
