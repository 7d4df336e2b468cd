// Mouse, pen and fingers on the drawing board: what a press is on, and what it becomes.

import type { Board } from './board'
import type { Mark, Page, Painter, Place } from './board_paint'
import type { BoardSolid } from './board_solid'
import { Contacts } from './contacts'

/** Pixels: what a pointer reaches, and what is a click. */
export const REACH = 11
const CLICK = 5

/** Pixels: how far a stroke leaves the line between its ends to be more than that line. */
const BOW = 8

type Kind = 'draw' | 'move' | 'pan' | 'turn' | 'axis' | 'handle' | 'none'

interface Press {
  id: number
  at: Place
  from: Place
  kind: Kind
  moved: boolean
  /** The points that move, and their places on the page before. */
  points: Map<number, Place>
  axis: string
  angles: number[]
  /** Of a stroke: page coordinates, time and pressure of each sample. */
  samples: number[][]
}

/** What pointers do to the board. */
export type PointerActs = Pick<
  Board,
  | 'tool'
  | 'drawn'
  | 'chaining'
  | 'chosen'
  | 'aim'
  | 'paint'
  | 'light'
  | 'markOf'
  | 'openMark'
  | 'endChain'
  | 'point'
  | 'click'
  | 'stroke'
  | 'trace'
  | 'held'
  | 'marked'
  | 'drag'
  | 'drop'
  | 'dropped'
  | 'turnAxis'
  | 'axes'
  | 'handles'
  | 'pickFace'
>

export class BoardPointer {
  /** The line under a pointer that is not pressed. */
  hoveredLine = 0
  /** Points that were hovered, the last ones last: their extensions are snapped to. */
  woken: number[] = []
  private pressed: Press | null = null
  private readonly contacts = new Contacts()

  constructor(
    private readonly svg: SVGElement,
    private readonly page: Page,
    private readonly painter: Painter,
    private readonly solid: BoardSolid,
    private readonly board: PointerActs,
  ) {
    const on = (name: string, run: (e: any) => void) => svg.addEventListener(name, run)
    on('pointerdown', (e) => this.down(e))
    on('pointermove', (e) => this.move(e))
    on('pointerup', (e) => this.up(e))
    on('pointercancel', (e) => this.cancel(e))
    on('pointerleave', () => board.aim(null))
    on('contextmenu', (e) => e.preventDefault())
    // The gesture sets the focus, for instance into a dimension's box.
    on('mousedown', (e) => e.preventDefault())
    on('wheel', (e: WheelEvent) => {
      e.preventDefault()
      page.zoom(Math.exp(-e.deltaY * 0.0015), this.at(e))
      board.paint()
    })
  }

  /** True while points are moved. */
  get moving(): boolean {
    return this.pressed?.kind === 'move'
  }

  /** True while something else than a line is under way. */
  get taken(): boolean {
    return this.pressed !== null && this.pressed.kind !== 'draw'
  }

  /** Where the stroke that is being drawn began. */
  get begun(): Place | null {
    return this.pressed?.kind === 'draw' && this.pressed.moved ? this.page.from(this.pressed.from) : null
  }

  /** The samples of a stroke that is more than a line; empty for others. */
  get trail(): Place[] {
    const { pressed } = this
    return pressed?.kind === 'draw' && this.bows(pressed) ? pressed.samples.map(([u, v]) => [u, v]) : []
  }

  /** True for a stroke that leaves the line between its ends, or comes back to its start. */
  private bows({ samples }: Press): boolean {
    const [a, b] = [samples[0], samples[samples.length - 1]]
    const [u, v] = [b[0] - a[0], b[1] - a[1]]
    const length = Math.hypot(u, v)
    const away = ([x, y]: number[]) => {
      const [du, dv] = [x - a[0], y - a[1]]
      const along = length ? (du * u + dv * v) / length : 0
      const beyond = Math.max(0, -along, along - length)
      return Math.hypot(length ? (du * v - dv * u) / length : Math.hypot(du, dv), length ? beyond : 0)
    }
    return samples.some((sample) => away(sample) * this.page.scale > BOW)
  }

  private sampled(e: PointerEvent): number[][] {
    const all = e.getCoalescedEvents?.() ?? []
    const sample = (p: PointerEvent) => [...this.page.from(this.at(p)), p.timeStamp, p.pressure]
    return (all.length ? all : [e]).map(sample)
  }

  private at(e: { clientX: number; clientY: number }): Place {
    const box = this.svg.getBoundingClientRect()
    return [e.clientX - box.left, e.clientY - box.top]
  }

  private down(e: PointerEvent): void {
    const { board } = this
    if (board.drawn.object === null) return
    ;(this.svg as unknown as HTMLElement).focus({ preventScroll: true })
    const at = this.at(e)
    this.arrives(e)
    const use = this.contacts.down(e, at)
    if (use === 'palm') return
    if (use === 'pinch') return this.stop()
    const target = e.target as Element
    this.svg.setPointerCapture(e.pointerId)
    const press = (kind: Kind, more: Partial<Press> = {}) => {
      const points = new Map<number, Place>()
      this.pressed = {
        id: e.pointerId,
        at,
        from: at,
        kind,
        moved: false,
        points,
        axis: '',
        angles: [],
        samples: [],
        ...more,
      }
    }
    const mark = target.closest('[data-mark]')?.getAttribute('data-mark')
    const axis = target.closest('[data-axis]')?.getAttribute('data-axis')
    const handle = target.closest('[data-handle]')?.getAttribute('data-handle')
    if (e.button === 2 && board.chaining) {
      press('none')
      return board.endChain()
    }
    if (e.button !== 0 || use === 'pan') press('pan')
    else if (board.marked(at)) press('none')
    else if (handle && !this.on(at) && board.handles.begin(handle)) press('handle')
    else if (axis) press('axis', { axis, angles: [...board.drawn.angles] })
    else if (mark && !board.chaining) {
      press('none')
      board.openMark(mark)
    } else if (board.tool === 'draw') press('draw', { samples: [[...this.page.from(at), e.timeStamp, e.pressure]] })
    else {
      const hit = this.painter.hit(at, board.drawn, REACH)
      const key = hit.point ? `p${hit.point}` : hit.line ? `l${hit.line}` : ''
      if (!e.shiftKey && !board.chosen.has(key)) board.chosen.clear()
      if (key) board.chosen.add(key)
      press(key ? 'move' : this.solid.has(e) ? 'turn' : 'pan', { points: key ? board.held() : new Map() })
      board.paint()
    }
  }

  /** True on a point or a line of the drawing, which lies over the picture. */
  private on(at: Place): boolean {
    const hit = this.painter.hit(at, this.board.drawn, REACH)
    return !!(hit.point || hit.line)
  }

  /** A pen ends what fingers have begun. */
  private arrives(e: PointerEvent): void {
    if (this.contacts.arrives(e)) this.stop()
  }

  /** Gives up what is under way. */
  private stop(): void {
    const { pressed } = this
    this.pressed = null
    if (pressed?.kind === 'handle') this.board.handles.end(false)
    if (pressed) this.board.dropped(pressed.kind === 'move')
  }

  private move(e: PointerEvent): void {
    const { board } = this
    const at = this.at(e)
    this.arrives(e)
    if (this.contacts.ignored(e)) return
    const pinch = this.contacts.pinch(e, at)
    if (pinch) {
      this.page.zoom(pinch.factor, pinch.middle)
      this.page.pan(...pinch.by)
      return board.paint()
    }
    const { pressed } = this
    if (pressed) {
      if (pressed.id !== e.pointerId) return
      const [dx, dy] = [at[0] - pressed.at[0], at[1] - pressed.at[1]]
      pressed.moved ||= Math.hypot(at[0] - pressed.from[0], at[1] - pressed.from[1]) > CLICK
      pressed.at = at
      if (pressed.kind === 'draw') pressed.samples.push(...this.sampled(e))
      if (!pressed.moved) return
      if (pressed.kind === 'pan') {
        this.page.pan(dx, dy)
        return board.paint()
      }
      if (pressed.kind === 'turn') return this.solid.turn(dx, dy)
      if (pressed.kind === 'handle') return board.handles.move([at[0] - pressed.from[0], at[1] - pressed.from[1]])
      if (pressed.kind === 'move') return board.drag(this.moved(pressed))
      if (pressed.kind === 'axis') return board.turnAxis(pressed.axis, pressed.angles, at)
      if (pressed.kind === 'none') return
    } else if (e.pointerType === 'touch') return
    else this.hover(e, at)
    if (board.tool !== 'draw' || board.drawn.object === null) return
    board.point(at, pressed?.kind === 'draw' ? this.page.from(pressed.from) : null, e.shiftKey)
  }

  /** Places on the page of the points that are moved: a single point is at the pointer. */
  private moved({ points, from, at }: Press): Map<number, Place> {
    const [now, then] = [this.page.from(at), this.page.from(from)]
    const single = points.size === 1
    const by = ([u, v]: Place): Place => (single ? now : [u + now[0] - then[0], v + now[1] - then[1]])
    return new Map([...points].map(([point, place]) => [point, by(place)]))
  }

  private hover(e: PointerEvent, at: Place): void {
    const { board } = this
    const hit = this.painter.hit(at, board.drawn, REACH)
    this.hoveredLine = hit.line ?? 0
    if (hit.point && this.woken.at(-1) !== hit.point)
      this.woken = [...this.woken.filter((p) => p !== hit.point), hit.point].slice(-4)
    const name = (e.target as Element).closest('[data-mark]')?.getAttribute('data-mark')
    const lit: Mark | null = name ? board.markOf(name) : null
    board.light(lit)
    // The tool that selects turns the solid where nothing of the drawing is meant.
    const turns = board.tool === 'select' && !hit.point && !hit.line && !name && this.solid.has(e)
    this.svg.style.cursor = turns ? 'grab' : ''
    this.solid.lightFace(turns ? this.solid.faceAt(e) : -1)
  }

  private up(e: PointerEvent): void {
    this.contacts.up(e)
    const { board, pressed } = this
    if (!pressed || pressed.id !== e.pointerId) return
    this.pressed = null
    const at = this.at(e)
    if (pressed.kind === 'handle') board.handles.end(pressed.moved)
    if (pressed.kind === 'turn' && !pressed.moved) board.pickFace(this.solid.faceAt(e))
    if (pressed.kind === 'axis' && pressed.moved) board.axes(pressed.angles)
    if (pressed.kind === 'move' && pressed.moved) board.drop(this.moved({ ...pressed, at }), at)
    if (pressed.kind !== 'draw') return
    const free = e.shiftKey
    // A drawing during the gesture may scroll the page.
    if (this.bows(pressed)) void board.trace(pressed.samples)
    else if (pressed.moved) void board.stroke(this.page.from(pressed.from), this.page.from(at), free)
    else void board.click(this.page.from(at), free)
  }

  private cancel(e: PointerEvent): void {
    this.contacts.up(e)
    if (this.pressed?.id === e.pointerId) this.stop()
  }
}
