// The fairing desk: a curve, a surface, a network or a table of offsets, faired by hand; every act is a command in its log.

import { Contacts } from './contacts'
import './desk.css'
import { CutForm } from './desk_cut'
import { DeskLists } from './desk_lists'
import { type Chosen, type DeskFacts, DeskPainter, Sheet, strips, views } from './desk_paint'
import { h, s, shown, store, stored } from './dom'
import type { Editor } from './editor'
import type { Facts } from './frame'
import { type Link, Newest, Refused } from './link'
import { model } from './state'

type Place = [number, number]

/** Marks on one point and on a stretch between two: tool, its key, its command, words. */
const POINTS: [string, string, string][] = [
  ['knuckle', 'k', 'Knuckle'],
  ['fix', 'f', 'Fixed'],
  ['free', 'e', 'Free'],
]
const SPANS: [string, string, string][] = [
  ['straight', 's', 'Straight'],
  ['flat', 'l', 'Flat'],
  ['arc', 'a', 'Arc'],
  ['one-way', 'i', 'No inflection'],
  ['range', 'r', 'Range'],
]
const TOOLS: [string, string, string][] = [...POINTS, ...SPANS, ['side', 'o', 'One-sided'], ['weight', 'w', 'Weight']]
/** Picture points up by which a dragged weight grows e times, and the least and the largest. */
const [GROWTH, LIGHTEST, HEAVIEST] = [60, 0.01, 1000]
/** Pixels: what a pointer reaches, and what is a click. */
const [REACH, CLICK] = [12, 4]
/** How long a hand rests on a slider before the curve is finished, ms. */
const REST = 140
/** Range of the slider in decades to each side of the first tolerance. */
const DECADES = 1.5
const LARGEST = 8 << 20

interface Session {
  source: Facts
  tolerance: number
  key?: string
}

/** The name under which the result is in the text, and the statements. */
interface Applied {
  name: string
  text: string
}

/** What a step of the history restores. */
interface Kept {
  session: Session | null
  log: string[]
  applied: Applied | null
}

/** A pointer that is down: on a point, on nothing, or only there to move the sheet. */
interface Press {
  id: number
  at: Place
  kind: 'point' | 'empty' | 'pan'
  point: number
  moved: boolean
  command?: string
}

export class Desk {
  readonly element = h('div', { class: 'desk', hidden: true })
  /** Times of requests, for tests: kind and milliseconds. */
  readonly times: { kind: string; ms: number }[] = []
  private readonly svg = s('svg', {
    class: 'desk-shape',
    tabindex: 0,
    role: 'application',
    'aria-label': 'fairing desk',
    'aria-describedby': 'desk-help',
  })
  private readonly sheet = new Sheet()
  private readonly painter = new DeskPainter(this.svg, this.sheet)
  private readonly bar = h('div', { class: 'desk-bar', role: 'toolbar', 'aria-label': 'fairing' })
  private readonly lists = new DeskLists({
    run: (command) => void this.run(command),
    showLine: (k) => this.showLine(k),
    showPoint: (line, point) => this.showPoint(line, point),
  })
  private readonly cutting = new CutForm(
    (command) => this.run(command),
    (words) => this.say(words),
    () => this.svg.focus(),
  )
  private readonly top = h('div', { class: 'desk-views' })
  private readonly below = h('div', { class: 'desk-strips' })
  private readonly start = h('div', { class: 'desk-start' })
  private readonly progress = h('div', { class: 'desk-progress', role: 'status', hidden: true })
  private readonly line = h('input', {
    type: 'text',
    class: 'desk-line',
    'aria-label': 'fairing command',
    placeholder: 'a command of the desk: tolerance 0.02, knuckle 12, straight 1-9, range 5-20, lock 3, cut z 1.5 …',
    spellcheck: 'false',
    autocomplete: 'off',
  })
  private readonly slider = h('input', {
    type: 'range',
    min: -DECADES,
    max: DECADES,
    step: 0.01,
    'aria-label': 'tolerance',
  })
  private readonly value = h('input', { type: 'text', 'aria-label': 'tolerance as a number', inputmode: 'decimal' })
  private session: Session | null = null
  private facts: DeskFacts | null = null
  private log: string[] = []
  private applied: Applied | null = null
  private shownLine = 0
  private tool = 'select'
  private chosen: Chosen = { point: 0, anchor: -1 }
  private pressed: Press | null = null
  private readonly contacts = new Contacts()
  private queue: Promise<unknown> = Promise.resolve()
  private timer = 0
  private stopping = false
  /** Counts decided states: what was asked of an older one is not drawn over a newer. */
  private decided = 0
  /** Whether what is drawn is not decided. */
  private previewed = false
  /** Whether the slider has moved since a tolerance was decided. */
  private slid = false
  private readonly sliding = new Newest<{ command: string; final: boolean; decided: number }>(
    async ({ command, final, decided }) => {
      if (decided !== this.decided) return
      try {
        const found = await this.ask('desk_slide', { command, final })
        if (decided !== this.decided) return
        this.draw({ ...this.facts!, ...found } as DeskFacts)
      } catch (error) {
        if (!(error instanceof Refused && error.message === 'superseded')) this.say((error as Error).message)
      }
    },
  )

  constructor(
    private readonly link: Link,
    private readonly editor: Editor,
    private readonly say: (words: string) => void,
    private readonly give: (blob: Blob, name: string) => void,
  ) {
    const help = h(
      'p',
      { class: 'sr', id: 'desk-help' },
      'Arrow keys go through points, Shift extends a stretch. K marks a knuckle, F a fixed point, S straight, L flat, A arc, I no inflection, R range, E frees. Alt and arrows move a point. Brackets change the tolerance, G the goal, N the line. Enter accepts a suspect.',
    )
    this.value.addEventListener('keydown', (e) => {
      e.stopPropagation()
      if (e.key === 'Enter') void this.run(`tolerance ${this.value.value.trim().replace(/^(\d+),(\d+)$/, '$1.$2')}`)
    })
    this.slider.addEventListener('input', () => this.slide())
    this.slider.addEventListener('change', () => void this.settleTolerance())
    // A slide that ends where it began is no change.
    for (const end of ['pointerup', 'pointercancel', 'blur'])
      this.slider.addEventListener(end, () => setTimeout(() => this.slid && this.undecided()))
    this.element.append(
      this.bar,
      this.cutting.element,
      h(
        'div',
        { class: 'desk-body' },
        this.lists.element,
        h('div', { class: 'desk-main' }, this.top, this.svg as unknown as HTMLElement, this.below, this.progress),
      ),
      this.line,
      this.start,
      help,
    )
    this.line.addEventListener('keydown', (e) => {
      e.stopPropagation()
      if (e.key === 'Escape') this.svg.focus()
      if (e.key !== 'Enter' || !this.line.value.trim()) return
      void this.run(this.line.value).then((fine) => fine && (this.line.value = ''))
    })
    const on = (name: string, run: (e: any) => void) => this.svg.addEventListener(name, run)
    on('pointerdown', (e) => this.down(e))
    on('pointermove', (e) => this.move(e))
    on('pointerup', (e) => this.up(e))
    on('pointercancel', (e) => {
      this.contacts.up(e)
      if (this.pressed?.id === e.pointerId) this.release()
    })
    on('contextmenu', (e) => e.preventDefault())
    on('wheel', (e: WheelEvent) => {
      e.preventDefault()
      this.sheet.zoom(Math.exp(-e.deltaY * 0.0015), this.at(e))
      this.paint()
    })
    this.element.addEventListener('keydown', (e) => this.history(e))
    on('keydown', (e) => this.key(e))
    for (const name of ['dragover', 'drop'])
      this.element.addEventListener(name, (e) => {
        e.preventDefault()
        const file = (e as DragEvent).dataTransfer?.files?.[0]
        if (name === 'drop' && file) void this.openFile(file)
      })
    new ResizeObserver(() => this.paint()).observe(this.element)
  }

  show(on: boolean): void {
    this.element.hidden = !on
    if (!on) return
    this.starting()
    this.buttons()
    this.paint()
    ;(this.session ? (this.svg as unknown as HTMLElement) : (this.start.querySelector('button') as HTMLElement))?.focus(
      { preventScroll: true },
    )
  }

  async settled(): Promise<void> {
    for (let last = null; last !== this.queue; ) await (last = this.queue)
    while (this.timer) await new Promise((r) => setTimeout(r, 5))
    await this.sliding.settled()
    await this.queue
  }

  // Requests.

  private async ask(kind: string, fields: Facts = {}): Promise<Facts> {
    const from = performance.now()
    const session = this.session
    const own = session ? { log: this.log, line: this.shownLine, key: session.key } : {}
    let found = await this.link.tell({ kind, ...own, ...fields })
    // A new process has no state: it is sent the whole.
    if (found.unknown && session)
      found = await this.link.tell({ kind, ...own, source: session.source, tolerance: session.tolerance, ...fields })
    this.times.push({ kind, ms: performance.now() - from })
    if (session && found.key) session.key = found.key
    return found
  }

  private later<T>(run: () => Promise<T>): Promise<T | undefined> {
    const done = this.queue.then(run).catch((error) => {
      if (!(error instanceof Refused && error.message === 'superseded')) this.say((error as Error).message)
      return undefined
    })
    this.queue = done
    return done
  }

  async openFile(file: File): Promise<void> {
    if (file.size > LARGEST) return this.say(`${file.name} is larger than ${LARGEST >> 20} MiB`)
    const text = await file.text()
    await this.open({ table: [file.name, text] })
  }

  /** Open a table or an object of the model; the log begins. */
  open(what: Facts): Promise<unknown> {
    return this.later(async () => {
      await this.editor.synced()
      const before = this.kept
      const found = await this.link.tell({ kind: 'desk_open', ...what, line: 0 })
      this.session = { source: found.source, tolerance: found.tolerance, key: found.key }
      ;[this.log, this.shownLine, this.applied] = [[], 0, null]
      this.stepped(`Open ${found.title}`, before)
      this.chosen = { point: found.detail.points[0], anchor: -1 }
      this.slider.value = '0'
      this.start.hidden = true
      await this.lineByLine()
      this.take(found as DeskFacts, true)
      this.svg.focus()
      this.say(
        `${found.title}: ${found.list.length === 1 ? `${found.detail.points.length} points` : `${found.list.length} lines`}, tolerance ${shown(found.tolerance)} by the scatter of the points`,
      )
    })
  }

  /** Go on with a session that the browser has kept. */
  private goOn(kept: Facts): Promise<unknown> {
    return this.later(async () => {
      let before = this.kept
      this.session = { source: kept.source, tolerance: kept.tolerance }
      ;[this.log, this.shownLine, this.applied] = [[], 0, null]
      this.stepped(`Go on with ${kept.source.name}`, before)
      for (const command of kept.log as string[]) {
        before = this.kept
        this.log = [...this.log, command]
        this.stepped(command, before)
      }
      this.start.hidden = true
      this.take((await this.ask('desk_show')) as DeskFacts, true)
      this.svg.focus()
    })
  }

  /** A command, as one step of the desk's history. */
  run(command: string): Promise<boolean> {
    return this.later(async () => {
      if (!this.session) throw new Error('open a table or an object first')
      const before = this.kept
      const found = await this.carriedOut(command)
      this.log = found.log
      this.say('')
      this.take(found as DeskFacts)
      if (this.applied) await this.written(command, before, this.applied)
      else this.stepped(command, before)
      return true
    }).then((x) => x === true)
  }

  private async carriedOut(command: string): Promise<Facts> {
    // What is under way for a slider or a drag comes too late now.
    this.decided++
    try {
      await this.lineByLine(command)
      return await this.ask('desk_run', { command })
    } catch (error) {
      // What a slider or a drag has drawn is not the case.
      if (this.previewed) this.take((await this.ask('desk_show')) as DeskFacts)
      throw error
    }
  }

  /** Many lines that are faired one by one: how far they are, and a way to stop. */
  private async lineByLine(command = ''): Promise<void> {
    const many = this.facts?.list.length ?? 0
    if (this.facts?.kind !== 'curves' || many < 2 || !/^(tolerance|goal)/.test(command)) return
    this.stopping = false
    const stop = h('button', { onclick: () => this.stop() }, 'Stop')
    const words = h('span', {})
    this.progress.replaceChildren(words, stop)
    this.progress.hidden = false
    try {
      for (let k = 0; k < many; k++) {
        words.textContent = `${this.facts.list[k].name}: ${k} of ${many}`
        await this.ask('desk_line', { only: k, command })
        if (this.stopping) throw new Error(`stopped after ${k + 1} of ${many} lines: nothing has changed`)
      }
    } finally {
      this.progress.hidden = true
    }
  }

  private stop(): void {
    this.stopping = true
    void this.link.tell({ kind: 'desk_stop' }).catch(() => undefined)
  }

  private get kept(): Kept {
    return { session: this.session, log: this.log, applied: this.applied }
  }

  /** A step of the page's history, from the state before to the present one. */
  private stepped(name: string, before: Kept): void {
    const after = this.kept
    this.editor.steps.add({
      name: `Desk: ${name}`,
      back: () => this.restore(before),
      again: () => this.restore(after),
    })
  }

  private restore({ session, log, applied }: Kept): void {
    const fit = session !== this.session
    ;[this.session, this.log, this.applied] = [session, log, applied]
    this.decided++
    if (!session) this.facts = null
    void this.later(async () => {
      this.starting()
      if (this.session) return this.take((await this.ask('desk_show')) as DeskFacts, fit)
      this.buttons()
      this.paint()
    })
  }

  /** Steps of the page's history, back or, with a negative count, again. */
  private turn(count: number): void {
    void this.later(async () => {
      if (!this.editor.steps.go(count)) this.say(`nothing to ${count > 0 ? 'undo' : 'redo'}`)
      await this.editor.synced()
    })
  }

  private async apply(): Promise<void> {
    await this.later(async () => {
      if (!this.session) return
      const stem = String(this.facts!.title)
        .replace(/\.\w+$/, '')
        .replace(/\W+/g, '_')
        .replace(/^(\d|_)/, 'f$1')
      const taken = (name: string) => model.objects.some((o) => o.name === name)
      let name = taken(stem) ? `${stem}_faired` : stem
      for (let k = 2; taken(name); k++) name = `${stem}_faired_${k}`
      if (this.applied) name = this.applied.name
      const old = { name, text: this.applied?.text ?? '' }
      if (await this.written(`Apply ${name}`, this.kept, old, true)) this.say(`${name} is in the text`)
    })
  }

  /** The result in the text, as one step with the act that made it; false if the text stays. */
  private async written(act: string, before: Kept, { name, text }: Applied, anew = false): Promise<boolean> {
    await this.editor.synced()
    if (!anew && !this.editor.text.includes(text)) {
      // Statements that were edited by hand are left alone.
      this.applied = null
      this.stepped(act, before)
      return false
    }
    try {
      const { applied, edits, version } = await this.ask('desk_apply', { name, applied: text })
      this.applied = { name, text: applied }
      this.stepped(act, before)
      if (anew || applied !== text) this.editor.apply(edits, version, act, [], true)
      await this.editor.synced()
      return true
    } catch (error) {
      if (!anew) this.stepped(act, before)
      this.say(`the text stays: ${(error as Error).message}`)
      return false
    }
  }

  private async save(name: string): Promise<void> {
    await this.later(async () => {
      const answer = await this.ask('desk_save', { name })
      const bytes = Uint8Array.from(atob(answer.data), (c) => c.charCodeAt(0))
      this.give(new Blob([bytes]), name)
    })
  }

  // What is shown.

  private take(facts: DeskFacts, fit = false): void {
    this.facts = facts
    this.decided++
    this.previewed = false
    // A page that is loaded again goes on from here; a table too large for the browser's store is opened anew.
    if (this.session)
      store(`desk.${model.name}`, { source: this.session.source, tolerance: this.session.tolerance, log: this.log })
    this.shownLine = facts.line
    if (!facts.detail.points.includes(this.chosen.point)) this.chosen = { point: facts.detail.points[0], anchor: -1 }
    if (!facts.detail.points.includes(this.chosen.anchor)) this.chosen.anchor = -1
    this.setSlider(facts.limit)
    this.lists.fill(facts)
    this.buttons()
    this.paint()
    if (fit) this.fit()
  }

  /** A picture of what is not decided: the lists of marks stay. */
  private draw(facts: DeskFacts): void {
    this.facts = facts
    this.previewed = true
    this.lists.fillLines(facts)
    this.badge()
    this.paint()
  }

  private setSlider(limit: number): void {
    if (!this.session) return
    this.value.value = shown(limit).replace('−', '-')
    if (limit > 0) this.slider.value = String(Math.log10(limit / this.middle))
    this.slider.setAttribute('aria-valuetext', `${shown(limit)} ${this.session.source.unit ?? ''}`.trim())
  }

  private measure(): void {
    const { width, height } = this.svg.getBoundingClientRect()
    if (width) this.sheet.size = [width, height]
  }

  private paint(): void {
    if (this.element.hidden) return
    if (!this.facts) return this.cleared()
    this.measure()
    this.painter.draw(this.facts, this.chosen, this.tool)
    const wide = (this.svg.parentElement as HTMLElement).clientWidth || 600
    this.below.replaceChildren(...(strips(this.facts, wide) as unknown as HTMLElement[]))
    this.top.replaceChildren(...(views(this.facts, wide, 190) as unknown as HTMLElement[]))
    for (const line of this.top.querySelectorAll<SVGElement>('[data-line]'))
      line.addEventListener('click', () => this.showLine(Number(line.dataset.line)))
  }

  /** Nothing is open. */
  private cleared(): void {
    for (const part of [this.top, this.below]) part.replaceChildren()
  }

  fit(): void {
    this.measure()
    if (this.facts) this.sheet.fit(this.facts.detail.data)
    this.paint()
  }

  private showLine(k: number): void {
    const many = this.facts?.list.length ?? 0
    if (!many) return
    const next = Math.max(0, Math.min(many - 1, k))
    void this.later(async () => {
      this.shownLine = next
      this.take((await this.ask('desk_show')) as DeskFacts, true)
      const f = this.facts!.list[next]
      this.say(`${f.name}, ${f.inflections[1]} inflections, ${f.pieces[1]} pieces, moved ${shown(f.moved, 3)}`)
    })
  }

  private showPoint(line: number, point: number): void {
    this.chosen = { point, anchor: -1 }
    this.showLine(line)
    this.svg.focus()
  }

  private badge(): void {
    const badge = this.bar.querySelector('.badge')
    if (!badge || !this.facts) return
    const { state, words } = this.facts.detail.certificate
    badge.className = `badge ${state}`
    badge.textContent =
      state === 'certified'
        ? 'certified'
        : state === 'kept'
          ? 'within limits'
          : state === 'draft'
            ? 'draft'
            : 'limit not kept'
    badge.setAttribute('title', words)
    badge.setAttribute('aria-label', words)
  }

  /** The list of things to open; it covers an open one, with its history, until another is chosen. */
  private starting(on = this.session === null): void {
    this.start.hidden = !on
    if (!on) return
    const choose = h('input', {
      type: 'file',
      accept: '.csv,.tsv,.txt,.dat,.xyz,.pts',
      'aria-label': 'a table of offsets',
    })
    choose.addEventListener('change', () => choose.files?.[0] && void this.openFile(choose.files[0]))
    const back = this.session
      ? h('button', { onclick: () => this.starting(false) }, `Back to ${this.facts?.title}`)
      : ''
    const picks = model.objects
      .filter((o) => ['curve', 'snake', 'surface'].includes(o.class) && o.state === 'ok')
      .slice(0, 60)
    const kept = stored<Facts | null>(`desk.${model.name}`, null)
    const again = kept
      ? h(
          'button',
          { class: 'primary', onclick: () => void this.goOn(kept) },
          `Go on with ${kept.source.name}, ${kept.log.length} ${kept.log.length === 1 ? 'step' : 'steps'}`,
        )
      : ''
    this.start.replaceChildren(
      back || again,
      h('h2', {}, 'Fair a curve, a surface or a table'),
      h(
        'p',
        { class: 'quiet' },
        'Drop a table of offsets or points here, choose a file, or pick a curve or a surface of the model.',
      ),
      choose,
      h(
        'div',
        { class: 'picks' },
        ...picks.map((o) => h('button', { onclick: () => void this.open({ object: o.name }) }, o.name)),
      ),
    )
  }

  private buttons(): void {
    const f = this.facts
    const button = (words: string, key: string, run: () => void, more: Facts = {}) =>
      h(
        'button',
        { title: key ? `${words} (${key})` : words, onclick: run, ...more },
        words,
        key ? h('kbd', {}, key) : '',
      )
    const tool = ([name, key, words]: [string, string, string]) =>
      button(words, key.toUpperCase(), () => this.use(name), {
        'aria-pressed': this.tool === name,
        class: this.tool === name ? 'on' : '',
      })
    const save = h(
      'select',
      { 'aria-label': 'save', title: 'save' },
      ...[
        ['', 'Save…'],
        ['csv', 'Table'],
        ['igs', 'Splines, IGES'],
        ['dxf', 'Splines, DXF'],
        ['json', 'Splines, JSON'],
        ['html', 'Sheet'],
      ].map(([v, words]) => h('option', { value: v }, words)),
    )
    save.addEventListener('change', () => {
      const stem = String(f?.title ?? 'faired').replace(/\.\w+$/, '')
      const own = String(f?.title ?? '').match(/\.\w+$/)?.[0] ?? '.csv'
      if (save.value) void this.save(`${stem}-faired${save.value === 'csv' ? own : `.${save.value}`}`)
      save.value = ''
    })
    const focus = (this.element.ownerDocument.activeElement as HTMLElement | null)?.getAttribute('title')
    this.bar.replaceChildren(
      button('Open', '', () => this.starting(!!this.start.hidden)),
      h('span', { class: 'tol' }, 'Tolerance', this.slider, this.value),
      button(f?.goal === 'fairest' ? 'Fairest' : 'Nearest', 'G', () => this.switchGoal(), {
        'aria-pressed': f?.goal === 'fairest',
      }),
      tool(['select', 'v', 'Select']),
      ...TOOLS.map(tool),
      ...(f && f.kind !== 'curves'
        ? [
            button('Cut…', '', () => this.cutting.open()),
            button('Put back', '', () => void this.run('put back'), { disabled: !f.cut }),
          ]
        : []),
      h('span', { class: 'grow' }),
      h('span', { class: 'badge', role: 'status' }),
      button('Fit', '0', () => this.fit()),
      save,
      button('Apply', '', () => void this.apply(), { class: 'primary' }),
    )
    this.badge()
    if (focus) this.bar.querySelector<HTMLElement>(`[title="${CSS.escape(focus)}"]`)?.focus()
  }

  private switchGoal(): void {
    void this.run(`goal ${this.facts?.goal === 'fairest' ? 'near' : 'fairest'}`)
  }

  private use(tool: string): void {
    const span = SPANS.find((t) => t[0] === tool)
    const { point, anchor } = this.chosen
    const both = span && anchor >= 0 && anchor !== point
    // A stretch that is chosen is marked at once.
    if (both) {
      this.chosen.anchor = -1
      return this.mark(tool, [anchor, point])
    }
    this.tool = this.tool === tool ? 'select' : tool
    this.chosen.anchor = -1
    this.buttons()
    this.paint()
  }

  private mark(tool: string, [a, b]: [number, number]): void {
    const order = this.facts!.detail.points
    const [p, q] = [a, b].sort((x, y) => order.indexOf(x) - order.indexOf(y))
    void this.run(`${tool} ${p + 1}-${q + 1}`)
  }

  // The tolerance.

  /** The tolerance at the middle of the slider. */
  private get middle(): number {
    const { tolerance, source } = this.session!
    const extent = [0, 1, 2].map((k) => {
      const all = (source.points as number[][]).map((p) => p[k])
      return Math.max(...all) - Math.min(...all)
    })
    return tolerance || 1e-4 * Math.max(...extent)
  }

  private tolerance(): number {
    return Number((this.middle * 10 ** Number(this.slider.value)).toPrecision(3))
  }

  private command(value: number): string {
    return `tolerance ${value}`
  }

  private slide(): void {
    if (!this.session) return
    const value = this.tolerance()
    this.slid = true
    this.value.value = String(value)
    this.sliding.push({ command: this.command(value), final: false, decided: this.decided })
    clearTimeout(this.timer)
    this.timer = window.setTimeout(() => {
      this.timer = 0
      this.sliding.push({ command: this.command(value), final: true, decided: this.decided })
    }, REST)
  }

  private async settleTolerance(): Promise<void> {
    if (!this.session) return
    this.slid = false
    clearTimeout(this.timer)
    this.timer = 0
    await this.run(this.command(this.tolerance()))
  }

  // The pointer.

  private at(e: { clientX: number; clientY: number }): Place {
    const box = this.svg.getBoundingClientRect()
    return [e.clientX - box.left, e.clientY - box.top]
  }

  private down(e: PointerEvent): void {
    if (!this.facts) return
    this.svg.focus({ preventScroll: true })
    const at = this.at(e)
    this.arrives(e)
    const use = this.contacts.down(e, at)
    if (use === 'palm') return
    if (use === 'pinch') return this.release()
    this.svg.setPointerCapture(e.pointerId)
    const k = e.button === 0 && use === 'tool' ? this.painter.hit(at, REACH) : -1
    this.pressed = {
      id: e.pointerId,
      at,
      kind: k >= 0 ? 'point' : e.button === 0 && use === 'tool' ? 'empty' : 'pan',
      point: k >= 0 ? this.facts.detail.points[k] : -1,
      moved: false,
    }
  }

  /** A pen ends what fingers have begun. */
  private arrives(e: PointerEvent): void {
    if (this.contacts.arrives(e)) this.release()
  }

  private move(e: PointerEvent): void {
    const at = this.at(e)
    this.arrives(e)
    if (!this.facts || this.contacts.ignored(e)) return
    const pinch = this.contacts.pinch(e, at)
    if (pinch) {
      this.sheet.zoom(pinch.factor, pinch.middle)
      this.sheet.pan(...pinch.by)
      return this.paint()
    }
    const p = this.pressed
    if (!p || p.id !== e.pointerId) return
    if (!p.moved && Math.hypot(at[0] - p.at[0], at[1] - p.at[1]) < CLICK) return
    if (!p.moved && p.kind === 'point' && this.tool !== 'select' && this.tool !== 'weight') return
    p.moved = true
    if (p.kind !== 'point') {
      this.sheet.pan(at[0] - p.at[0], at[1] - p.at[1])
      p.at = at
      return this.paint()
    }
    p.command =
      this.tool === 'weight'
        ? this.weighed(p.point, p.at[1] - at[1])
        : `move ${p.point + 1} ${this.placed(p.point, this.sheet.from(at)).join(' ')}`
    this.sliding.push({ command: p.command, final: false, decided: this.decided })
  }

  /** The command for the weight of a point after a drag so far up. */
  private weighed(point: number, up: number): string {
    const given = (command: string) => /^weight (\S+) point (\d+)$/.exec(command)
    const last = this.log.map(given).findLast((m) => m && Number(m[2]) === point + 1)
    const heavy = Number(last?.[1] ?? 1) * Math.exp(up / GROWTH)
    const weight = Number(Math.max(LIGHTEST, Math.min(HEAVIEST, heavy)).toPrecision(3))
    this.say(`weight ${weight}: the tolerance of point ${point + 1} is divided by it`)
    return `weight ${weight} point ${point + 1}`
  }

  /** The place in space of a point that is seen there, rounded to what a pixel is worth. */
  private placed(point: number, [u, v]: Place): number[] {
    const { detail } = this.facts!
    const place = [...detail.place[detail.points.indexOf(point)]]
    const digits = Math.max(0, Math.min(12, Math.ceil(Math.log10(this.sheet.scale)) + 1))
    ;[place[detail.axes[0]], place[detail.axes[1]]] = [u, v].map((x) => Number(x.toFixed(digits)))
    return place
  }

  /** Gives up what is under way. */
  private release(): void {
    const given = this.pressed?.command
    this.pressed = null
    if (given) this.undecided()
  }

  /** Shows what is decided, in place of what a slider or a drag has drawn. */
  private undecided(): void {
    this.slid = false
    clearTimeout(this.timer)
    this.timer = 0
    void this.later(async () => {
      await this.sliding.settled()
      if (this.session) this.take((await this.ask('desk_show')) as DeskFacts)
    })
  }

  private up(e: PointerEvent): void {
    this.contacts.up(e)
    const p = this.pressed
    if (!p || p.id !== e.pointerId || !this.facts) return
    this.pressed = null
    if (p.moved) {
      if (p.command) {
        void this.later(() => this.sliding.settled())
        void this.run(p.command)
      }
      return
    }
    if (p.kind === 'pan') return
    if (p.kind === 'empty') {
      if (this.tool === 'side') return this.sideAt(this.at(e))
      this.chosen.anchor = -1
      return this.paint()
    }
    const point = p.point
    if (POINTS.some((t) => t[0] === this.tool)) {
      this.chosen = { point, anchor: -1 }
      return void this.run(`${this.tool} ${point + 1}`)
    }
    if (SPANS.some((t) => t[0] === this.tool)) {
      const { anchor } = this.chosen
      if (anchor < 0) this.chosen = { point, anchor: point }
      else {
        this.chosen = { point, anchor: -1 }
        if (anchor !== point) return this.mark(this.tool, [anchor, point])
      }
      return this.paint()
    }
    this.choose(point, e.shiftKey)
  }

  /** The curve stays on the other side of its points than where the click was. */
  private sideAt(at: Place): void {
    const { detail } = this.facts!
    const near = this.painter.places.reduce(
      (m, p, k, all) =>
        Math.hypot(p[0] - at[0], p[1] - at[1]) < Math.hypot(all[m][0] - at[0], all[m][1] - at[1]) ? k : m,
      0,
    )
    const [x, y] = this.painter.places[near]
    const way = [0, 0, 0]
    if (Math.abs(at[0] - x) > Math.abs(at[1] - y)) way[detail.axes[0]] = Math.sign(at[0] - x)
    else way[detail.axes[1]] = Math.sign(y - at[1])
    void this.run(`side ${way.join(',')} line ${this.shownLine + 1}`)
  }

  private choose(point: number, extend: boolean): void {
    if (extend && this.chosen.anchor < 0) this.chosen.anchor = this.chosen.point
    if (!extend) this.chosen.anchor = -1
    this.chosen.point = point
    this.paint()
    const dot = this.svg.querySelector(`[data-point="${point}"]`)
    this.say(dot?.getAttribute('aria-label') ?? '')
  }

  // Keys.

  private history(e: KeyboardEvent): void {
    const key = e.key.toLowerCase()
    if (!(e.ctrlKey || e.metaKey) || e.altKey || (key !== 'z' && key !== 'y')) return
    if ((e.target as HTMLElement).matches('input[type=text]') && !(e.target as HTMLInputElement).readOnly) return
    e.preventDefault()
    e.stopPropagation()
    this.turn(key === 'y' || e.shiftKey ? -1 : 1)
  }

  private key(e: KeyboardEvent): void {
    if (!this.facts || e.ctrlKey || e.metaKey || e.defaultPrevented) return
    const key = e.key.toLowerCase()
    const done = () => {
      e.preventDefault()
      e.stopPropagation()
    }
    const { points } = this.facts.detail
    const { point, anchor } = this.chosen
    const arrow = { arrowleft: [-1, 0], arrowright: [1, 0], arrowup: [0, 1], arrowdown: [0, -1] }[key]
    if (arrow && e.altKey) {
      done()
      const [u, v] = this.facts.detail.data[points.indexOf(point)]
      const by = (e.shiftKey ? 10 : 1) / this.sheet.scale
      void this.run(`move ${point + 1} ${this.placed(point, [u + arrow[0] * by, v + arrow[1] * by]).join(' ')}`)
      return
    }
    if (e.altKey || /^f\d/.test(key)) return
    if (arrow) {
      const at = points.indexOf(point) + (arrow[0] || arrow[1])
      if (at >= 0 && at < points.length) this.choose(points[at], e.shiftKey)
      return done()
    }
    const single = POINTS.find((t) => t[1] === key)
    const span = SPANS.find((t) => t[1] === key)
    if (single) void this.run(`${single[0]} ${point + 1}`)
    else if (span && anchor >= 0 && anchor !== point) {
      this.chosen.anchor = -1
      this.mark(span[0], [anchor, point])
    } else if (span)
      this.say(`${span[2]}: choose a stretch with Shift and the arrow keys, or click its ends`), this.use(span[0])
    else if (key === 'o') this.use('side')
    else if (key === 'w') this.use('weight')
    else if (key === '[' || key === ']')
      void this.run(
        this.command(Number(((this.facts.limit || this.middle) * (key === ']' ? 1.1 : 1 / 1.1)).toPrecision(3))),
      )
    else if (key === 'g') this.switchGoal()
    else if (key === 'n') this.showLine(this.shownLine + (e.shiftKey ? -1 : 1))
    else if (key === 'v') this.use('select')
    else if (key === '0') this.fit()
    else if (key === 'delete' || key === 'backspace') void this.run(`free ${point + 1}`)
    else if (key === 'enter') void this.run(`accept ${point + 1}`)
    else if (key === 'escape') {
      if (this.pressed) this.release()
      this.tool = 'select'
      this.chosen.anchor = -1
      this.buttons()
      this.paint()
    } else return
    done()
  }

  /** For tests: what is known, and where points are on the screen. */
  look(): Facts {
    const box = this.svg.getBoundingClientRect()
    const places = Object.fromEntries(
      (this.facts?.detail.points ?? []).map((p, k) => [
        p,
        [box.left + (this.painter.places[k]?.[0] ?? 0), box.top + (this.painter.places[k]?.[1] ?? 0)],
      ]),
    )
    return {
      facts: this.facts,
      log: this.log,
      places,
      chosen: this.chosen,
      tool: this.tool,
      session: this.session,
      scale: this.sheet.scale,
    }
  }
}
