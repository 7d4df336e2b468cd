// Studies of the model: made, started, watched and browsed beside the picture, which shows the row under the pointer.

import './studies.css'
import { h, s, shown } from './dom'
import type { Facts } from './frame'
import { type Link, Newest, Refused } from './link'
import { rangeOf } from './panels'
import { model } from './state'

export interface StudyActions {
  say(words: string): void
  /** Shows the model with these values, without writing them; with none as the text has it. */
  preview(values: Record<string, number> | null): Promise<void>
  /** Writes values into the text: a step of the history. */
  write(values: Record<string, number>, name?: string): Promise<void>
}

interface Definition {
  name: string
  error: string
  inputs: string[]
  outputs: string[]
  plan: string
  goal: string[]
  method: string
  programs: string[]
}

interface State {
  name: string
  running: boolean
  planned: number
  counts: Record<string, number>
  left?: number
  failed: string
}

interface Row {
  row: number
  numbers: (number | null)[]
  state: string
  message: string
  front: boolean
}

interface Page {
  inputs: string[]
  outputs: string[]
  objectives: Record<string, number>
  count: number
  first: number
  rows: Row[]
  points: [number, number, number][]
}

/** Time between two looks at a run, in ms. */
const LOOK = 700
/** Rows of a page of the table; the server sends as many. */
const ROWS = 500
const [WIDTH, HEIGHT, MARGIN] = [440, 260, 48]
const PLANS: [string, string][] = [
  ['sobol', 'Sobol sequence'],
  ['latin-hypercube', 'Latin hypercube'],
  ['grid', 'grid'],
  ['one-at-a-time', 'one at a time'],
]

/** A time that is left, in words. */
export function left(seconds: number): string {
  if (seconds < 90) return `${Math.max(1, Math.round(seconds))} s`
  const minutes = Math.round(seconds / 60)
  return minutes < 90 ? `${minutes} min` : `${Math.round(minutes / 60)} h`
}

/** The inputs of a row by name. */
export function inputsOf(page: Page, row: Row): Record<string, number> {
  return Object.fromEntries(page.inputs.map((name, k) => [name, row.numbers[k] ?? Number.NaN]))
}

export class Studies {
  readonly element = h('section', { class: 'studies', hidden: true, 'aria-label': 'studies' })
  private readonly top = h('div', { class: 'studies-top' })
  private readonly progress = h('div', { class: 'studies-progress', role: 'status' })
  private readonly plot = h('div', { class: 'studies-plot' })
  private readonly table = h('div', { class: 'studies-table' })
  private list: Definition[] = []
  private chosen = ''
  private making = false
  private state: State | null = null
  private page: Page | null = null
  private order = { sort: '', down: false, state: '', first: 0 }
  private axes = { x: '', y: '' }
  private timer = 0
  /** The row that the picture shows. */
  private seen: number | null = null
  private readonly reading = new Newest<void>(() => this.read())
  private readonly showing: Newest<{ values: Record<string, number> | null }>

  constructor(
    private readonly link: Link,
    private readonly act: StudyActions,
  ) {
    this.showing = new Newest<{ values: Record<string, number> | null }>(({ values }) => this.act.preview(values))
    this.element.append(this.top, this.progress, this.plot, this.table)
    this.element.addEventListener('pointerleave', () => this.look(null))
  }

  show(on: boolean): void {
    if (this.element.hidden === !on) return
    this.element.hidden = !on
    clearTimeout(this.timer)
    if (on) void this.refresh()
    else this.look(null)
  }

  /** For tests: until the picture shows what it is to show. */
  async settled(): Promise<void> {
    await this.reading.settled()
    await this.showing.settled()
  }

  private async ask(kind: string, fields: Facts = {}): Promise<Facts | null> {
    try {
      return await this.link.tell({ kind, ...fields })
    } catch (error) {
      if (error instanceof Refused) this.act.say(error.message)
      return null
    }
  }

  private async refresh(): Promise<void> {
    const found = await this.ask('studies')
    if (!found) return
    this.list = found.studies
    if (!this.list.some((d) => d.name === this.chosen)) this.chosen = this.list[0]?.name ?? ''
    this.making = this.list.length === 0
    await this.choose(this.chosen)
  }

  private async choose(name: string): Promise<void> {
    if (name !== this.chosen) {
      this.order = { sort: '', down: false, state: '', first: 0 }
      this.axes = { x: '', y: '' }
    }
    this.chosen = name
    this.page = this.state = null
    this.drawTop()
    this.drawTable()
    await this.watch()
  }

  private get definition(): Definition | undefined {
    return this.list.find((d) => d.name === this.chosen)
  }

  /** Polls the run while it lasts. */
  private async watch(): Promise<void> {
    clearTimeout(this.timer)
    if (!this.chosen || this.element.hidden) return this.drawProgress()
    const was = JSON.stringify(this.state?.counts)
    const state = (await this.ask('study_state', { name: this.chosen })) as State | null
    if (!state || state.name !== this.chosen) return
    const ended = this.state?.running && !state.running
    this.state = state
    this.drawProgress()
    if (ended) this.drawTop()
    if (JSON.stringify(state.counts) !== was || !this.page) this.reading.push(undefined)
    if (state.running && !this.element.hidden) this.timer = window.setTimeout(() => void this.watch(), LOOK)
  }

  private async read(): Promise<void> {
    const name = this.chosen
    const asked = { name, ...this.order, ...this.axes }
    const page = (await this.ask('study_rows', asked)) as Page | null
    if (!page || name !== this.chosen) return
    this.page = page
    const [x, y] = [page.inputs[0] ?? '', page.outputs[0] ?? '']
    if (!this.axes.x && x && y) {
      this.axes = { x, y }
      this.reading.push(undefined)
    }
    this.drawPlot()
    this.drawTable()
  }

  private async run(verb: string, retry = false): Promise<void> {
    const state = (await this.ask('study_run', { name: this.chosen, verb, retry })) as State | null
    if (!state) return
    this.state = state
    this.drawTop()
    await this.watch()
  }

  // What is above the table.

  private drawTop(): void {
    const d = this.definition
    const choice = h('select', { 'aria-label': 'study' }, ...this.list.map((o) => h('option', {}, o.name)))
    choice.value = this.chosen
    choice.addEventListener('change', () => {
      this.making = false
      void this.choose(choice.value)
    })
    const running = !!this.state?.running
    const button = (words: string, run: () => void, off = false, more = {}) =>
      h('button', { onclick: run, disabled: off, ...more }, words)
    const start = { class: 'primary', title: 'What has a result is not evaluated again' }
    const runs =
      d && !d.error
        ? [
            button('Start', () => void this.run('sweep'), running, start),
            d.goal.length ? button(`Optimise ${d.goal.join(', ')}`, () => void this.run('optimize'), running) : '',
            button('Retry failed', () => void this.run('sweep', true), running),
            button('Stop', () => void this.ask('study_stop', { name: d.name }).then(() => this.watch()), !running),
          ]
        : []
    this.top.replaceChildren(
      h(
        'div',
        { class: 'studies-bar', role: 'toolbar', 'aria-label': 'study' },
        this.list.length ? choice : '',
        ...runs,
        h('span', { class: 'grow' }),
        button('New study', () => ((this.making = !this.making), this.drawTop()), false, {
          'aria-expanded': String(this.making),
        }),
      ),
      ...(this.making ? [this.form()] : []),
      ...(d?.error ? [h('p', { class: 'bad pad' }, d.error)] : []),
      ...(d && !d.error && !this.making ? [h('p', { class: 'quiet' }, this.about(d))] : []),
    )
  }

  private about(d: Definition): string {
    const programs = d.programs?.length ? `; runs ${d.programs.join(', ')}` : ''
    const goal = d.goal.length ? `; ${d.method} of ${d.goal.join(', ')}` : ''
    return `${d.inputs.length} inputs, ${d.outputs.join(', ')}; plan ${d.plan}${goal}${programs}`
  }

  /** A new study of parameters and watched numbers. */
  private form(): HTMLElement {
    const boxes = (names: string[], on: (name: string) => boolean) =>
      names.map((name) => {
        const box = h('input', { type: 'checkbox', checked: on(name) })
        return { name, box, label: h('label', {}, box, name) }
      })
    const inputs = boxes(
      model.params.map((p) => p.name),
      (name) => !!model.params.find((p) => p.name === name)?.range,
    )
    const watched = model.watched.filter((w) => typeof w.value === 'number').map((w) => w.expression)
    const outputs = boxes(watched, () => true)
    const plan = h('select', { 'aria-label': 'plan' }, ...PLANS.map(([n, words]) => h('option', { value: n }, words)))
    const count = h('input', { type: 'number', min: 1, value: 64, class: 'number', 'aria-label': 'cases or levels' })
    const make = async () => {
      const picked = inputs.filter((i) => i.box.checked).map((i) => model.params.find((p) => p.name === i.name)!)
      const range = (p: (typeof picked)[number]) => (p.range ? null : [rangeOf(p).low, rangeOf(p).high])
      const found = await this.ask('study_make', {
        inputs: Object.fromEntries(picked.map((p) => [p.name, range(p)])),
        outputs: outputs.filter((o) => o.box.checked).map((o) => o.name),
        plan: plan.value,
        count: Math.round(Number(count.value)),
      })
      if (!found) return
      this.chosen = found.name
      await this.refresh()
      this.making = false
      this.drawTop()
      this.act.say(`${found.name} is beside the model; Start evaluates it`)
    }
    const group = (words: string, all: { label: HTMLElement }[], none: string) =>
      h(
        'fieldset',
        {},
        h('legend', {}, words),
        ...(all.length ? all.map((one) => one.label) : [h('span', { class: 'quiet' }, none)]),
      )
    return h(
      'div',
      { class: 'studies-form', role: 'group', 'aria-label': 'new study' },
      group('Inputs, over their ranges', inputs, 'the model has no parameters'),
      group('Outputs', outputs, 'watch a number in the strip below'),
      h(
        'div',
        { class: 'studies-bar' },
        plan,
        count,
        h('span', { class: 'quiet' }, 'cases, or levels of each input'),
        h('button', { class: 'primary', onclick: () => void make() }, 'Make'),
      ),
    )
  }

  private drawProgress(): void {
    const state = this.state
    if (!state || (!state.planned && !state.running && !state.failed)) return this.progress.replaceChildren()
    const done = Object.values(state.counts).reduce((a, b) => a + b, 0)
    const counts = Object.entries(state.counts).map(([name, n]) => `${n} ${name}`)
    const rest = state.left === undefined ? '' : `, ${left(state.left)} left`
    const words = `${done} of ${state.planned} cases${rest}`
    this.progress.replaceChildren(
      h('progress', { max: Math.max(state.planned, 1), value: done, 'aria-label': 'cases' }),
      h('span', {}, state.running ? `running: ${words}` : words),
      h('span', { class: 'quiet' }, counts.join(', ')),
      state.failed ? h('pre', { class: 'bad' }, state.failed) : '',
    )
  }

  // The table and its plot.

  private drawPlot(): void {
    const page = this.page
    if (!page?.inputs.length) return this.plot.replaceChildren()
    const axis = (name: 'x' | 'y') => {
      const choice = h(
        'select',
        { 'aria-label': `${name} of the plot` },
        ...[...page.inputs, ...page.outputs].map((n) => h('option', {}, n)),
      )
      choice.value = this.axes[name]
      choice.addEventListener('change', () => {
        this.axes[name] = choice.value
        this.reading.push(undefined)
      })
      return choice
    }
    const span = (all: number[]) => {
      const [a, b] = all.reduce(([l, u], v) => [Math.min(l, v), Math.max(u, v)], [Infinity, -Infinity])
      return b > a ? [a, b] : [a - 0.5, b + 0.5]
    }
    const focused = (document.activeElement as HTMLElement | null)?.getAttribute('aria-label')
    const bar = h('div', { class: 'studies-bar' }, axis('y'), h('span', { class: 'quiet' }, 'by'), axis('x'))
    if (!page.points.length) return this.plot.replaceChildren(bar)
    const [x0, x1] = span(page.points.map((p) => p[1]))
    const [y0, y1] = span(page.points.map((p) => p[2]))
    const X = (v: number) => MARGIN + ((WIDTH - MARGIN - 10) * (v - x0)) / (x1 - x0)
    const Y = (v: number) => HEIGHT - 24 - ((HEIGHT - 34) * (v - y0)) / (y1 - y0)
    const front = new Set(page.rows.filter((r) => r.front).map((r) => r.row))
    const dots = page.points.map(([row, x, y]) =>
      s('circle', {
        cx: X(x).toFixed(1),
        cy: Y(y).toFixed(1),
        r: 3,
        'data-row': row,
        class: front.has(row) ? 'front' : '',
      }),
    )
    const picture = s(
      'svg',
      { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img', 'aria-label': `${this.axes.y} by ${this.axes.x}` },
      s('path', { d: `M${MARGIN} 10V${HEIGHT - 24}H${WIDTH - 10}`, class: 'axis' }),
      ...dots,
      s('text', { x: MARGIN, y: HEIGHT - 8 }, shown(x0, 4)),
      s('text', { x: WIDTH - 10, y: HEIGHT - 8, class: 'end' }, shown(x1, 4)),
      s('text', { x: MARGIN - 5, y: HEIGHT - 24, class: 'end' }, shown(y0, 4)),
      s('text', { x: MARGIN - 5, y: 18, class: 'end' }, shown(y1, 4)),
    )
    picture.addEventListener('pointerover', (e) => {
      const row = (e.target as SVGElement).dataset?.row
      const found = page.rows.find((r) => r.row === Number(row))
      if (row !== undefined && found) this.look(found)
    })
    this.plot.replaceChildren(bar, picture as unknown as Node)
    if (focused?.endsWith('of the plot'))
      this.plot.querySelector<HTMLElement>(`[aria-label="${CSS.escape(focused)}"]`)?.focus()
  }

  private sorted(column: string): void {
    const down = this.order.sort === column ? !this.order.down : false
    this.order = { ...this.order, sort: column, down, first: 0 }
    this.reading.push(undefined)
  }

  private drawTable(): void {
    const page = this.page
    if (!page?.inputs.length) {
      const words = this.chosen ? 'No case has a result yet.' : 'No study of this model is beside it: make one.'
      this.plot.replaceChildren()
      return this.table.replaceChildren(h('p', { class: 'quiet' }, words))
    }
    const head = [...page.inputs, ...page.outputs].map((name) => {
      const on = this.order.sort === name
      const order = on ? (this.order.down ? 'descending' : 'ascending') : 'none'
      return h(
        'th',
        { 'aria-sort': order },
        h(
          'button',
          { class: 'link', onclick: () => this.sorted(name) },
          name,
          on ? (this.order.down ? ' ▾' : ' ▴') : '',
        ),
      )
    })
    const states = Object.keys(this.state?.counts ?? {})
    const filter = h(
      'select',
      { 'aria-label': 'state' },
      h('option', { value: '' }, 'all states'),
      ...states.map((name) => h('option', {}, name)),
    )
    filter.value = this.order.state
    filter.addEventListener('change', () => {
      this.order = { ...this.order, state: filter.value, first: 0 }
      this.reading.push(undefined)
    })
    const scrolled = this.table.scrollTop
    this.table.replaceChildren(
      h(
        'table',
        {},
        h('thead', {}, h('tr', {}, h('th', {}, '#'), ...head, h('th', {}, filter), h('th', {}, ''))),
        h('tbody', {}, ...page.rows.map((row) => this.line(page, row))),
      ),
      this.pages(page),
    )
    this.table.scrollTop = scrolled
  }

  private line(page: Page, row: Row): HTMLElement {
    const take = () => void this.take(page, row)
    const line = h(
      'tr',
      {
        tabindex: 0,
        'data-row': row.row,
        class: `${row.front ? 'front' : ''} ${row.state === 'done' ? '' : 'failed'}`,
      },
      h('th', { scope: 'row' }, row.row + 1),
      ...row.numbers.map((x) => h('td', { class: 'mono' }, x === null ? '' : shown(x, 6))),
      h('td', { title: row.message }, row.state),
      h('td', {}, h('button', { onclick: take, 'aria-label': `take case ${row.row + 1} into the text` }, 'Take')),
    )
    line.addEventListener('pointerenter', () => this.look(row))
    line.addEventListener('focusin', () => this.look(row))
    line.addEventListener('keydown', (e) => {
      const step = { ArrowDown: 'nextElementSibling', ArrowUp: 'previousElementSibling' }[e.key]
      if (e.key === 'Enter' && e.target === line) take()
      if (e.key === 'Escape') this.look(null)
      if (!step) return
      e.preventDefault()
      ;(line[step as 'nextElementSibling'] as HTMLElement | null)?.focus()
    })
    return line
  }

  private pages(page: Page): HTMLElement {
    const go = (first: number) => () => {
      this.order.first = first
      this.reading.push(undefined)
    }
    const last = page.first + page.rows.length
    const words = page.count ? `${page.first + 1} to ${last} of ${page.count}` : 'no case in this state'
    return h(
      'div',
      { class: 'studies-bar' },
      h('button', { disabled: page.first === 0, onclick: go(Math.max(0, page.first - ROWS)) }, 'Before'),
      h('span', {}, words),
      h('button', { disabled: last >= page.count, onclick: go(page.first + ROWS) }, 'Next'),
    )
  }

  /** Shows the shape of a row, or of the text. */
  private look(row: Row | null): void {
    if ((row?.row ?? null) === this.seen || (row && !this.page)) return
    this.seen = row?.row ?? null
    for (const mark of this.element.querySelectorAll('[data-row].seen')) mark.classList.remove('seen')
    for (const mark of this.element.querySelectorAll(`[data-row="${this.seen}"]`)) mark.classList.add('seen')
    if (row?.message) this.act.say(row.message)
    this.showing.push({ values: row && this.page ? inputsOf(this.page, row) : null })
  }

  /** Writes the inputs of a row into the text. */
  private async take(page: Page, row: Row): Promise<void> {
    this.seen = null
    this.showing.push({ values: null })
    await this.showing.settled()
    await this.act.write(inputsOf(page, row), `Case ${row.row + 1} of ${this.chosen}`)
    this.act.say(`Case ${row.row + 1} is in the text; Ctrl+Z takes it back`)
  }
}
