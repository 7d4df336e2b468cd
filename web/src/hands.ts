// Hands on the picture: orbit, pan, zoom, pick, measure, drag.

import { Vector3 } from 'three'
import { ink } from './colour'
import { h, shown } from './dom'
import { Gumball } from './gumball'
import { type Link, Newest, Refused } from './link'
import type { Preview } from './preview'
import type { BesideFact, EditFact, FaultFact, HandleFact } from './protocol'
import { model, on } from './state'
import { typed } from './typed'
import type { Drawn, View } from './view'

/** What the engine wrote after a change by hand. */
export interface Written {
  version?: number
  edits?: EditFact[]
  /** Parameters whose values the model's own text does not state as numbers. */
  kept?: string[]
  /** Where texts beside it state those. */
  beside?: BesideFact[]
}

export interface Handlers {
  select(name: string): void
  hover(name: string): void
  say(words: string): void
  written(head: Written, name: string): Promise<void>
  synced(): Promise<void>
  status(words: string): void
  open(name: string): void
  /** A place that was clicked where nothing is dragged; true when it was wanted. */
  place(at: Vector3, grain: number): Promise<boolean>
  /** True for a click on a control in the corner of the picture. */
  corner(e: MouseEvent): boolean
}

interface Drag {
  item: Drawn
  start: Vector3
  target: Vector3
  handles: HandleFact[]
  own: string[]
  /** The numbers that follow now. */
  names: string[]
  /** What the person chose for what the object's own numbers cannot follow. */
  chosen: string[]
  axis: number | null
  plane: number | null
  /** True while the place is to be on the surface under the pointer. */
  onSurface: boolean
  moved: boolean
  ready: boolean
  /** Settles when the engine has said what moves the place; false when nothing does. */
  begun: Promise<boolean>
  /** True when the pointer has been followed since the drag was ready. */
  aimed: boolean
  /** True when it is over and counts. */
  committed: boolean
  /** True for a drag by the keys of the keyboard. */
  keys: boolean
  last: [number, number]
  /** The errors of the model before it. */
  faults: Set<string>
  /** What it has told of itself. */
  said: string
  /** From the place to the pointer, where a handle beside the place is held. */
  offset: [number, number]
}

const AXES = ['x', 'y', 'z']
const STEPS: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
}
/** Picture points behind the pointer that need a reason. */
const BEHIND = 2
const unit = (k: number) => new Vector3().setComponent(k, 1)

export class Hands {
  measuring = false
  private places: Vector3[] = []
  private under: [number, number] | null = null
  private drag: Drag | null = null
  /** The last drag that counted, until the next one. */
  private latest: Drag | null = null
  /** Settles when the engine has heard the end of the last drag. */
  private ended: Promise<void> = Promise.resolve()
  private readonly pointers = new Map<number, [number, number]>()
  private pressed: { x: number; y: number; button: number; shift: boolean; moved: boolean } | null = null
  private readonly requests: Newest<() => Promise<unknown>>
  private readonly gumball: Gumball
  private readonly tip = h('div', { class: 'tip', hidden: true })
  private readonly chooser = h('div', { class: 'chooser', role: 'group', 'aria-label': 'what to move', hidden: true })
  private readonly entry = h('input', { class: 'entry number', type: 'text', 'aria-label': 'value', hidden: true })

  constructor(
    private readonly view: View,
    private readonly link: Link,
    private readonly preview: Preview,
    host: HTMLElement,
    private readonly act: Handlers,
  ) {
    this.gumball = new Gumball(
      view,
      () => this.held(),
      (e, axis, plane) => this.grip(e, axis, plane),
    )
    host.append(this.gumball.element, this.tip, this.chooser, this.entry)
    this.requests = new Newest((run) => run())
    this.chooser.addEventListener('keydown', (e) => {
      // Enter and Space are the button's own; the rest is the drag's.
      if (e.key === 'Tab' || e.key === 'Enter' || e.key === ' ') return
      view.canvas.focus({ preventScroll: true })
      this.key(e)
    })
    const c = view.canvas
    on(['faults'], () => {
      const drag = this.drag ?? this.latest
      if (drag?.said && (this.drag || this.broken(drag).length)) this.failing(drag)
    })
    c.addEventListener('pointerdown', (e) => this.down(e))
    c.addEventListener('pointermove', (e) => this.move(e))
    c.addEventListener('pointerup', (e) => this.up(e))
    c.addEventListener('pointercancel', () => this.cancel())
    c.addEventListener('pointerleave', () => act.hover(''))
    c.addEventListener('contextmenu', (e) => e.preventDefault())
    c.addEventListener('wheel', (e) => this.wheel(e), { passive: false })
    c.addEventListener('dblclick', (e) => {
      const hit = view.pick(...this.at(e))
      if (hit) act.open(hit.object)
      else view.fit()
    })
    c.addEventListener('keydown', (e) => this.key(e))
    this.entry.addEventListener('keydown', (e) => void this.entered(e))
    this.entry.addEventListener('blur', () => {
      if (!this.entry.hidden && this.drag) void this.finish(this.drag.moved)
    })
  }

  private at(e: MouseEvent): [number, number] {
    const box = this.view.canvas.getBoundingClientRect()
    return [e.clientX - box.left, e.clientY - box.top]
  }

  /** Settles when the engine has heard the end of every drag. */
  async settled(): Promise<void> {
    await this.ended
    await this.requests.settled()
  }

  get busy(): boolean {
    return this.drag !== null
  }

  private down(e: PointerEvent): void {
    this.view.canvas.focus({ preventScroll: true })
    this.view.canvas.setPointerCapture(e.pointerId)
    const [x, y] = this.at(e)
    if (this.drag?.keys) void this.finish(this.drag.moved)
    if (!this.pointers.size && !this.drag) this.view.enter(x, y)
    this.pointers.set(e.pointerId, [x, y])
    this.pressed = { x, y, button: e.button, shift: e.shiftKey, moved: false }
    if (e.button !== 0 || e.shiftKey || this.measuring || this.pointers.size > 1 || this.link.still) return
    const item = this.view.near(x, y, e.pointerType === 'touch' ? 18 : 10)
    if (item) this.grab(item, x, y)
  }

  /** The selected point, which has handles: none in a picture that cannot be changed. */
  private point(object: string): Drawn | undefined {
    return [...this.view.items.values()].find((i) => i.object === object && i.kind === 'point' && this.view.seen(i))
  }

  private held(): Vector3 | null {
    if (this.link.still || this.measuring) return null
    const item = this.point(this.view.selected)
    return item ? this.view.place(item) : null
  }

  /** After each frame. */
  drawn(): void {
    this.gumball.draw()
  }

  private grip(e: PointerEvent, axis: number | null, plane: number | null): void {
    const item = this.point(this.view.selected)
    if (!item || this.drag) return
    this.view.canvas.focus({ preventScroll: true })
    this.view.canvas.setPointerCapture(e.pointerId)
    const [x, y] = this.at(e)
    const [px, py] = this.view.project(this.view.place(item))
    this.pointers.set(e.pointerId, [x, y])
    this.pressed = { x, y, button: 0, shift: false, moved: false }
    this.grab(item, x, y)
    Object.assign(this.drag!, { axis, plane, offset: [x - px, y - py] })
  }

  private grab(item: Drawn, x: number, y: number, keys = false): void {
    this.act.select(item.object)
    const start = this.view.place(item)
    const drag: Drag = {
      item,
      start,
      target: start.clone(),
      handles: [],
      own: [],
      names: [],
      chosen: [],
      axis: null,
      plane: null,
      onSurface: false,
      moved: false,
      ready: false,
      begun: Promise.resolve(false),
      aimed: false,
      committed: false,
      faults: new Set(model.faults.filter((f) => f.severity === 'error').map((f) => f.message)),
      said: '',
      keys,
      last: [x, y],
      offset: [0, 0],
    }
    this.drag = drag
    this.latest = null
    drag.begun = this.begin(drag)
  }

  private async begin(drag: Drag): Promise<boolean> {
    const { object } = drag.item
    try {
      await this.ended
      await this.act.synced()
      const { head } = await this.link.ask('drag_begin', { object })
      Object.assign(drag, { handles: head.handles, own: head.own, ready: true })
      const said = drag.own.length ? `${object}: ${drag.own.join(', ')}` : `${object} follows from an expression`
      if (this.drag === drag) {
        this.act.status(
          `${said} · ${drag.keys ? 'arrows move it, Enter ends, ' : ''}X Y Z lock an axis, S keeps it on the surface below, digits enter a value, Tab chooses what follows, Esc takes it back`,
        )
        if (drag.moved) this.aim(drag, false)
      }
      return true
    } catch (error) {
      if (this.drag === drag) this.drag = null
      if (error instanceof Refused) this.act.status(error.message)
      return false
    }
  }

  /** A drag of the selected point by keys: arrows instead of the pointer. */
  take(object: string): void {
    const item = this.point(object)
    if (!item)
      return this.act.status(object ? `${object} is no point that can be moved: select one` : 'Select a point first')
    if (this.drag || this.link.still) return
    this.view.canvas.focus({ preventScroll: true })
    this.grab(item, ...this.view.project(this.view.place(item)), true)
  }

  /** Chips of the numbers that may follow besides the object's own; those that do are pressed, and share the motion. */
  private offer(drag: Drag): void {
    const others = drag.handles.filter((k) => !k.own)
    const follow = drag.chosen.length ? drag.chosen : drag.names.filter((n) => !drag.own.includes(n))
    this.chooser.hidden = !others.length || !follow.length
    if (this.chooser.hidden) return
    const [x, y] = this.view.project(this.view.place(drag.item))
    const choose = (names: string[]) => {
      drag.chosen = names
      this.offer(drag)
      this.aim(drag, false)
    }
    const chip = (label: string, names: string[]) => {
      const on = names.every((n) => follow.includes(n))
      return h(
        'button',
        {
          class: `chip ${on ? 'on' : ''}`,
          'aria-pressed': on,
          'data-names': names.join(),
          onpointerdown: (e: Event) => e.stopPropagation(),
          onclick: () => choose(on ? follow.filter((n) => !names.includes(n)) : [...new Set([...follow, ...names])]),
        },
        label,
      )
    }
    const reach = (k: HandleFact) =>
      Math.hypot(...k.direction) * (k.range ? k.range[1] - k.range[0] : Math.abs(k.value))
    const listed = [...others]
      .sort((a, b) => Number(follow.includes(b.name)) - Number(follow.includes(a.name)) || reach(b) - reach(a))
      .slice(0, 6)
    const params = others.filter((k) => k.parameter).map((k) => k.name)
    const focus = this.chooser.querySelector<HTMLElement>(':focus')?.dataset.names
    this.chooser.replaceChildren(
      h('span', { class: 'quiet' }, 'follows by'),
      ...listed.map((k) =>
        chip(k.parameter ? k.name : `${shown(k.value)} of ${k.name.replace(/#\d+$/, '')}`, [k.name]),
      ),
      ...(params.length > 1 ? [chip('all parameters', params)] : []),
    )
    if (focus) this.chooser.querySelector<HTMLElement>(`[data-names="${CSS.escape(focus)}"]`)?.focus()
    this.chooser.style.left = `${x + 16}px`
    this.chooser.style.top = `${y + 16}px`
  }

  private move(e: PointerEvent): void {
    const [x, y] = this.at(e)
    const before = this.pointers.get(e.pointerId)
    if (!this.pressed || !before) {
      if (e.pointerType === 'mouse') this.hovering(x, y)
      return
    }
    const [dx, dy] = [x - before[0], y - before[1]]
    if (this.pointers.size === 2) {
      this.pinch(e.pointerId, before, [x, y])
      return
    }
    this.pointers.set(e.pointerId, [x, y])
    if (!this.pressed.moved && Math.hypot(x - this.pressed.x, y - this.pressed.y) < 4) return
    this.pressed.moved = true
    if (this.drag) {
      // While a number is typed the pointer does not speak.
      if (!this.entry.hidden) return
      this.drag.moved = true
      this.drag.last = [x, y]
      this.aim(this.drag, e.altKey)
      return
    }
    const { camera } = this.view
    if (this.pressed.button === 0 && !this.pressed.shift) camera.orbit(dx * 0.4, dy * 0.4)
    else camera.pan(dx, dy, this.view.height)
    this.view.draw()
  }

  private pinch(id: number, before: [number, number], now: [number, number]): void {
    const other = [...this.pointers].find(([k]) => k !== id)?.[1]
    if (!other) return
    const from = Math.hypot(before[0] - other[0], before[1] - other[1])
    const to = Math.hypot(now[0] - other[0], now[1] - other[1])
    const [cx, cy] = this.view.middle
    const middle = [(now[0] + other[0]) / 2 - cx, (now[1] + other[1]) / 2 - cy]
    this.view.camera.zoom(from / Math.max(1, to), middle[0], middle[1], this.view.height)
    this.view.camera.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2, this.view.height)
    this.pointers.set(id, now)
    this.view.draw()
  }

  /** What is under the pointer is looked for once a frame. */
  private hovering(x: number, y: number): void {
    const waits = this.under !== null
    this.under = [x, y]
    if (waits) return
    requestAnimationFrame(() => {
      const [px, py] = this.under ?? [x, y]
      this.under = null
      if (!this.pressed) this.hover(px, py)
    })
  }

  private hover(x: number, y: number): void {
    if (!this.drag) this.view.enter(x, y)
    const point = this.view.near(x, y, 10)
    this.view.canvas.style.cursor = point ? 'grab' : this.measuring ? 'crosshair' : ''
    const hit = point ? { object: point.object, point: this.view.place(point), value: undefined } : this.view.pick(x, y)
    this.act.hover(hit?.object ?? '')
    if (!hit) {
      this.tip.hidden = true
      return
    }
    const value = hit.value ? ` · ${shown(hit.value.length === 1 ? hit.value[0] : hit.value, 4)}` : ''
    this.tip.textContent = `${hit.object}${value}`
    this.tip.hidden = false
    this.tip.style.left = `${x + 14}px`
    this.tip.style.top = `${y + 14}px`
  }

  /** From the pointer to a place, and from that to numbers. */
  private aim(drag: Drag, free: boolean): void {
    if (!drag.ready) return
    drag.aimed = true
    this.view.ghost(true)
    const { camera } = this.view
    const [x, y] = [drag.last[0] - drag.offset[0], drag.last[1] - drag.offset[1]]
    const { ray } = this.view.ray(x, y)
    // Across the line of sight, which in perspective is not that of the picture's middle: how far away the place is does
    // not count.
    const sideways = camera.right.addScaledVector(ray.direction, -ray.direction.dot(camera.right)).normalize()
    let basis = [sideways, sideways.clone().cross(ray.direction)]
    let snapped = ''
    if (drag.onSurface) {
      // At the silhouette the last place stays: never on to what is behind.
      const hit = this.view.surfaceAt(x, y, drag.item.object)
      if (hit) drag.target.copy(hit.point)
      basis = [unit(0), unit(1), unit(2)]
      snapped = hit ? hit.object : 'the surface left behind'
    } else if (drag.axis !== null) {
      // The point of the axis that is nearest to the ray.
      const a = unit(drag.axis)
      const [w, b] = [drag.start.clone().sub(ray.origin), ray.direction.dot(a)]
      if (1 - b * b > 1e-3)
        drag.target.copy(drag.start).addScaledVector(a, (b * ray.direction.dot(w) - a.dot(w)) / (1 - b * b))
      basis = [a]
    } else {
      const n = drag.plane !== null ? unit(drag.plane) : camera.towards
      const slope = n.dot(ray.direction)
      if (Math.abs(slope) > 0.05)
        drag.target.copy(ray.origin).addScaledVector(ray.direction, n.dot(drag.start.clone().sub(ray.origin)) / slope)
      if (drag.plane !== null) basis = [0, 1, 2].filter((k) => k !== drag.plane).map(unit)
      const near = free ? null : this.view.near(x, y, 8, drag.item.object)
      if (near) {
        drag.target.copy(this.view.place(near))
        basis = [unit(0), unit(1), unit(2)]
        snapped = near.object
      }
    }
    // The move before the lock is undone: the place itself is on the axis or in the plane.
    if (drag.axis !== null || drag.plane !== null) basis = [unit(0), unit(1), unit(2)]
    const target = drag.target.clone()
    const grain = camera.grain(this.view.height)
    this.requests.push(async () => {
      try {
        const { head } = await this.preview.ask('drag_to', {
          target: target.toArray(),
          basis: basis.map((b) => b.toArray()),
          names: drag.chosen,
          grain,
        })
        // A drag that is over already: where it came to is stated all the same, until the next one.
        if (this.drag !== drag && (this.drag || !drag.committed)) return
        const values = head.values as Record<string, number>
        drag.names = Object.keys(values)
        if (this.drag === drag) {
          this.offer(drag)
          this.label(drag, head.reached)
        }
        const words = Object.entries(values).map(([n, v]) => `${n} = ${shown(v)}`)
        const lock =
          drag.axis !== null
            ? ` · along ${AXES[drag.axis]}`
            : drag.plane !== null
              ? ` · in ${AXES.filter((_, k) => k !== drag.plane).join('')}`
              : ''
        // Where it stays behind the pointer, the reason: an end of a range, or no number for the rest of the way.
        const short = Number(head.left) / grain
        const ended = (head.ended as string[]).map((n) => `${n} is at the end of its range, ${shown(values[n])}`)
        const why = !(short > BEHIND)
          ? ''
          : ` · stays ${Math.round(short)} px behind: ${ended.length ? ended.join(', ') : `${drag.names.join(', ')} ${drag.names.length > 1 ? 'move' : 'moves'} it no further that way`}`
        drag.said = words.join('   ') + lock + (snapped ? ` · on ${snapped}` : '') + why
        this.failing(drag)
      } catch (error) {
        if (error instanceof Refused && error.message !== 'superseded') {
          drag.said = `${error.message}. Turn the view, or lock another axis`
          this.failing(drag)
        }
      }
    })
  }

  private broken(drag: Drag): FaultFact[] {
    return model.faults.filter((f) => f.severity === 'error' && !drag.faults.has(f.message))
  }

  /** What fails since the drag began, beside what it says of itself. */
  private failing(drag: Drag): void {
    const broken = this.broken(drag)
    const names = [...new Set(broken.map((f) => f.object).filter(Boolean))]
    const few = names.slice(0, 3).join(', ') + (names.length > 3 ? ', …' : '')
    const fails = broken.length
      ? ` · ${few || 'the model'} ${names.length > 1 ? 'fail' : 'fails'}: ${broken[0].message}`
      : ''
    this.act.status(drag.said + fails)
  }

  /** How far the place has moved, beside it, and the line from where it was. */
  private label(drag: Drag, reached: number[]): void {
    const now = new Vector3().fromArray(reached)
    const by = now.clone().sub(drag.start)
    this.view.overlay('moved', [[...drag.start.toArray(), ...reached]], ink('chosen'))
    const parts = AXES.map((a, k) =>
      by.getComponent(k)
        ? `${a} ${shown(now.getComponent(k), 5)} (${by.getComponent(k) > 0 ? '+' : ''}${shown(by.getComponent(k), 3)})`
        : '',
    ).filter(Boolean)
    this.tip.textContent = `${parts.join('   ')} ${model.unit}`
    this.tip.hidden = !parts.length
    const [x, y] = this.view.project(now)
    this.tip.style.left = `${x + 14}px`
    this.tip.style.top = `${y - 34}px`
  }

  private up(e: PointerEvent): void {
    this.pointers.delete(e.pointerId)
    const pressed = this.pressed
    if (this.pointers.size === 0) this.pressed = null
    if (this.drag) {
      // A number that is being typed ends the drag by itself.
      if (this.entry.hidden && !this.drag.keys) void this.finish(this.drag.moved)
      return
    }
    if (!pressed || pressed.moved || pressed.button !== 0) return
    if (this.act.corner(e)) return
    const [x, y] = this.at(e)
    const hit = this.view.pick(x, y)
    if (this.measuring) return this.measure(hit?.point ?? null)
    const at = hit?.point ?? this.view.placeAt(x, y)
    void this.act.place(at, this.view.camera.grain(this.view.height)).then((taken) => {
      if (!taken) this.act.select(hit?.object ?? '')
    })
  }

  /** Ends the drag; what the hand does from now on is another one. */
  private finish(commit: boolean): Promise<void> {
    const drag = this.drag
    if (!drag) return this.ended
    this.drag = null
    drag.committed = commit
    this.latest = commit ? drag : null
    this.chooser.hidden = this.entry.hidden = this.tip.hidden = true
    this.view.overlay('moved', null)
    this.view.ghost(false)
    if (!commit) this.act.status('')
    this.ended = this.end(drag, commit)
    return this.ended
  }

  private async end(drag: Drag, commit: boolean): Promise<void> {
    if (!(await drag.begun)) return
    // A flick that was over before the engine was ready counts as well.
    if (commit && drag.moved && !drag.aimed) this.aim(drag, false)
    await this.requests.settled()
    try {
      const { head } = await this.link.ask('drag_end', { commit })
      if (commit) await this.act.written(head, `Drag ${drag.item.object}`)
    } catch (error) {
      this.act.status((error as Error).message)
    }
  }

  cancel(): void {
    this.pointers.clear()
    this.pressed = null
    if (this.drag) void this.finish(false)
  }

  private wheel(e: WheelEvent): void {
    e.preventDefault()
    const [x, y] = this.at(e)
    if (!this.pressed && !this.drag) this.view.enter(x, y)
    const [cx, cy] = this.view.middle
    const lines = e.deltaMode === 1 ? 16 : 1
    const fine =
      e.deltaMode === 0 && Math.abs(e.deltaY) < 60 && !e.ctrlKey && (e.deltaX !== 0 || !Number.isInteger(e.deltaY))
    if (fine) this.view.camera.pan(-e.deltaX, -e.deltaY, this.view.height)
    else
      this.view.camera.zoom(Math.exp(e.deltaY * lines * (e.ctrlKey ? 0.01 : 0.0015)), x - cx, y - cy, this.view.height)
    this.view.draw()
  }

  private key(e: KeyboardEvent): void {
    const { camera } = this.view
    const drag = this.drag
    if (drag) {
      const axis = AXES.indexOf(e.key.toLowerCase())
      const step = STEPS[e.key]
      if (step && drag.keys)
        drag.last = [drag.last[0] + step[0] * (e.shiftKey ? 10 : 1), drag.last[1] + step[1] * (e.shiftKey ? 10 : 1)]
      else if (e.key.toLowerCase() === 's') drag.onSurface = !drag.onSurface
      else if (axis >= 0 && !e.shiftKey) [drag.axis, drag.plane] = [drag.axis === axis ? null : axis, null]
      else if (axis >= 0) [drag.axis, drag.plane] = [null, drag.plane === axis ? null : axis]
      else if (e.key === 'Enter' && drag.keys) void this.finish(drag.moved)
      else if (e.key === 'Escape') this.cancel()
      else if (e.key === 'Tab' && !this.chooser.hidden) {
        e.preventDefault()
        return this.chooser.querySelector('button')?.focus()
      } else if (/^[\d=.-]$/.test(e.key)) return this.enter(drag, e)
      else return
      e.preventDefault()
      e.stopPropagation()
      if (this.drag !== drag) return
      drag.moved = true
      // Points are not snapped to by keys: a step is a step.
      this.aim(drag, e.altKey || drag.keys)
      return
    }
    const turn: Record<string, [number, number]> = {
      ArrowLeft: [-15, 0],
      ArrowRight: [15, 0],
      ArrowUp: [0, -15],
      ArrowDown: [0, 15],
    }
    if (e.key in turn && !e.altKey && !e.metaKey) {
      const [dx, dy] = turn[e.key]
      if (e.ctrlKey || e.shiftKey) camera.pan(-dx * 3, -dy * 3, this.view.height)
      else camera.orbit(dx, dy)
    } else if (e.key === '+' || e.key === '=') camera.zoom(0.85, 0, 0, this.view.height)
    else if (e.key === '-') camera.zoom(1 / 0.85, 0, 0, this.view.height)
    else return
    e.preventDefault()
    this.view.draw()
  }

  /** A number typed while dragging. */
  private enter(drag: Drag, e: KeyboardEvent): void {
    e.preventDefault()
    e.stopPropagation()
    const names = drag.names.length
      ? drag.names
      : drag.own.length
        ? drag.own
        : drag.handles.slice(0, 1).map((k) => k.name)
    const name = names.find((n) => drag.axis !== null && n.endsWith(`.${AXES[drag.axis]}`)) ?? names[0]
    if (!name) return
    this.entry.hidden = false
    this.entry.dataset.names = names.join('\n')
    this.entry.dataset.name = name
    this.entry.placeholder = name
    this.entry.value = e.key === '=' ? '' : e.key
    this.entry.style.left = `${drag.last[0] + 12}px`
    this.entry.style.top = `${drag.last[1] - 36}px`
    this.entry.focus()
  }

  private async entered(e: KeyboardEvent): Promise<void> {
    e.stopPropagation()
    if (e.key === 'Escape') {
      this.cancel()
      return this.view.canvas.focus()
    }
    if (e.key !== 'Enter' && e.key !== 'Tab') return
    e.preventDefault()
    const { name, names } = this.entry.dataset
    const text = this.entry.value
    if (!name || text.trim() === '') return
    let x: number
    try {
      x = await typed(text, this.link)
    } catch (error) {
      return this.act.status((error as Error).message)
    }
    if (this.drag) this.drag.moved = this.drag.aimed = true
    // The number comes after what the pointer and an axis have asked for, and replaces neither.
    const set = async () => {
      await this.requests.settled()
      this.requests.push(() =>
        this.link.ask('set', { values: { [name]: x } }).catch((error) => this.act.status(error.message)),
      )
    }
    if (e.key === 'Tab') {
      const all = (names ?? '').split('\n')
      this.entry.dataset.name = this.entry.placeholder = all[(all.indexOf(name) + 1) % all.length]
      this.entry.value = ''
      void set()
    } else {
      await set()
      void this.finish(true)
      this.view.canvas.focus()
    }
  }

  /** Two places have a distance, a third one makes an angle at the second. */
  private measure(p: Vector3 | null): void {
    if (!p) return
    this.places = [...(this.places.length < 3 ? this.places : []), p.clone()]
    const [a, b, c] = this.places
    const coordinates = (q: Vector3) =>
      `(${q
        .toArray()
        .map((x) => shown(x))
        .join(', ')})`
    this.view.overlay('measure', b ? [this.places.flatMap((q) => q.toArray())] : null, ink('chosen'))
    if (!b) return this.act.status(`from ${coordinates(a)}: click a second point`)
    const d = b.clone().sub(a)
    const distance = `distance ${shown(d.length())} ${model.unit}   Δx ${shown(d.x)}   Δy ${shown(d.y)}   Δz ${shown(d.z)}`
    if (!c) return this.act.status(`${distance} · a third point measures the angle`)
    const angle = (a.clone().sub(b).angleTo(c.clone().sub(b)) * 180) / Math.PI
    this.act.status(
      `angle ${shown(angle)}° at ${coordinates(b)}   ${distance}   then ${shown(c.distanceTo(b))} ${model.unit}`,
    )
  }
}
