// The drawing board: a rough picture by mouse, pen, finger or keys, each gesture a command in the text.

import './board.css'
import { BoardBox } from './board_box'
import { dimensioned, duplicated, labels } from './board_edit'
import { type Aim, type Check, type Drawn, letter, type Mark, Page, Painter } from './board_paint'
import { type Shape, shapes } from './board_shapes'
import { BoardSolid, type SolidFacts } from './board_solid'
import { Underlay } from './board_underlay'
import { h, s } from './dom'
import type { Editor } from './editor'
import type { Facts } from './frame'
import { type Link, Newest, Refused } from './link'

type Place = [number, number]
/** A place on the page that is, or becomes, a point. */
interface Corner {
  at: Place
  point?: number
  line?: number
  part?: number
}

const TYPES: Record<string, string> = { x: 'X', y: 'Y', z: 'Z', h: 'XY', p: 'YZ', f: 'XZ', o: 'O' }
const PRESETS: [string, string][] = [
  ['345 40 90', 'Trimetric 345 40 90'],
  ['ISO', 'Isometric'],
  ['CAVALIER', 'Cavalier'],
  ['CABINET', 'Cabinet'],
  ['MILITARY', 'Military'],
  ['DIN', 'Dimetric 42/7'],
  ['AUTO', 'As the lines show'],
]
/** Pixels: what a pointer reaches, what is a click, and how long a touch is no palm after a pen, ms. */
const [REACH, CLICK, PALM] = [11, 5, 500]
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
  section: null,
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
  private readonly underlay = new Underlay(this.page, () => (this.buttons(), this.paint()))
  private readonly solid = new BoardSolid((n) => void this.make(n))
  /** What was chosen when the buttons were built. */
  private buttoned = ''
  private readonly bar = h('div', { class: 'board-bar', role: 'toolbar', 'aria-label': 'drawing' })
  private readonly issues = h('div', { class: 'board-issues', role: 'log', 'aria-label': 'doubts and contradictions' })
  private readonly line = h('input', {
    type: 'text',
    class: 'board-line',
    'aria-label': 'sketch command',
    placeholder: 'a command of the sketch language: POINT, LINE 1 2, DIM X 1 2 = 8, ARC …',
    spellcheck: 'false',
    autocomplete: 'off',
  })
  private readonly start = h('div', { class: 'board-start' })
  private readonly box: BoardBox
  private drawn: Drawn = { ...NOTHING, object: null, objects: [], faults: [] }
  private checks: Check[] = []
  private proposed = new Map<number, string>()
  private object: string | null = null
  private text: string | null = null
  private tool: 'draw' | 'select' = 'draw'
  private chain: Corner[] = []
  private aimed: Aim | null = null
  private lock = ''
  private woken: number[] = []
  private chosen = new Set<string>()
  private lit: Mark | null = null
  private hoveredLine = 0
  private pressed: {
    id: number
    at: Place
    from: Place
    kind: 'draw' | 'move' | 'pan' | 'axis' | 'none'
    moved: boolean
    what?: number
    axis?: string
    angles?: number[]
  } | null = null
  private touches = new Map<number, Place>()
  private pen = 0
  private fitted = false
  private queue: Promise<unknown> = Promise.resolve()
  private timer = 0
  private last: SolidFacts | null = null
  private readonly pointing = new Newest<Facts>(async (request) => {
    const found = await this.ask('board_pointer', request)
    if (!this.pressed || this.pressed.kind === 'draw') this.aim(found as Aim)
  })
  private readonly dragging = new Newest<{ point: number; at: Place }>(async (move) => {
    const found = await this.ask('board_drag', { move })
    if (this.pressed?.kind === 'move') this.take(found as Drawn)
  })
  private readonly trying = new Newest<string>(async (trial) => {
    const { solid } = await this.ask('board_solid', { trial })
    if (this.box.mark) this.solid.show(this.drawn, solid)
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
    this.listIssues()
  })

  constructor(
    private readonly link: Link,
    private readonly editor: Editor,
    private readonly say: (words: string) => void,
  ) {
    this.svg.prepend(this.underlay.image)
    this.box = new BoardBox(this.page, {
      commit: (mark, value) => this.dimension(mark, value),
      leave: () => this.svg.focus(),
      next: (step) => this.openNext(step),
      closed: (tried) => (tried && this.resting.push(undefined), this.paint()),
      tried: (mark, value) => this.trying.push(dimensioned(this.drawn, mark, value)),
    })
    const help = h(
      'p',
      { class: 'sr', id: 'board-help' },
      'D draws, V selects. X Y Z H P F O set and lock a type. Tab goes to the next missing dimension. N and Shift+N go through points and lines. Delete removes, Ctrl+D duplicates. The command line takes every sketch command.',
    )
    this.element.append(
      this.bar,
      h(
        'div',
        { class: 'board-stage' },
        this.svg as unknown as HTMLElement,
        this.solid.element,
        this.issues,
        this.start,
        this.box.element,
      ),
      this.line,
      help,
    )
    const on = (name: string, run: (e: any) => void) => this.svg.addEventListener(name, run)
    on('pointerdown', (e) => this.down(e))
    on('pointermove', (e) => this.move(e))
    on('pointerup', (e) => this.up(e))
    on('pointercancel', (e) => this.cancel(e))
    on('pointerleave', () => this.aim(null))
    on('contextmenu', (e) => e.preventDefault())
    // The gesture sets the focus, for instance into a dimension's box.
    on('mousedown', (e) => e.preventDefault())
    on('wheel', (e: WheelEvent) => {
      e.preventDefault()
      this.page.zoom(Math.exp(-e.deltaY * 0.0015), this.at(e))
      this.paint()
    })
    on('keydown', (e) => this.key(e))
    this.line.addEventListener('keydown', (e) => {
      e.stopPropagation()
      if (e.key === 'Escape') this.svg.focus()
      if (e.key !== 'Enter' || !this.line.value.trim()) return
      const command = this.line.value
      void this.act([{ do: 'run', command, last: !/^\s*(p|l|dim|d|spl|w|st|ty|al|ref|var|ax)/i.test(command) }]).then(
        (fine) => fine && (this.line.value = ''),
      )
    })
    new ResizeObserver(() => this.paint()).observe(this.svg)
  }

  // What is shown.

  show(on: boolean): void {
    this.element.hidden = !on
    if (!on) return
    this.refresh()
    this.svg.focus({ preventScroll: true })
  }

  /** The text may be another: what is drawn follows it. */
  refresh(): void {
    if (this.element.hidden || this.editor.text === this.text || this.pressed?.kind === 'move') return
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
    await this.queue
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
    const found = await this.link.tell({ kind, object: this.object, ...fields })
    this.times.push({ kind, ms: performance.now() - from })
    return found
  }

  /** Changes of the sketch, as one step of the text's history. */
  private act(changes: Facts[] | (() => Facts[])): Promise<boolean> {
    return this.later(async () => this.carryOut(typeof changes === 'function' ? changes() : changes)).then(
      (x) => x === true,
    )
  }

  private async carryOut(changes: Facts[]): Promise<boolean> {
    if (!changes.length) return true
    await this.editor.synced()
    const answer = await this.ask('board_edit', { changes })
    this.editor.apply(answer.edits, answer.version)
    this.text = this.editor.text
    this.say('')
    // The page stays where it is under a hand.
    this.fitted = true
    this.take(answer as unknown as Drawn)
    return true
  }

  private take(drawn: Drawn): void {
    this.drawn = { ...NOTHING, ...drawn }
    this.object = drawn.object
    const lines = new Set(this.drawn.lines.map((l) => l[0]))
    this.checks = this.checks.filter((c) => c.about.lines.every((l) => lines.has(l)))
    if (!this.fitted && this.drawn.points.length > 2) {
      this.measurePage()
      this.page.fit(
        this.drawn.points.map((p) => [p[1], p[2]]),
        this.solid.element.clientWidth,
      )
    }
    this.fitted ||= this.drawn.points.length > 0
    this.starting()
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

  private paint(): void {
    this.measurePage()
    const buttoned = [...this.chosen].join()
    if (buttoned !== this.buttoned) this.buttons()
    this.buttoned = buttoned
    this.underlay.draw()
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

  private aim(aim: Aim | null): void {
    this.aimed = aim
    const start =
      this.chain.at(-1)?.at ??
      (this.pressed?.kind === 'draw' && this.pressed.moved ? this.page.from(this.pressed.from) : null)
    this.painter.aim(this.tool === 'draw' ? aim : null, start, this.drawn.section, this.lock)
  }

  /** What an empty text begins with. */
  private starting(): void {
    this.start.hidden = this.drawn.object !== null
    if (this.start.hidden || this.start.childElementCount) return
    const begin = (words: string, command: string) =>
      h(
        'button',
        { onclick: () => void this.act([{ do: 'run', command, last: true }]).then(() => this.svg.focus()) },
        words,
      )
    this.start.append(
      h('h3', {}, 'A new drawing'),
      h('p', { class: 'quiet' }, 'Only the directions of lines count; dimensions come after.'),
      begin('Pictorial: a solid with its depth', `SKETCH PART\nAXES ${PRESETS[0][0]}`),
      ...['XZ', 'XY', 'YZ'].map((plane) => begin(`Cross section in ${plane.toLowerCase()}`, `SKETCH PART 2D ${plane}`)),
    )
  }

  private buttons(): void {
    const d = this.drawn
    const button = (words: string, key: string, run: () => void, more: Facts = {}) =>
      h(
        'button',
        { title: key ? `${words} (${key})` : words, onclick: run, ...more },
        words,
        key ? h('kbd', {}, key) : '',
      )
    const select = (name: string, options: [string, string][], value: string, run: (v: string) => void) => {
      const made = h(
        'select',
        { 'aria-label': name, title: name },
        ...options.map(([v, words]) => h('option', { value: v, selected: v === value }, words)),
      )
      made.addEventListener('change', () => run(made.value))
      return made
    }
    const planes: Record<string, number> = {}
    for (const [axis] of d.planes) planes[axis] = (planes[axis] ?? 0) + 1
    const progress = Object.entries(d.missing)
      .filter(([axis]) => axis in d.axes)
      .map(([axis, open]) => {
        const all = Math.max(0, (planes[axis] ?? 1) - 1)
        return h('span', { class: `count type-${axis} ${open ? '' : 'done'}` }, `${axis} ${all - open}/${all}`)
      })
    const confirm = this.toConfirm()
    const complete = d.lines.length > 2 && d.next.length === 0 && !d.faces
    const action =
      !d.section && complete && this.last?.exact && this.last.vertices
        ? button('Make the solid', 'Enter', () => void this.make(), { class: 'primary' })
        : ''
    const shape = (one: Shape) =>
      button(one.words, one.key.toUpperCase(), () => this.askShape(one), {
        class: one.words === 'Extrude' && complete ? 'primary' : '',
      })
    this.bar.replaceChildren(
      button('Draw', 'D', () => this.use('draw'), {
        'aria-pressed': this.tool === 'draw',
        class: this.tool === 'draw' ? 'on' : '',
      }),
      button('Select', 'V', () => this.use('select'), {
        'aria-pressed': this.tool === 'select',
        class: this.tool === 'select' ? 'on' : '',
      }),
      ...(d.objects.length > 1
        ? [
            select(
              'object',
              d.objects.map((o) => [o, o]),
              d.object ?? '',
              (name) => this.choose(name),
            ),
          ]
        : []),
      ...(d.object && !d.section
        ? [
            select(
              'axes',
              [['', `Axes ${d.angles.join(' ')}`], ...PRESETS],
              '',
              (axes) => axes && void this.act([{ do: 'axes', axes }]),
            ),
          ]
        : []),
      h('span', { class: 'progress', role: 'status', 'aria-label': 'dimensions given of those needed' }, ...progress),
      ...(confirm.length ? [button(`${confirm.length} to confirm`, 'C', () => this.confirmNext())] : []),
      ...(this.proposed.size
        ? [button(`Accept ${this.proposed.size} proposed`, 'T', () => void this.acceptProposed())]
        : []),
      h('span', { class: 'grow' }),
      ...this.underlay.controls(this.say),
      ...(d.lines.length > 1 ? shapes(d, this.chosen) : []).map(shape),
      action,
      button('Fit', '0', () => this.fit()),
    )
  }

  private fit(): void {
    this.measurePage()
    this.page.fit(
      this.drawn.points.map((p) => [p[1], p[2]]),
      this.solid.element.clientWidth,
    )
    this.paint()
  }

  private use(tool: 'draw' | 'select'): void {
    this.tool = tool
    this.endChain()
    this.svg.dataset.tool = tool
    this.buttons()
    this.svg.focus({ preventScroll: true })
  }

  private choose(name: string): void {
    this.object = name
    this.text = null
    this.fitted = false
    this.refresh()
  }

  private listIssues(): void {
    const fault = this.drawn.faults[0]
    const fix = (command: string) => {
      const typed = /^TYPE (\d+) AS (\w+)$/.exec(command)
      return h(
        'button',
        {
          onclick: () =>
            void this.act([typed ? { do: 'type', lines: [Number(typed[1])], type: typed[2] } : { do: 'run', command }]),
        },
        command,
      )
    }
    // A doubt is ended by what is proposed, or by what is there.
    const sure = (c: Check) => {
      const [id] = c.about.lines
      const type = this.proposed.get(id) ?? this.drawn.lines.find((l) => l[0] === id)?.[3]
      return /doubtful|oblique|untyped/.test(c.about.kind) && type
        ? [`TYPE ${id} AS ${letter(type, this.drawn.section)}`]
        : []
    }
    this.issues.replaceChildren(
      ...(fault ? [h('div', { class: 'bad' }, `line ${fault.line}: ${fault.text}`)] : []),
      ...this.checks.slice(0, 5).map((c) =>
        h(
          'div',
          {
            class: 'issue',
            onpointerenter: () => this.choosePart(c),
            tabindex: 0,
            onfocus: () => this.choosePart(c),
          },
          c.text,
          ' ',
          ...[...new Set([...c.fixes, ...sure(c)])].map(fix),
        ),
      ),
      ...(this.checks.length > 5 ? [h('div', { class: 'quiet' }, `and ${this.checks.length - 5} more`)] : []),
    )
  }

  private choosePart(c: Check): void {
    this.chosen = new Set([...c.about.lines.map((l) => `l${l}`), ...c.about.points.map((p) => `p${p}`)])
    this.paint()
  }

  // Pointers.

  private at(e: { clientX: number; clientY: number }): Place {
    const box = this.svg.getBoundingClientRect()
    return [e.clientX - box.left, e.clientY - box.top]
  }

  private down(e: PointerEvent): void {
    if (this.drawn.object === null) return
    this.svg.focus({ preventScroll: true })
    const at = this.at(e)
    if (e.pointerType === 'pen') this.pen = performance.now()
    if (e.pointerType === 'touch') {
      // A palm comes with the pen, and is larger than a finger.
      if (this.pen && (performance.now() - this.pen < PALM || Math.max(e.width, e.height) > 60)) return
      this.touches.set(e.pointerId, at)
      if (this.touches.size === 2) {
        this.pressed = null
        return
      }
    }
    const target = e.target as Element
    this.svg.setPointerCapture(e.pointerId)
    const press = (kind: NonNullable<typeof this.pressed>['kind'], more: Facts = {}) =>
      (this.pressed = { id: e.pointerId, at, from: at, kind, moved: false, ...more })
    const mark = target.closest('[data-mark]')?.getAttribute('data-mark')
    const axis = target.closest('[data-axis]')?.getAttribute('data-axis')
    if (e.button === 2 && this.chain.length) {
      press('none')
      return this.endChain()
    }
    if (e.button !== 0 || (e.pointerType === 'touch' && this.pen)) press('pan')
    else if (axis) press('axis', { axis, angles: [...this.drawn.angles] })
    else if (mark && !this.chain.length) {
      press('none')
      this.openMark(mark)
    } else if (this.tool === 'draw') press('draw')
    else {
      const hit = this.painter.hit(at, this.drawn, REACH)
      const key = hit.point ? `p${hit.point}` : hit.line ? `l${hit.line}` : ''
      if (!e.shiftKey && !this.chosen.has(key)) this.chosen.clear()
      if (key) this.chosen.add(key)
      press(hit.point ? 'move' : key ? 'none' : 'pan', { what: hit.point })
      this.paint()
    }
  }

  private move(e: PointerEvent): void {
    const at = this.at(e)
    if (e.pointerType === 'touch' && this.touches.has(e.pointerId)) {
      if (this.touches.size === 2) return this.pinch(e.pointerId, at)
      this.touches.set(e.pointerId, at)
    }
    if (e.pointerType === 'pen') this.pen = performance.now()
    const pressed = this.pressed
    if (pressed) {
      const [dx, dy] = [at[0] - pressed.at[0], at[1] - pressed.at[1]]
      pressed.moved ||= Math.hypot(at[0] - pressed.from[0], at[1] - pressed.from[1]) > CLICK
      pressed.at = at
      if (!pressed.moved) return
      if (pressed.kind === 'pan') {
        this.page.pan(dx, dy)
        return this.paint()
      }
      if (pressed.kind === 'move')
        return this.dragging.push({ point: pressed.what!, at: this.rounded(this.page.from(at)) })
      if (pressed.kind === 'axis') return this.turnAxis(at)
      if (pressed.kind === 'none') return
    } else {
      const hit = this.painter.hit(at, this.drawn, REACH)
      this.hoveredLine = hit.line ?? 0
      if (hit.point && this.woken.at(-1) !== hit.point)
        this.woken = [...this.woken.filter((p) => p !== hit.point), hit.point].slice(-4)
      const name = (e.target as Element).closest('[data-mark]')?.getAttribute('data-mark')
      const lit = name ? this.markOf(name) : null
      if (lit !== this.lit) {
        this.lit = lit
        this.paint()
      }
    }
    if (this.tool !== 'draw' || this.drawn.object === null) return
    const start = this.chain.at(-1)?.at ?? (pressed?.kind === 'draw' ? this.page.from(pressed.from) : null)
    this.pointing.push({
      at: this.page.from(at),
      reach: REACH / this.page.scale,
      start,
      free: e.shiftKey,
      woken: this.woken,
    })
  }

  private up(e: PointerEvent): void {
    this.touches.delete(e.pointerId)
    const pressed = this.pressed
    if (!pressed || pressed.id !== e.pointerId) return
    this.pressed = null
    const at = this.at(e)
    if (pressed.kind === 'axis' && pressed.moved)
      void this.act([{ do: 'axes', axes: pressed.angles!.map((a) => String(Math.round(a))).join(' ') }])
    if (pressed.kind === 'move' && pressed.moved) this.drop(pressed.what!, at)
    if (pressed.kind !== 'draw') return
    const free = e.shiftKey
    // A drawing during the gesture may scroll the page.
    if (pressed.moved) void this.stroke(this.page.from(pressed.from), this.page.from(at), free)
    else void this.click(this.page.from(at), free)
  }

  private cancel(e: PointerEvent): void {
    this.touches.delete(e.pointerId)
    if (this.pressed?.kind === 'move') this.text = null
    this.pressed = null
    this.refresh()
  }

  private pinch(id: number, now: Place): void {
    const before = this.touches.get(id)!
    const other = [...this.touches].find(([k]) => k !== id)![1]
    const far = (a: Place) => Math.max(10, Math.hypot(a[0] - other[0], a[1] - other[1]))
    this.page.zoom(far(now) / far(before), [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2])
    this.page.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2)
    this.touches.set(id, now)
    this.paint()
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
      woken: this.woken,
    })) as Aim
    if (found.why === 'point') return { at: found.at, point: found.point }
    if (found.why === 'line' || found.why === 'mid') return { at: found.at, line: found.line, part: found.part }
    return { at: found.why ? (found.at.map((x) => Math.round(x * 1000) / 1000) as Place) : this.rounded(found.at) }
  }

  /** A corner of a chain. */
  private click(at: Place, free: boolean): Promise<unknown> {
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
  private stroke(from: Place, to: Place, free: boolean): Promise<unknown> {
    return this.later(async () => {
      const start = await this.corner(from, null, free)
      const end = await this.corner(to, start.at, free)
      await this.draw(start, end)
      this.endChain()
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
      if (commands.length) await this.carryOut([{ do: 'run', command: commands.join('; ') }])
    } catch (error) {
      for (const c of made) c.point = undefined
      throw error
    }
  }

  private endChain(): void {
    this.chain = []
    this.lock = ''
    this.aim(this.aimed)
  }

  private drop(point: number, at: Place): void {
    const place = this.rounded(this.page.from(at))
    const near = [...this.painter.places].find(
      ([id, p]) => id !== point && Math.hypot(p[0] - at[0], p[1] - at[1]) <= REACH,
    )?.[0]
    void this.later(async () => {
      await this.dragging.settled()
      try {
        await this.carryOut([near ? { do: 'run', command: `WELD ${near} ${point}` } : { do: 'move', point, at: place }])
        this.say(near ? `points ${near} and ${point} are one` : '')
      } catch (error) {
        this.text = null
        this.refresh()
        throw error
      }
    })
  }

  private turnAxis(at: Place): void {
    const pressed = this.pressed!
    const [ox, oy] = (this.svg.querySelector<SVGElement>('.triad')!.dataset.origin ?? '0,0').split(',').map(Number)
    const angle = Math.round((Math.atan2(oy - at[1], at[0] - ox) * 180) / Math.PI + 360) % 360
    pressed.angles![Object.keys(this.drawn.axes).indexOf(pressed.axis!)] = angle
    const r = (angle * Math.PI) / 180
    this.drawn = { ...this.drawn, axes: { ...this.drawn.axes, [pressed.axis!]: [Math.cos(r), Math.sin(r)] } }
    this.paint()
    this.say(`${pressed.axis!.toLowerCase()} axis at ${angle}°`)
  }

  // Dimensions.

  private markOf(name: string): Mark | null {
    return [...this.drawn.next, ...this.drawn.marks].find((m) => m.name === name) ?? null
  }

  private openMark(name: string): void {
    const mark = this.markOf(name)
    if (mark) this.box.open(mark, this.drawn.next.includes(mark))
    this.paint()
  }

  /** The missing dimension after the open one, or the first; false when none is missing. */
  private openNext(step: number): boolean {
    const { next } = this.drawn
    if (!next.length) {
      this.box.close()
      this.svg.focus()
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
      if (!fine) return this.box.refuse()
      if (missing) {
        this.box.close()
        this.openNext(1)
      } else {
        this.box.close()
        this.svg.focus()
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

  private toConfirm(): number[] {
    const doubted = this.checks
      .filter((c) => /doubtful|oblique|untyped/.test(c.about.kind))
      .flatMap((c) => c.about.lines)
    return [...new Set(doubted)].filter((id) => this.drawn.lines.some((l) => l[0] === id && l[4] !== 'user'))
  }

  private confirmNext(): void {
    const all = this.toConfirm()
    const now = all.findIndex((id) => this.chosen.has(`l${id}`))
    if (!all.length) return
    const id = all[(now + 1) % all.length]
    this.chosen = new Set([`l${id}`])
    this.paint()
    this.say(`line ${id}: X Y Z H P F O set its type and lock it`)
    this.svg.focus()
  }

  private async acceptProposed(): Promise<void> {
    const found = [...this.proposed].map(([id, type]) => ({
      do: 'type',
      lines: [id],
      type: letter(type, this.drawn.section),
    }))
    this.proposed.clear()
    await this.act(found)
  }

  /** Makes the body; of several that fit, the one with a number. */
  private async make(chosen = 0): Promise<void> {
    const commands = [...(chosen && this.last?.made ? [] : ['GENERATE FACES']), ...(chosen ? [`CHOOSE ${chosen}`] : [])]
    if (await this.act(commands.map((command) => ({ do: 'run', command, last: true }))))
      this.say('The body is in the model, exact.')
  }

  /** Asks for the number of a shape, and makes it. */
  private askShape(shape: Shape): void {
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
          fine ? (this.box.close(), this.fit(), this.svg.focus()) : this.box.refuse(),
        ),
    )
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
        setTimeout(() => this.refresh(), 0)
      })
      return
    }
    if (e.altKey || /^F\d/.test(e.key)) return
    const lines = labels(this.chosen, 'l')
    if (key in TYPES) {
      const type = TYPES[key]
      const own = this.drawn.section && type.length > 1 ? 'F' : letter(type, null)
      if (this.chain.length) {
        this.lock = this.lock === type ? '' : type
        this.aim(this.aimed)
      } else if (lines.length || this.hoveredLine) {
        const which = lines.length ? lines : [this.hoveredLine]
        void this.act(which.map((line) => ({ do: 'type', lines: [line], type: own })))
      } else this.say('a type needs a line: point at one, or choose it')
      return done()
    }
    if (/^[\d.]$/.test(e.key) && this.between(e.key)) return done()
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[e.key]
    if (step) this.nudge(step.map((x) => (x * (e.shiftKey ? 10 : 1)) / this.page.scale) as Place)
    else if (key === 'escape') {
      if (this.chain.length) this.endChain()
      else this.chosen.clear()
      this.paint()
    } else if (key === 'tab') {
      if (e.shiftKey || !this.openNext(1)) return
    } else if (key === 'd') this.use('draw')
    else if (key === 'v') this.use('select')
    else if (key === 'c') this.confirmNext()
    else if (key === 't') void this.acceptProposed()
    else if (key === 'n') this.walk(e.shiftKey ? -1 : 1)
    else if (shapes(this.drawn, this.chosen).some((one) => one.key === key))
      this.askShape(shapes(this.drawn, this.chosen).find((one) => one.key === key)!)
    else if (key === '0') this.fit()
    else if (key === 'delete' || key === 'backspace') this.remove()
    else if (key === 'enter') {
      if (this.chain.length) this.endChain()
      else if (!this.drawn.next.length && !this.drawn.section && !this.drawn.faces && this.last?.exact) void this.make()
    } else if (e.key.length > 1) return
    done()
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
    }
  }

  onScreen(at: Place): Place {
    const box = this.svg.getBoundingClientRect()
    const [x, y] = this.page.to(at)
    return [box.left + x, box.top + y]
  }
}
