// The drawing board: a rough picture by mouse, pen, finger or keys, each gesture a command in the text.

import './board.css'
import { BoardBar } from './board_bar'
import { BoardBox } from './board_box'
import { dimensioned, duplicated, fresh, labels, named, quoted } from './board_edit'
import { Handles } from './board_handles'
import { type Aim, type Check, type Drawn, letter, type Mark, Page, Painter, type Place } from './board_paint'
import { BoardPointer, REACH } from './board_pointer'
import { type Shape, shapes } from './board_shapes'
import { BoardSolid, type PlaneFace, type SolidFacts } from './board_solid'
import { Underlay } from './board_underlay'
import { h, s } from './dom'
import type { Editor } from './editor'
import type { Facts } from './frame'
import { type Link, Newest, Refused } from './link'

/** A place on the page that is, or becomes, a point. */
interface Corner {
  at: Place
  point?: number
  line?: number
  part?: number
}

const TYPES: Record<string, string> = { x: 'X', y: 'Y', z: 'Z', h: 'XY', p: 'YZ', f: 'XZ', o: 'O' }
/** A duplicate is this far from what it was made of, in pixels. */
const DUPLICATED = 24
/** How long a hand rests before bodies and doubts are looked for, ms. */
const REST = 60
const NOTHING = {
  points: [],
  lines: [],
  marks: [],
  next: [],
  planes: [],
  axes: {},
  angles: [],
  missing: {},
  numbers: {},
  faces: 0,
  asked: null,
  section: null,
  place: null,
} as unknown as Drawn

export class Board {
  readonly element = h('div', { class: 'board', hidden: true })
  /** Times of requests, for tests: kind and milliseconds. */
  readonly times: { kind: string; ms: number }[] = []
  private readonly svg = s('svg', {
    class: 'paper',
    tabindex: 0,
    role: 'application',
    'aria-label': 'drawing board',
    'aria-describedby': 'board-help',
  })
  private readonly page = new Page()
  private readonly painter = new Painter(this.svg, this.page)
  private readonly underlay = new Underlay(this.page, {
    changed: () => (this.buttons(), this.paint()),
    say: (words) => this.say(words),
    axes: (angles) => void this.act([{ do: 'axes', axes: angles.join(' ') }]),
    drawn: () => this.drawn,
  })
  private readonly solid = new BoardSolid(
    (n) => void this.make(n),
    () => this.drawHandles(),
  )
  readonly handles = new Handles(this.solid, {
    drawn: () => this.drawn,
    tried: (command) => this.trying.push(command),
    done: (change) => void this.let(change),
    say: (words) => this.say(words),
    leave: () => this.focus(),
  })
  /** What was chosen when the buttons were built. */
  private buttoned = ''
  private readonly bar = new BoardBar(this, () => this.underlay.controls())
  private readonly pointer: BoardPointer
  private readonly line = h('input', {
    type: 'text',
    class: 'board-line',
    'aria-label': 'sketch command',
    placeholder: 'a command of the sketch language: POINT, LINE 1 2, DIM X 1 2 = 8, ARC …',
    spellcheck: 'false',
    autocomplete: 'off',
  })
  private readonly box: BoardBox
  drawn: Drawn = { ...NOTHING, object: null, objects: [], faults: [] }
  checks: Check[] = []
  proposed = new Map<number, string>()
  private object: string | null = null
  private text: string | null = null
  tool: 'draw' | 'select' = 'draw'
  private chain: Corner[] = []
  private aimed: Aim | null = null
  private lock = ''
  chosen = new Set<string>()
  private lit: Mark | null = null
  private fitted = false
  private queue: Promise<unknown> = Promise.resolve()
  private timer = 0
  last: SolidFacts | null = null
  private readonly pointing = new Newest<Facts>(async (request) => {
    const found = await this.ask('board_pointer', request)
    if (!this.pointer.taken) this.aim(found as Aim)
  })
  private readonly dragging = new Newest<Facts[]>(async (moves) => {
    const found = await this.ask('board_drag', { moves })
    if (this.pointer.moving) this.take(found as Drawn)
  })
  private readonly trying = new Newest<string>(async (trial) => {
    const { solid } = await this.ask('board_solid', { trial })
    if (this.box.mark || this.handles.holding) this.solid.show(this.drawn, solid)
  })
  private readonly resting = new Newest<void>(async () => {
    const { solid } = await this.ask('board_solid')
    this.last = solid
    this.solid.show(this.drawn, solid)
    this.buttons()
    const { checks, proposals } = await this.ask('board_check')
    this.checks = checks
    const ends = new Map<number, number>()
    for (const [, p, q] of this.drawn.lines) for (const e of [p, q]) ends.set(e, (ends.get(e) ?? 0) + 1)
    const whole = [...ends.values()].every((n) => n > 2)
    this.proposed = new Map(proposals.filter((p: any) => p.type !== 'O' || whole).map((p: any) => [p.line, p.type]))
    this.paint()
    this.buttons()
    this.bar.listIssues()
  })

  constructor(
    private readonly link: Link,
    private editor: Editor,
    private readonly say: (words: string) => void,
  ) {
    this.pointer = new BoardPointer(this.svg, this.page, this.painter, this.solid, this)
    this.box = new BoardBox(this.page, {
      commit: (mark, value) => this.dimension(mark, value),
      leave: () => this.focus(),
      next: (step) => this.openNext(step),
      closed: (tried) => (tried && this.resting.push(undefined), this.paint()),
      tried: (mark, value) => this.trying.push(dimensioned(this.drawn, mark, value)),
    })
    const help = h(
      'p',
      { class: 'sr', id: 'board-help' },
      'D draws, V selects. X Y Z H P F O set and lock a type. Tab goes to the next missing dimension. N and Shift+N go through points and lines, G and Shift+G through the handles of the solid, B and Shift+B through its plane faces; S sketches on the chosen face. Delete removes, Ctrl+D duplicates. The command line takes every sketch command.',
    )
    this.svg.append(this.underlay.handles, this.handles.element)
    this.element.append(
      this.bar.element,
      // The drawing lies over the picture of the solid: what is drawn there is seen, and is what is meant.
      h(
        'div',
        { class: 'board-stage' },
        this.underlay.element as unknown as HTMLElement,
        this.solid.element,
        this.svg as unknown as HTMLElement,
        this.bar.issues,
        this.bar.start,
        this.bar.asked,
        this.box.element,
      ),
      this.line,
      help,
    )
    this.svg.addEventListener('keydown', (e) => this.key(e as KeyboardEvent))
    this.line.addEventListener('keydown', (e) => {
      e.stopPropagation()
      if (e.key === 'Escape') this.focus()
      if (e.key !== 'Enter' || !this.line.value.trim()) return
      const command = this.line.value
      void this.act([{ do: 'run', command, last: !/^\s*(p|l|dim|d|spl|w|st|ty|al|ref|var|ax)/i.test(command) }]).then(
        (fine) => fine && (this.line.value = ''),
      )
    })
    new ResizeObserver(() => this.paint()).observe(this.svg)
  }

  // What is shown.

  /** Draws the sketch of this text from now on. */
  open(editor: Editor): void {
    if (editor === this.editor) return
    this.editor = editor
    this.object = this.text = this.last = null
    this.fitted = false
    this.endChain()
    this.refresh()
  }

  show(on: boolean): void {
    this.element.hidden = !on
    if (!on) return
    void this.underlay.load()
    this.refresh()
    this.svg.focus({ preventScroll: true })
  }

  /** The text may be another: what is drawn follows it. */
  refresh(): void {
    if (this.element.hidden || this.editor.text === this.text || this.pointer.moving) return
    void this.later(async () => {
      await this.editor.synced()
      const text = this.editor.text
      if (text === this.text) return
      const found = await this.ask('board_open')
      this.text = text
      this.chosen.clear()
      this.take(found as Drawn)
    })
  }

  async settled(): Promise<void> {
    for (let last = null; last !== this.queue; ) await (last = this.queue)
    await this.pointing.settled()
    while (this.timer) await new Promise((r) => setTimeout(r, 5))
    await this.resting.settled()
  }

  private later<T>(run: () => Promise<T>): Promise<T | undefined> {
    const done = this.queue.then(run).catch((error) => {
      if (!(error instanceof Refused && error.message === 'superseded')) this.say((error as Error).message)
      return undefined
    })
    this.queue = done
    return done
  }

  private async ask(kind: string, fields: Facts = {}): Promise<Facts> {
    const from = performance.now()
    const found = await this.link.tell({ kind, file: this.editor.file, object: this.object, ...fields })
    this.times.push({ kind, ms: performance.now() - from })
    return found
  }

  /** Changes of the sketch, as one step of the text's history. */
  act(changes: Facts[] | (() => Facts[])): Promise<boolean> {
    return this.later(async () => this.carryOut(typeof changes === 'function' ? changes() : changes)).then(
      (x) => x === true,
    )
  }

  private async carryOut(changes: Facts[]): Promise<boolean> {
    if (!changes.length) return true
    await this.editor.synced()
    this.written(await this.ask('board_edit', { changes }), named(changes))
    this.say('')
    return true
  }

  /** Takes the edits and facts of an answer, as a step of the history. */
  private written(answer: Facts, name: string): void {
    this.editor.apply(answer.edits, answer.version, name)
    this.text = this.editor.text
    // The page stays where it is under a hand.
    this.fitted = true
    this.take(answer as unknown as Drawn)
  }

  private take(drawn: Drawn): void {
    this.drawn = { ...NOTHING, ...drawn }
    this.object = drawn.object
    const lines = new Set(this.drawn.lines.map((l) => l[0]))
    this.checks = this.checks.filter((c) => c.about.lines.every((l) => lines.has(l)))
    const whole = this.whole()
    if (!this.fitted && whole.length > 2) this.fitPage(whole)
    this.fitted ||= whole.length > 0
    this.bar.starting()
    this.paint()
    this.buttons()
    if (!this.drawn.lines.length) this.last = null
    if (!this.last?.exact) this.solid.show(this.drawn, this.last)
    clearTimeout(this.timer)
    this.timer = window.setTimeout(() => {
      this.timer = 0
      this.resting.push(undefined)
    }, REST)
  }

  private measurePage(): void {
    const { width, height } = this.svg.getBoundingClientRect()
    if (width) this.page.size = [width, height]
  }

  paint(): void {
    this.measurePage()
    const buttoned = [...this.chosen].join()
    if (buttoned !== this.buttoned) this.buttons()
    this.buttoned = buttoned
    this.underlay.draw(this.tool === 'select')
    this.painter.draw(this.drawn, {
      chosen: this.chosen,
      checks: this.checks,
      proposed: this.proposed,
      open: this.box.mark?.name ?? '',
      planes: this.lit ?? this.box.mark,
      outlines: this.last?.outlines ?? [],
    })
    this.aim(this.aimed)
    this.box.place()
  }

  aim(aim: Aim | null): void {
    this.aimed = aim
    const start = this.chain.at(-1)?.at ?? this.pointer.begun
    this.painter.aim(this.tool === 'draw' ? aim : null, start, this.drawn.section, this.lock, this.pointer.trail)
  }

  private buttons(): void {
    this.bar.buttons()
  }

  /** Keys go to the drawing. */
  focus(): void {
    this.svg.focus({ preventScroll: true })
  }

  fit(): void {
    this.fitPage(this.whole())
    this.paint()
  }

  /** All that the page has: points, and the border of the face below. */
  private whole(): Place[] {
    return [...this.drawn.points.map((p): Place => [p[1], p[2]]), ...(this.drawn.place?.border.flat() ?? [])]
  }

  private fitPage(places: Place[]): void {
    this.measurePage()
    this.page.fit(places, this.solid.element.clientWidth)
  }

  use(tool: 'draw' | 'select'): void {
    this.tool = tool
    this.endChain()
    this.svg.dataset.tool = tool
    this.drawHandles()
    this.buttons()
    this.paint()
    this.focus()
  }

  choose(name: string): void {
    this.object = name
    this.text = null
    this.fitted = false
    this.refresh()
  }

  choosePart(c: Check): void {
    this.chosen = new Set([...c.about.lines.map((l) => `l${l}`), ...c.about.points.map((p) => `p${p}`)])
    this.paint()
  }

  // Pointers.

  /** True while a chain is drawn. */
  get chaining(): boolean {
    return this.chain.length > 0
  }

  /** A dimension under the pointer: its planes are lit. */
  light(mark: Mark | null): void {
    if (mark === this.lit) return
    this.lit = mark
    this.paint()
  }

  /** Where the next corner would be, of a chain or of a stroke that began somewhere. */
  point(at: Place, begun: Place | null, free: boolean): void {
    this.pointing.push({
      at: this.page.from(at),
      reach: REACH / this.page.scale,
      start: this.chain.at(-1)?.at ?? begun,
      free,
      woken: this.pointer.woken,
    })
  }

  /** The points of the choice, ends of lines with them, and where they are. */
  held(): Map<number, Place> {
    const lines = new Set(labels(this.chosen, 'l'))
    const ends = this.drawn.lines.filter((l) => lines.has(l[0])).flatMap((l) => [l[1], l[2]])
    const all = new Set([...labels(this.chosen, 'p'), ...ends])
    return new Map(this.drawn.points.filter((p) => all.has(p[0])).map((p) => [p[0], [p[1], p[2]]]))
  }

  private moves(places: Map<number, Place>): Facts[] {
    return [...places].map(([point, at]) => ({ point, at: this.rounded(at) }))
  }

  /** Points under a pointer that moves them. */
  drag(places: Map<number, Place>): void {
    this.dragging.push(this.moves(places))
  }

  /** A gesture that was given up; points that were moved are where they were. */
  dropped(moving: boolean): void {
    if (moving) this.text = null
    this.refresh()
  }

  /** A click along an axis of the picture underneath; true when these are being set. */
  marked(at: Place): boolean {
    return this.underlay.click(this.page.from(at))
  }

  axes(angles: number[]): void {
    void this.act([{ do: 'axes', axes: angles.map((a) => String(Math.round(a))).join(' ') }])
  }

  /** A place to what a pixel is worth. */
  private rounded([u, v]: Place): Place {
    const grain = 10 ** Math.ceil(Math.log10(0.5 / this.page.scale) - 0.3)
    return [Math.round(u / grain) * grain, Math.round(v / grain) * grain].map((x) => Number(x.toPrecision(12))) as Place
  }

  private async corner(at: Place, start: Place | null, free: boolean): Promise<Corner> {
    const found = (await this.ask('board_place', {
      at,
      reach: REACH / this.page.scale,
      start,
      free,
      woken: this.pointer.woken,
    })) as Aim
    if (found.why === 'point') return { at: found.at, point: found.point }
    if (found.why === 'line' || found.why === 'mid') return { at: found.at, line: found.line, part: found.part }
    return { at: found.why ? (found.at.map((x) => Math.round(x * 1000) / 1000) as Place) : this.rounded(found.at) }
  }

  /** A corner of a chain. */
  click(at: Place, free: boolean): Promise<unknown> {
    return this.later(async () => {
      const last = this.chain.at(-1)
      const next = await this.corner(at, last?.at ?? null, free)
      if (!last) this.chain = [next]
      else if (next.point !== undefined && next.point === last.point) return this.endChain()
      else {
        const closes = next.point !== undefined && this.chain.some((c) => c.point === next.point)
        await this.draw(last, next)
        if (closes) this.endChain()
        else this.chain.push(next)
      }
      this.aim(this.aimed)
    })
  }

  /** A line by pressing at its start and letting go at its end. */
  stroke(from: Place, to: Place, free: boolean): Promise<unknown> {
    return this.later(async () => {
      const start = await this.corner(from, null, free)
      const end = await this.corner(to, start.at, free)
      await this.draw(start, end)
      this.endChain()
    })
  }

  /** A stroke with corners or bends: lines, arcs and closed curves as its samples show. */
  trace(samples: number[][]): Promise<unknown> {
    return this.later(async () => {
      this.endChain()
      await this.editor.synced()
      const answer = await this.ask('board_stroke', { samples })
      if (answer.edits) this.written(answer, 'Stroke')
      this.say(answer.remarks.join(' '))
    })
  }

  /** Writes a line, its new points before it; the corners then know their labels. */
  private async draw(a: Corner, b: Corner): Promise<void> {
    let free = 1 + Math.max(0, ...this.drawn.points.map((p) => p[0]))
    const commands: string[] = []
    const made = [a, b].filter((c) => c.point === undefined)
    for (const c of made) {
      c.point = free++
      commands.push(
        c.line === undefined
          ? `POINT ${c.point} AT ${c.at[0]} ${c.at[1]}`
          : `SPLIT ${c.line} ${Number(c.part!.toFixed(4))}`,
      )
    }
    if (a.point === b.point) return
    const there = this.drawn.lines.some(
      ([, p, q]) => (p === a.point && q === b.point) || (p === b.point && q === a.point),
    )
    const splits = commands.filter((c) => c.startsWith('SPLIT')).length
    const label = 1 + splits + Math.max(0, ...this.drawn.lines.map((l) => l[0]))
    if (!there)
      commands.push(
        `LINE ${label} FROM ${a.point} TO ${b.point}${this.lock ? ` TYPE ${letter(this.lock, this.drawn.section)}` : ''}`,
      )
    this.lock = ''
    try {
      if (commands.length) await this.carryOut([{ do: 'run', command: commands.join('; '), drawn: true }])
    } catch (error) {
      for (const c of made) c.point = undefined
      throw error
    }
  }

  endChain(): void {
    this.chain = []
    this.lock = ''
    this.aim(this.aimed)
  }

  /** Points that were moved; a single one that is let go on another becomes one with it. */
  drop(places: Map<number, Place>, at: Place): void {
    const [point] = places.keys()
    const near =
      places.size === 1 &&
      [...this.painter.places].find(([id, p]) => id !== point && Math.hypot(p[0] - at[0], p[1] - at[1]) <= REACH)?.[0]
    const moves = this.moves(places).map((m) => ({ do: 'move', ...m }))
    void this.later(async () => {
      await this.dragging.settled()
      try {
        await this.carryOut(near ? [{ do: 'run', command: `WELD ${near} ${point}` }] : moves)
        this.say(near ? `points ${near} and ${point} are one` : '')
      } catch (error) {
        this.text = null
        this.refresh()
        throw error
      }
    })
  }

  turnAxis(axis: string, angles: number[], at: Place): void {
    const [ox, oy] = (this.svg.querySelector<SVGElement>('.triad')!.dataset.origin ?? '0,0').split(',').map(Number)
    const angle = Math.round((Math.atan2(oy - at[1], at[0] - ox) * 180) / Math.PI + 360) % 360
    angles[Object.keys(this.drawn.axes).indexOf(axis)] = angle
    const r = (angle * Math.PI) / 180
    this.drawn = { ...this.drawn, axes: { ...this.drawn.axes, [axis]: [Math.cos(r), Math.sin(r)] } }
    this.paint()
    this.say(`${axis.toLowerCase()} axis at ${angle}°`)
  }

  // Dimensions.

  markOf(name: string): Mark | null {
    return [...this.drawn.next, ...this.drawn.marks].find((m) => m.name === name) ?? null
  }

  openMark(name: string): void {
    const mark = this.markOf(name)
    if (mark) this.box.open(mark, this.drawn.next.includes(mark))
    this.paint()
  }

  /** The missing dimension after the open one, or the first; false when none is missing. */
  private openNext(step: number): boolean {
    const { next } = this.drawn
    if (!next.length) {
      this.box.close()
      this.focus()
      return false
    }
    const now = next.findIndex((m) => m.name === this.box.mark?.name)
    this.openMark(next[(now + step + next.length) % next.length].name)
    return true
  }

  private dimension(mark: Mark, value: string): void {
    const missing = mark.p !== undefined
    const change = missing
      ? { do: 'run', command: dimensioned(this.drawn, mark, value) }
      : { do: 'value', name: mark.name, value }
    void this.act([change]).then((fine) => {
      // Meanwhile it may have been closed.
      if (this.box.mark !== mark) return
      if (!fine) return this.box.refuse()
      if (missing) {
        this.box.close()
        this.openNext(1)
      } else {
        this.box.close()
        this.focus()
      }
    })
  }

  /** A dimension between two chosen points, along the axis on which they differ most. */
  private between(digit: string): boolean {
    const [p, q] = [...this.chosen].filter((c) => c[0] === 'p').map((c) => Number(c.slice(1)))
    if (!p || !q) return false
    const apart = Object.keys(this.drawn.axes).filter(
      (axis) => !this.drawn.planes.some(([a, members]) => a === axis && members.includes(p) && members.includes(q)),
    )
    const at = (id: number) => this.drawn.points.find((x) => x[0] === id)
    const far = (axis: string) => {
      const k = 'XYZ'.indexOf(axis)
      return (at(q)?.[3]?.[k] ?? 0) - (at(p)?.[3]?.[k] ?? 0)
    }
    apart.sort((a, b) => Math.abs(far(b)) - Math.abs(far(a)))
    if (!apart.length) {
      this.say('these points are in one plane on every axis')
      return true
    }
    const [a, b] = [p, q].map((id) => at(id)!.slice(1, 3) as Place)
    const ends = far(apart[0]) < 0 ? [q, p] : [p, q]
    this.box.open(
      {
        name: '',
        text: '',
        value: Math.abs(far(apart[0])),
        reference: false,
        axis: apart[0],
        at: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2],
        line: [a, b],
        witnesses: [],
        p: ends[0],
        q: ends[1],
      },
      true,
      digit,
      apart,
    )
    this.paint()
    return true
  }

  // Types, solids.

  toConfirm(): number[] {
    const doubted = this.checks
      .filter((c) => /doubtful|oblique|untyped/.test(c.about.kind))
      .flatMap((c) => c.about.lines)
    return [...new Set(doubted)].filter((id) => this.drawn.lines.some((l) => l[0] === id && l[4] !== 'user'))
  }

  confirmNext(): void {
    const all = this.toConfirm()
    const now = all.findIndex((id) => this.chosen.has(`l${id}`))
    if (!all.length) return
    const id = all[(now + 1) % all.length]
    this.chosen = new Set([`l${id}`])
    this.paint()
    this.say(`line ${id}: X Y Z H P F O set its type and lock it`)
    this.focus()
  }

  async acceptProposed(): Promise<void> {
    const found = [...this.proposed].map(([id, type]) => ({
      do: 'type',
      lines: [id],
      type: letter(type, this.drawn.section),
    }))
    this.proposed.clear()
    await this.act(found)
  }

  /** Makes the body; of several that fit, the one with a number. */
  async make(chosen = 0): Promise<void> {
    const commands = [...(chosen && this.last?.made ? [] : ['GENERATE FACES']), ...(chosen ? [`CHOOSE ${chosen}`] : [])]
    if (await this.act(commands.map((command) => ({ do: 'run', command, last: true }))))
      this.say('The body is in the model, exact.')
  }

  // The solid by hand.

  private drawHandles(): void {
    this.handles.draw(this.tool === 'select' ? (this.last?.handles ?? []) : [])
  }

  /** A handle was let go: its value is written, as one step, or given up. */
  private async let(change: Facts | null): Promise<void> {
    const fine = change && (await this.act([change]))
    if (!fine) this.resting.push(undefined)
  }

  /** The face of the body that is chosen. */
  get face(): PlaneFace | null {
    return this.solid.face
  }

  pickFace(face: number): void {
    this.solid.pick(face)
    this.faceNamed()
  }

  private faceNamed(): void {
    const { face } = this
    this.say(face ? `face ${face.name}: S sketches on it` : 'no plane face is chosen')
    this.buttons()
  }

  /** A section on the chosen face. */
  async sketchOnFace(): Promise<void> {
    const { face } = this
    const { object } = this.drawn
    if (!face || !object) return this.faceNamed()
    const name = fresh(this.drawn, 'FACE')
    const scale = 10 ** Math.round(Math.log10(200 / Math.max(1e-12, this.solid.size)))
    const angles = { XY: '0 90 225', XZ: '0 45 90', YZ: '225 0 90' }[face.plane]
    const command = [
      `SKETCH ${name} 2D ${face.plane} ON ${quoted(object)} ${face.name}`,
      ...(scale === 1 ? [] : [`AXES ${angles} SCALE${` ${scale}`.repeat(3)}`]),
    ].join('\n')
    if (!(await this.act([{ do: 'run', command, last: 'end' }]))) return
    this.solid.pick(-1)
    this.choose(name)
    this.use('draw')
    this.say(`${name} on face ${face.name} of ${object}: draw its outline; E raises it, K sinks it`)
  }

  /** Asks for the number of a shape, and makes it. */
  askShape(shape: Shape): void {
    const mark: Mark = {
      name: shape.words,
      text: shape.asks,
      value: null,
      reference: false,
      axis: null,
      at: this.page.from([this.page.size[0] / 2 - 60, 40]),
      line: null,
      witnesses: [],
    }
    this.box.open(
      mark,
      true,
      '',
      [],
      (value) =>
        void this.act([{ do: 'run', command: shape.command(value), last: shape.last }]).then((fine) =>
          fine ? (this.box.close(), this.made(shape.shows?.(value)), this.focus()) : this.box.refuse(),
        ),
    )
  }

  /** What was made is shown: an object of its own, or the one that is drawn. */
  private made(object?: string): void {
    if (object) this.choose(object)
    else this.fit()
  }

  // Keys.

  private key(e: KeyboardEvent): void {
    const key = e.key.toLowerCase()
    const done = () => {
      e.preventDefault()
      e.stopPropagation()
    }
    if (e.ctrlKey || e.metaKey) {
      if (key === 'd') {
        this.duplicate()
        return done()
      }
      if (key !== 'z' && key !== 'y') return
      done()
      this.endChain()
      void this.later(async () => {
        this.editor.steps.go(key === 'y' || e.shiftKey ? -1 : 1)
        this.refresh()
      })
      return
    }
    if (e.altKey || /^F\d/.test(e.key)) return
    const lines = labels(this.chosen, 'l')
    if (this.underlay.choose(key.toUpperCase())) return done()
    if (key in TYPES) {
      const type = TYPES[key]
      const own = this.drawn.section && type.length > 1 ? 'F' : letter(type, null)
      if (this.chain.length) {
        this.lock = this.lock === type ? '' : type
        this.aim(this.aimed)
      } else if (lines.length || this.pointer.hoveredLine) {
        const which = lines.length ? lines : [this.pointer.hoveredLine]
        void this.act(which.map((line) => ({ do: 'type', lines: [line], type: own })))
      } else this.say('a type needs a line: point at one, or choose it')
      return done()
    }
    if (/^[\d.]$/.test(e.key) && this.between(e.key)) return done()
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key]
    if (step) this.nudge(step.map((x) => (x * (e.shiftKey ? 10 : 1)) / this.page.scale) as Place)
    else if (key === 'escape') {
      if (this.chain.length) this.endChain()
      else if (this.underlay.end()) this.say('')
      else this.chosen.clear()
      this.paint()
    } else if (key === 'tab') {
      if (e.shiftKey || !this.openNext(1)) return
    } else if (key === 'd') this.use('draw')
    else if (key === 'v') this.use('select')
    else if (key === 'c') this.confirmNext()
    else if (key === 't') void this.acceptProposed()
    else if (key === 'n') this.walk(e.shiftKey ? -1 : 1)
    else if (key === 'g') this.grasp(e.shiftKey ? -1 : 1)
    else if (key === 's') void this.sketchOnFace()
    else if (key === 'b') {
      this.solid.walk(e.shiftKey ? -1 : 1)
      this.faceNamed()
    } else if (shapes(this.drawn, this.chosen).some((one) => one.key === key))
      this.askShape(shapes(this.drawn, this.chosen).find((one) => one.key === key)!)
    else if (key === '0') this.fit()
    else if (key === 'delete' || key === 'backspace') this.remove()
    else if (key === 'enter') {
      if (this.chain.length) this.endChain()
      else if (this.drawn.asked) void this.act([{ do: 'run', command: 'ACCEPT', last: true }])
      else if (!this.drawn.next.length && !this.drawn.section && !this.drawn.faces && this.last?.exact) void this.make()
    } else if (e.key.length > 1) return
    done()
  }

  /** The next handle of the solid has the keys. */
  private grasp(step: number): void {
    if (this.tool !== 'select') this.use('select')
    this.drawHandles()
    this.handles.walk(step)
  }

  /** The next point or line, named for who does not see it. */
  private walk(step: number): void {
    const all = [...this.drawn.points.map((p) => `p${p[0]}`), ...this.drawn.lines.map((l) => `l${l[0]}`)]
    if (!all.length) return
    const now = all.findIndex((k) => this.chosen.has(k))
    const key = all[(now + step + all.length) % all.length]
    this.chosen = new Set([key])
    this.paint()
    const part = this.svg.querySelector(`[data-${key[0] === 'p' ? 'point' : 'line'}="${key.slice(1)}"]`)
    this.say(part?.getAttribute('aria-label') ?? '')
  }

  private nudge([du, dv]: Place): void {
    const points = labels(this.chosen, 'p')
    if (!points.length) {
      this.page.pan(-du * 30 * this.page.scale, dv * 30 * this.page.scale)
      return this.paint()
    }
    void this.act(() =>
      points.map((point) => {
        const [, u, v] = this.drawn.points.find((p) => p[0] === point)!
        return { do: 'move', point, at: [u + du, v + dv] }
      }),
    )
  }

  private duplicate(): void {
    const by = DUPLICATED / this.page.scale
    const { commands, chosen } = duplicated(this.drawn, this.chosen, [by, -by])
    if (!commands.length) return this.say('choose lines or points to duplicate')
    void this.act([{ do: 'run', command: commands.join('; ') }]).then((fine) => {
      if (!fine) return
      this.chosen = new Set(chosen)
      this.paint()
    })
  }

  private remove(): void {
    const [points, lines] = [labels(this.chosen, 'p'), labels(this.chosen, 'l')]
    this.chosen.clear()
    const commands = [
      lines.length && `DELETE LINE ${lines.join(' ')}`,
      points.length && `DELETE POINT ${points.join(' ')}`,
    ].filter(Boolean)
    if (commands.length) void this.act([{ do: 'run', command: commands.join('; ') }])
  }

  /** For tests: where a place of the page, a point or a mark is on the screen, and what is drawn. */
  look(): Facts {
    const box = this.svg.getBoundingClientRect()
    return {
      drawn: this.drawn,
      checks: this.checks,
      proposed: [...this.proposed],
      solid: this.last,
      origin: [box.left, box.top],
      size: [box.width, box.height],
      open: this.box.mark,
      chain: this.chain.length,
      handles: this.handles.tips(),
      face: this.face,
    }
  }

  onScreen(at: Place): Place {
    const box = this.svg.getBoundingClientRect()
    const [x, y] = this.page.to(at)
    return [box.left + x, box.top + y]
  }
}
