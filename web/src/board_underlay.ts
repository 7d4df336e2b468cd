// A picture underneath the drawing, to trace over: the browser keeps it by model, and it is no part of the sketch.

import type { Drawn, Page, Place } from './board_paint'
import { h, s } from './dom'
import { keep, kept } from './kept'
import { model } from './state'

/** Fraction of the paper that a picture takes at first. */
const FILL = 0.8
/** Least length of a pair of clicks, least side of a picture, and half of a handle, in pixels. */
const [APART, LEAST, HANDLE] = [12, 24, 6]
const OPACITY = 0.45

/** Where a picture is: its middle and size in units of the page, turned counterclockwise by degrees. */
export interface Placed {
  middle: Place
  size: Place
  angle: number
}

interface Kept extends Placed {
  data: string
  opacity: number
}

const add = (a: Place, b: Place, k = 1): Place => [a[0] + k * b[0], a[1] + k * b[1]]
const turned = ([u, v]: Place, degrees: number): Place => {
  const r = (degrees * Math.PI) / 180
  return [u * Math.cos(r) - v * Math.sin(r), u * Math.sin(r) + v * Math.cos(r)]
}

/** The corners of a picture, counterclockwise from the lower left one. */
export const corners = ({ middle, size: [w, t], angle }: Placed): Place[] =>
  (
    [
      [-w / 2, -t / 2],
      [w / 2, -t / 2],
      [w / 2, t / 2],
      [-w / 2, t / 2],
    ] as Place[]
  ).map((c) => add(middle, turned(c, angle)))

/** A picture whose corner is dragged: the opposite one stays, and so do the proportions. */
export function scaled(placed: Placed, corner: number, to: Place, least: number): Placed {
  const all = corners(placed)
  const fixed = all[(corner + 2) % 4]
  const way = add(all[corner], fixed, -1)
  const by = add(to, fixed, -1)
  const least2 = least / Math.min(...placed.size)
  const factor = Math.max(least2, (by[0] * way[0] + by[1] * way[1]) / (way[0] ** 2 + way[1] ** 2))
  return {
    ...placed,
    middle: add(fixed, way, factor / 2),
    size: [placed.size[0] * factor, placed.size[1] * factor],
  }
}

/** Degrees of a line on the page, from 0 to 360, to a tenth. */
export function slope([a, b]: Place[]): number {
  const degrees = (Math.atan2(b[1] - a[1], b[0] - a[0]) * 180) / Math.PI
  return (Math.round(degrees * 10) / 10 + 360) % 360
}

/** The turn that brings lines of a picture along their axes: degrees from the one to the other, the mean of all. */
export function turn(drawn: number[], wanted: number[]): number {
  const by = drawn.map((d, k) => ((((wanted[k] - d + 180) % 360) + 360) % 360) - 180)
  // Around the first, so that 179 and -179 have 180 between them.
  const near = by.map((x) => by[0] + (((((x - by[0] + 180) % 360) + 360) % 360) - 180))
  return near.reduce((sum, x) => sum + x, 0) / near.length
}

export interface UnderlayActs {
  changed(): void
  say(words: string): void
  /** The angles of all axes, in the order of the drawing's. */
  axes(angles: number[]): void
  drawn(): Drawn
}

export class Underlay {
  private readonly image = s('image', { class: 'underlay', opacity: OPACITY })
  /** Below all that is drawn. */
  readonly element = s('svg', { class: 'paper-under', 'aria-hidden': 'true' }, this.image)
  /** Over all that is drawn: handles, and the lines along the axes. */
  readonly handles = s('g', { class: 'underlay-handles' })
  private readonly grips = ['left lower', 'right lower', 'right upper', 'left upper', 'move'].map((words, k) =>
    s('rect', {
      class: 'underlay-handle',
      width: 2 * HANDLE,
      height: 2 * HANDLE,
      'data-underlay': words,
      role: 'button',
      tabindex: 0,
      'aria-label': k < 4 ? `scale the picture by its ${words} corner` : 'move the picture',
    }),
  )
  private readonly frame = s('polygon', { class: 'underlay-frame' })
  private readonly lines = s('g', { class: 'underlay-axes' })
  private picture: Kept | null = null
  /** Clicks along axes, while these are set. */
  private clicks: { axis: string; at: Place }[] | null = null
  private axis = ''
  private loaded = false
  /** Whether the handles are shown. */
  private handled = false

  constructor(
    private readonly page: Page,
    private readonly act: UnderlayActs,
  ) {
    this.handles.append(this.frame, ...this.grips, this.lines)
    this.grips.forEach((grip, k) => this.gripped(grip, k))
  }

  private get key(): string {
    return `board.picture.${model.name}`
  }

  /** What the browser has kept for the model. */
  async load(): Promise<void> {
    if (this.loaded) return
    this.loaded = true
    const found = await kept<Kept>(this.key)
    if (found && !this.picture) this.show(found)
  }

  private show(picture: Kept | null): void {
    this.picture = picture
    this.clicks = null
    if (picture) {
      this.image.setAttribute('href', picture.data)
      this.image.setAttribute('opacity', String(picture.opacity))
    } else this.image.removeAttribute('href')
    this.act.changed()
  }

  private keep(): void {
    void keep(this.key, this.picture ?? undefined)
  }

  /** Lays a picture into the middle of the visible part of the page. */
  async lay(file: File): Promise<void> {
    const picture = await createImageBitmap(file).catch(() => {
      throw new Error(`${file.name} is no picture that a browser reads: expected PNG, JPEG, WebP or SVG`)
    })
    const { width, height } = picture
    picture.close()
    const data = await new Promise<string>((resolve, reject) => {
      const reader = new FileReader()
      reader.onload = () => resolve(String(reader.result))
      reader.onerror = () => reject(new Error(`${file.name} cannot be read`))
      reader.readAsDataURL(file)
    })
    const { page } = this
    const scale = (FILL * Math.min(page.size[0] / width, page.size[1] / height)) / page.scale
    const middle = page.from([page.size[0] / 2, page.size[1] / 2])
    this.show({ data, opacity: OPACITY, middle, size: [width * scale, height * scale], angle: 0 })
    this.keep()
  }

  // The hand.

  private gripped(grip: SVGElement, k: number): void {
    let from: { id: number; at: Place; picture: Kept } | null = null
    const at = (e: PointerEvent): Place => {
      const box = this.handles.ownerSVGElement!.getBoundingClientRect()
      return this.page.from([e.clientX - box.left, e.clientY - box.top])
    }
    const on = (name: string, run: (e: PointerEvent) => void) =>
      grip.addEventListener(name, (e) => {
        e.stopPropagation()
        run(e as PointerEvent)
      })
    on('pointerdown', (e) => {
      if (!this.picture || e.button !== 0) return
      grip.setPointerCapture(e.pointerId)
      from = { id: e.pointerId, at: at(e), picture: this.picture }
    })
    on('pointermove', (e) => {
      if (!from || from.id !== e.pointerId) return
      this.pull(from.picture, k, add(at(e), from.at, -1))
    })
    on('pointerup', (e) => {
      if (from?.id !== e.pointerId) return
      from = null
      this.keep()
    })
    grip.addEventListener('keydown', (event) => {
      const e = event as KeyboardEvent
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key]
      if (!step || !this.picture) return
      e.preventDefault()
      e.stopPropagation()
      this.pull(this.picture, k, step.map((x) => (x * (e.shiftKey ? 10 : 1)) / this.page.scale) as Place)
      this.keep()
    })
    on('pointercancel', (e) => {
      if (from?.id !== e.pointerId) return
      this.picture = from.picture
      from = null
      this.draw()
    })
  }

  /** A corner of a picture, or all of it, is elsewhere. */
  private pull(picture: Kept, k: number, by: Place): void {
    const to = (corner: number) => add(corners(picture)[corner], by)
    const placed = k === 4 ? { middle: add(picture.middle, by) } : scaled(picture, k, to(k), LEAST / this.page.scale)
    this.picture = { ...picture, ...placed }
    this.draw()
  }

  // Axes by four clicks.

  /** The axes that the drawing has, by letters. */
  private get letters(): string[] {
    return Object.keys(this.act.drawn().axes)
  }

  private begin(): void {
    this.clicks = []
    this.axis = this.letters[0]
    this.ask()
    this.act.changed()
  }

  private ask(): void {
    const others = this.letters.filter((l) => l !== this.axis).join(' or ')
    const which =
      (this.clicks!.length % 2 ? 'the second end of that line, at the greater ' : 'a line along ') +
      this.axis.toLowerCase()
    this.act.say(
      `Click ${which}${this.clicks!.length % 2 ? '' : `, lower end first; ${others} for another axis, Esc to end`}`,
    )
  }

  /** The letter of an axis, for the next line; true when axes are being set. */
  choose(letter: string): boolean {
    if (!this.clicks || !this.letters.includes(letter)) return false
    if (this.clicks.length % 2 || this.clicks.some((c) => c.axis === letter)) return true
    this.axis = letter
    this.ask()
    return true
  }

  /** A click on the page; true when axes are being set. */
  click(at: Place): boolean {
    const { clicks } = this
    if (!clicks) return false
    const last = clicks.at(-1)
    if (clicks.length % 2 && last && Math.hypot(at[0] - last.at[0], at[1] - last.at[1]) * this.page.scale < APART)
      this.act.say(`A line along ${this.axis.toLowerCase()} needs ends at least ${APART} pixels apart`)
    else {
      clicks.push({ axis: this.axis, at })
      if (clicks.length === 4) this.finish(clicks)
      else {
        this.axis = clicks.length % 2 ? this.axis : this.letters.find((l) => !clicks.some((c) => c.axis === l))!
        this.ask()
      }
    }
    this.draw()
    return true
  }

  private finish(clicks: { axis: string; at: Place }[]): void {
    const { axes, angles, section } = this.act.drawn()
    const pairs = [clicks.slice(0, 2), clicks.slice(2)]
    const found = pairs.map((pair) => slope(pair.map((c) => c.at)))
    this.end()
    const wanted = pairs.map(([c]) => (Math.atan2(axes[c.axis][1], axes[c.axis][0]) * 180) / Math.PI)
    if (section && this.picture) {
      // The axes of a section are those of the page: the picture is turned to them.
      const by = turn(found, wanted)
      const about = clicks[0].at
      this.picture = {
        ...this.picture,
        middle: add(about, turned(add(this.picture.middle, about, -1), by)),
        angle: this.picture.angle + by,
      }
      this.keep()
      const apart = Math.abs(turn([found[1]], [wanted[1]]) - turn([found[0]], [wanted[0]]))
      this.act.say(
        `The picture is turned by ${by.toFixed(1)}°${apart > 0.5 ? `: its axes are ${apart.toFixed(1)}° off a right angle` : ''}`,
      )
      return
    }
    const all = Object.keys(axes).map((letter, k) => {
      const pair = pairs.findIndex(([c]) => c.axis === letter)
      return pair < 0 ? angles[k] : found[pair]
    })
    this.act.axes(all)
  }

  /** Ends the setting of axes; true when it was under way. */
  end(): boolean {
    const was = this.clicks !== null
    this.clicks = null
    if (was) this.act.changed()
    return was
  }

  // What is shown.

  /** Follows the page; the handles are those of the tool that selects. */
  draw(handled = this.handled): void {
    const { picture, page } = this
    this.handled = handled
    this.image.style.display = picture ? '' : 'none'
    const shown = picture !== null && handled && this.clicks === null
    for (const part of [this.frame, ...this.grips]) part.style.display = shown ? '' : 'none'
    const marked = (this.clicks ?? []).map((c) => page.to(c.at))
    this.lines.replaceChildren(
      ...marked.map(([cx, cy]) => s('circle', { cx, cy, r: 4 })),
      ...[0, 2].flatMap((k) =>
        marked[k + 1]
          ? [s('line', { x1: marked[k][0], y1: marked[k][1], x2: marked[k + 1][0], y2: marked[k + 1][1] })]
          : [],
      ),
    )
    if (!picture) return
    const [x, y] = page.to(picture.middle)
    const [width, height] = picture.size.map((v) => v * page.scale)
    const place = { x: x - width / 2, y: y - height / 2, width, height }
    for (const [name, value] of Object.entries(place)) this.image.setAttribute(name, String(value))
    this.image.setAttribute('transform', `rotate(${-picture.angle} ${x} ${y})`)
    const at = corners(picture).map((c) => page.to(c))
    this.frame.setAttribute('points', at.map((c) => c.join()).join(' '))
    const top: Place = [(at[2][0] + at[3][0]) / 2, (at[2][1] + at[3][1]) / 2]
    ;[...at, top].forEach(([u, v], k) => {
      this.grips[k].setAttribute('x', String(u - HANDLE))
      this.grips[k].setAttribute('y', String(v - HANDLE))
    })
  }

  /** The button that chooses a picture; its strength, its axes, and its removal. */
  controls(): HTMLElement[] {
    const file = h('input', { type: 'file', accept: 'image/*', 'aria-label': 'picture underneath', hidden: true })
    file.addEventListener('change', () => {
      const [chosen] = file.files ?? []
      if (chosen) void this.lay(chosen).catch((error) => this.act.say((error as Error).message))
    })
    const button = h('button', { title: 'A picture to trace over', onclick: () => file.click() }, 'Picture…')
    const { picture } = this
    if (!picture) return [button, file]
    const strength = h('input', {
      type: 'range',
      min: 0.1,
      max: 1,
      step: 0.05,
      'aria-label': 'strength of the picture',
    })
    strength.value = String(picture.opacity)
    strength.addEventListener('input', () => {
      picture.opacity = strength.valueAsNumber
      if (this.picture) this.picture.opacity = strength.valueAsNumber
      this.image.setAttribute('opacity', strength.value)
    })
    strength.addEventListener('change', () => this.keep())
    const axes = h(
      'button',
      {
        title: 'Two lines of the picture, each by two clicks, along two of its axes',
        'aria-pressed': this.clicks !== null,
        onclick: () => (this.clicks ? this.end() : this.begin()),
      },
      'Axes of the picture',
    )
    const away = h(
      'button',
      { class: 'icon', 'aria-label': 'remove the picture', onclick: () => (this.show(null), this.keep()) },
      '×',
    )
    return [button, file, strength, axes, away]
  }
}
