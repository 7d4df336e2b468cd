// Parameters, objects, the inspector, messages and the strip of numbers.

import { h, shown, store, stored } from './dom'
import { fileName } from './editor'
import { FIGURES, figure, unitOf } from './figures'
import type { RequestKind, RequestOf } from './link'
import type { GivenNumbers } from './numbers'
import type { FaultFact, ParamFact, RemarkFact } from './protocol'
import { changed, model, on } from './state'

export interface Actions {
  set(name: string, value: number): void
  /** Writes values into the text: a step of the history. */
  write(values: Record<string, number>, name?: string): Promise<void>
  /** The number that a text means: plain, an expression, with a unit. */
  typed(text: string): Promise<number>
  /** Runs when the hand rests; before anything else is done; the last of a name counts. */
  rest(name: string, run: () => Promise<void>): void
  /** What waits for the hand to rest runs now. */
  rested(): Promise<void>
  select(name: string, from: 'tree' | 'view' | 'text' | 'message' | 'graph'): void
  hover(name: string): void
  locate(name: string): Promise<void>
  /** Shows a place of the program, or of a file that it reads. */
  show(place: [number, number], file?: string): void
  apply(edits: { from: number; to: number; insert: string }[], version?: number, name?: string): void
  /** A change of statements by the engine: a step of the history. */
  rewrite<K extends RequestKind>(kind: K, fields: RequestOf<K>, name: string): Promise<void>
  toggle(name: string): void
  isolate(name: string | null): void
  /** Shows what was there before, while the hand moves. */
  ghost(on: boolean): void
  inspect(name: string, by: string | null): Promise<any>
  /** Opens an object on the fairing desk, where there is one. */
  fair: ((name: string) => void) | null
  watch(expressions: string[]): void
  say(words: string): void
  still: boolean
}

/** A range for a slider: the declared one, or one around the value. */
export function rangeOf(p: ParamFact): { low: number; high: number; stated: boolean } {
  if (p.range) return { low: p.range[0], high: p.range[1], stated: true }
  if (p.default === 0) return { low: -1, high: 1, stated: false }
  const ends = [p.default / 2, p.default * 2].sort((a, b) => a - b)
  return { low: ends[0], high: ends[1], stated: false }
}

/** A value with the digits that a slider's step is worth. */
export function stepped(value: number, low: number, high: number, whole: boolean): number {
  if (whole) return Math.round(value)
  const step = (high - low) / 1000
  const decimals = Math.max(0, Math.min(12, Math.ceil(-Math.log10(step || 1))))
  return Number(value.toFixed(decimals))
}

/** The name of a part with its point, when all names begin with it. */
export function commonPrefix(names: string[]): string {
  const first = names[0] ?? ''
  const prefix = first.slice(0, first.lastIndexOf('.') + 1)
  return names.every((n) => n.startsWith(prefix)) ? prefix : ''
}

export function parametersPanel(host: HTMLElement, act: Actions): void {
  const rows = new Map<
    string,
    {
      row: HTMLElement
      slider: HTMLInputElement
      field: HTMLInputElement
      reset: HTMLButtonElement
      p: ParamFact
      wanted: number | null
      from: number
    }
  >()
  let built = ''
  const empty = h('p', { class: 'quiet' }, 'No parameters. Declare one: param float beam = 4 in [3, 5];')
  const box = h('div', { class: 'params' })
  host.append(box, empty)
  const text = (p: ParamFact) => (p.whole ? String(Math.round(p.value)) : shown(p.value, 7))

  function build(): void {
    box.textContent = ''
    rows.clear()
    const prefix = commonPrefix(model.params.map((p) => p.name))
    for (const p of model.params) {
      const { low, high, stated } = rangeOf(p)
      const slider = h('input', {
        type: 'range',
        min: low,
        max: high,
        step: p.whole ? 1 : 'any',
        'aria-label': p.name,
        class: stated ? '' : 'guess',
        disabled: act.still,
        title: stated ? `${p.name}: ${low} to ${high}` : `${p.name}: no range is declared`,
      })
      const field = h('input', { type: 'text', class: 'number', 'aria-label': `${p.name}, value`, disabled: act.still })
      const reset = h('button', { class: 'icon', title: `${p.name} as before`, 'aria-label': `reset ${p.name}` }, '↺')
      const name = h(
        'button',
        { class: 'link name', title: `${p.name}: show in the program` },
        p.name.slice(prefix.length),
      )
      const row = h('div', { class: 'param' }, name, slider, field, reset)
      const entry = { row, slider, field, reset, p, wanted: null as number | null, from: p.value }
      /** Keys come one by one: what they do is written when they rest. */
      let keys = false
      rows.set(p.name, entry)
      const step = (value: number) => {
        const v = stepped(Math.min(high, Math.max(low, value)), low, high, p.whole)
        slider.value = String(v)
        field.value = p.whole ? String(v) : shown(v, 7)
        slider.setAttribute('aria-valuetext', field.value)
        if (entry.wanted === null) entry.from = entry.p.value
        entry.wanted = v
        act.set(p.name, v)
      }
      const write = async () => {
        const { wanted, from } = entry
        if (wanted === null) return
        // With its value: a text that came meanwhile has made the engine forget what was set.
        await act.write({ [p.name]: wanted }, `${p.name}: ${shown(from)} → ${shown(wanted)}`)
        if (entry.wanted !== wanted) return
        entry.wanted = null
        show(entry)
      }
      const commit = () => (keys ? act.rest(p.name, write) : void write())
      slider.addEventListener('pointerdown', () => {
        keys = false
        act.ghost(true)
        addEventListener('pointerup', () => act.ghost(false), { once: true })
      })
      slider.addEventListener('blur', () => void act.rested())
      slider.addEventListener('input', () => step(slider.valueAsNumber))
      slider.addEventListener('change', commit)
      slider.addEventListener('keydown', (event) => {
        const by = (high - low) / 100
        const moves: Record<string, number> = {
          ArrowRight: by / 10,
          ArrowUp: by / 10,
          ArrowLeft: -by / 10,
          ArrowDown: -by / 10,
          PageUp: by * 10,
          PageDown: -by * 10,
        }
        if (!(event.key in moves) && event.key !== 'Home' && event.key !== 'End') return
        keys = true
        if (!(event.key in moves) || p.whole) return
        event.preventDefault()
        step(slider.valueAsNumber + moves[event.key])
        commit()
      })
      const enter = async () => {
        // The shown digits are not the whole number: what was not typed over is not entered.
        if (field.value.trim() !== '' && field.value !== text(entry.p)) {
          try {
            await act.write({ [p.name]: await act.typed(field.value) })
          } catch (error) {
            act.say((error as Error).message)
          }
        }
        // What the model has, whatever was typed.
        field.value = text(entry.p)
      }
      field.addEventListener('keydown', (event) => {
        if (event.key === 'Enter') void enter()
        if (event.key === 'Escape') {
          field.value = text(entry.p)
          field.blur()
        }
      })
      field.addEventListener('blur', () => void enter())
      reset.addEventListener('click', () => void act.write({ [p.name]: begin.get(p.name) ?? p.default }))
      name.addEventListener('click', () => p.place && act.show(p.place))
      box.append(row)
    }
  }

  function show({ p, slider, field }: { p: ParamFact; slider: HTMLInputElement; field: HTMLInputElement }): void {
    if (!dragging(slider)) slider.value = String(p.value)
    if (document.activeElement !== field) field.value = text(p)
    slider.setAttribute('aria-valuetext', text(p))
  }

  /** Values when the page was opened, for reset. */
  const begin = new Map<string, number>()
  on('params', () => {
    const key = JSON.stringify(model.params.map((p) => [p.name, p.range, p.whole]))
    for (const p of model.params) if (!begin.has(p.name)) begin.set(p.name, p.value)
    if (key !== built) {
      built = key
      build()
    }
    empty.hidden = model.params.length > 0
    for (const p of model.params) {
      const entry = rows.get(p.name)
      if (!entry) continue
      entry.p = p
      // What a hand has just asked for stays: the engine may still answer what it was asked before.
      if (entry.wanted === null) show(entry)
      const moved = p.value !== begin.get(p.name)
      entry.row.classList.toggle('moved', moved)
      entry.reset.disabled = !moved || act.still
    }
  })
  let held: HTMLInputElement | null = null
  box.addEventListener('pointerdown', (e) => (held = e.target as HTMLInputElement))
  addEventListener('pointerup', () => (held = null))
  const dragging = (slider: HTMLInputElement) => held === slider
}

/** An argument of an object: its numbers, or its spelling in the program, which can be changed like typing. */
function formRow(f: any, version: number, act: Actions, chips: (names: string[]) => HTMLElement): HTMLElement {
  const unit = f.unit ? h('span', { class: 'unit' }, f.unit) : ''
  const row = (...value: (Node | string)[]) =>
    h(
      'div',
      { class: 'fact' },
      h('span', { class: 'key', title: f.help }, f.name),
      h('span', { class: 'value' }, ...value),
    )
  const { written } = f
  if (f.numbers.length && !f.switch) {
    // One that is typed over by an expression becomes it.
    const other =
      f.numbers.length === 1 && written?.text
        ? (text: string) =>
            act.apply([{ from: written.place[0], to: written.place[1], insert: text }], version, `${f.name}: ${text}`)
        : null
    return row(...f.numbers.map((n: any) => numberField(n, act, other)), unit)
  }
  const plain = f.objects.length ? chips(f.objects) : f.value === null ? '' : shown(f.value)
  if (!written || act.still) return row(plain, unit)
  // A text without its quotes; what is no plain text is spelled as it is.
  const quotes = f.class === 'text' && /^("[^"]*")?$/.test(written.text ?? '')
  const before = quotes ? (written.text ?? '').slice(1, -1) : (written.text ?? '')
  const write = (now: string) => {
    if (now === before || (!now && written.text === null)) return
    if (!now && !quotes) return act.say(`${f.name}: leave it out in the program`)
    if (quotes && /["\n]/.test(now)) return act.say('A text has no quotes in it')
    const spelled = quotes ? `"${now}"` : now
    act.apply(
      [
        {
          from: written.place[0],
          to: written.place[1],
          insert: written.text === null ? `, ${f.name} = ${spelled}` : spelled,
        },
      ],
      version,
      `${f.name}: ${spelled}`,
    )
  }
  if (f.switch && /^[01]?$/.test(before)) {
    const box = h('input', { type: 'checkbox', 'aria-label': f.name, checked: (before || String(f.value)) === '1' })
    box.addEventListener('change', () => write(box.checked ? '1' : '0'))
    return row(box)
  }
  const words: string[] = f.words.length > 1 ? f.words : []
  if (quotes && (words.includes(before) || (!before && words.length))) {
    const now = before || (f.value ?? '')
    const list = words.includes(now) ? words : [now, ...words]
    const choice = h(
      'select',
      { 'aria-label': f.name },
      ...list.map((w) => h('option', { value: w, selected: w === now }, w || '(not given)')),
    )
    choice.addEventListener('change', () => write(choice.value))
    return row(choice)
  }
  const input = h('input', {
    type: 'text',
    class: 'source',
    'aria-label': f.name,
    spellcheck: 'false',
    placeholder: f.value === null ? '' : shown(f.value),
  })
  input.value = before
  input.addEventListener('keydown', (e) => {
    if (e.key === 'Enter') input.blur()
    if (e.key === 'Escape') {
      input.value = before
      input.blur()
    }
  })
  input.addEventListener('blur', () => write(input.value.trim()))
  return row(f.objects.length ? plain : '', input, unit)
}

/** A number of the text. */
function numberField(n: any, act: Actions, other: ((text: string) => void) | null): HTMLInputElement {
  const input = h('input', { type: 'text', class: 'number', 'aria-label': n.path, title: n.path, disabled: act.still })
  const now = shown(n.value, 9)
  input.value = now
  input.addEventListener('keydown', (e) => e.key === 'Enter' && (input.blur(), undefined))
  input.addEventListener('blur', async () => {
    const text = input.value.trim()
    if (!text || text === now) return void (input.value = now)
    const plain = Number(text.replace('−', '-'))
    // An expression of names is written as it is; one of numbers and units is a number.
    if (
      !Number.isFinite(plain) &&
      other &&
      /[A-Za-z_]\w*/.test(text.replace(/\d\s*(mm|cm|dm|km|m|in|ft|yd|rad|deg)\s*$/, '0'))
    )
      return other(text)
    try {
      await act.write({ [n.path]: await act.typed(text) })
    } catch (error) {
      act.say((error as Error).message)
      input.value = now
    }
  })
  return input
}

/** An object's name: typed over, it is renamed everywhere. */
function titled(name: string, act: Actions): HTMLElement {
  if (act.still) return h('strong', {}, name)
  const input = h('input', { type: 'text', class: 'title', 'aria-label': 'name of the object', spellcheck: 'false' })
  input.value = name
  input.addEventListener('keydown', (e) => {
    if (e.key === 'Escape') input.value = name
    if (e.key === 'Enter' || e.key === 'Escape') input.blur()
  })
  input.addEventListener('blur', async () => {
    const now = input.value.trim()
    input.value = name
    if (!now || now === name) return
    await act.rewrite('rename_object', { name, new: now }, `Rename ${name} to ${now}`)
    act.select(now, 'text')
  })
  return input
}

export function inspectorPanel(host: HTMLElement, act: Actions & { selected: () => string }): void {
  let by: string | null = stored<string | null>('by', null)
  let serial = 0
  async function build(): Promise<void> {
    const name = act.selected()
    const now = ++serial
    if (!name) {
      host.replaceChildren(h('p', { class: 'quiet' }, 'Select an object in the view, the tree or the program.'))
      return
    }
    if (by && !model.params.some((p) => p.name === by)) by = null
    let found: any
    try {
      found = await act.inspect(name, by)
    } catch {
      return
    }
    const o = found?.object
    if (now !== serial || !o) return
    if (
      host.contains(document.activeElement) &&
      document.activeElement instanceof HTMLInputElement &&
      document.activeElement.type === 'text'
    )
      return
    const link = (n: string) =>
      h(
        'button',
        {
          class: 'chip',
          onclick: () => act.select(n, 'tree'),
          onpointerenter: () => act.hover(n),
          onpointerleave: () => act.hover(''),
        },
        n,
      )
    const chips = (names: string[]) => {
      const box = h('span', { class: 'chips' }, ...names.slice(0, 40).map(link))
      if (names.length > 40) box.append(h('span', { class: 'quiet' }, ` and ${names.length - 40} more`))
      return box
    }
    const rows: HTMLElement[] = []
    const absent: HTMLElement[] = []
    for (const f of o.fields)
      (f.value === null && !f.objects.length ? absent : rows).push(formRow(f, found.version, act, chips))
    if (absent.length)
      rows.push(h('details', { class: 'absent' }, h('summary', {}, `Not given (${absent.length})`), ...absent))
    const values = o.values as any[]
    const derivative = h(
      'select',
      { 'aria-label': 'derivative by' },
      h('option', { value: '' }, 'd/d …'),
      ...model.params.map((p) => h('option', { value: p.name, selected: p.name === by }, `d/d ${p.name}`)),
    )
    derivative.addEventListener('change', () => {
      by = derivative.value || null
      store('by', by)
      void build()
    })
    host.replaceChildren(
      h(
        'header',
        { class: 'inspected' },
        titled(o.name, act),
        h('span', { class: 'kind' }, o.kind),
        h('button', { class: 'link', onclick: () => void act.locate(o.name) }, 'in the program'),
      ),
      h('p', { class: 'quiet' }, o.about),
      ...(o.failure ? [h('p', { class: 'bad' }, o.failure)] : []),
      ...(o.waits ? [h('p', { class: 'bad' }, 'Waits for ', link(o.waits))] : []),
      ...rows,
      ...(values.length
        ? [
            h('h3', {}, 'Values', values.length && model.params.length ? derivative : ''),
            ...values.map((v) =>
              h(
                'div',
                { class: 'fact' },
                h('span', { class: 'key' }, v.expression),
                h(
                  'span',
                  { class: 'value mono' },
                  shown(v.value),
                  by && v.derivative !== undefined
                    ? h('span', { class: 'd' }, ` d/d ${by} = ${shown(v.derivative)}`)
                    : '',
                ),
              ),
            ),
          ]
        : []),
      h('h3', {}, 'Parents'),
      o.parents.length ? chips(o.parents) : h('span', { class: 'quiet' }, 'none'),
      h('h3', {}, 'Children'),
      o.children.length ? chips(o.children) : h('span', { class: 'quiet' }, 'none'),
      h(
        'div',
        { class: 'buttons' },
        h('button', { onclick: () => act.toggle(o.name) }, 'Hide or show'),
        h('button', { onclick: () => act.isolate(o.name) }, 'Isolate'),
        act.fair && ['curve', 'snake', 'surface'].includes(o.class)
          ? h('button', { onclick: () => act.fair?.(o.name) }, 'Fair on the desk')
          : '',
        ...(act.still || !model.program
          ? []
          : [
              h(
                'button',
                { onclick: () => void act.rewrite('duplicate', { name: o.name }, `Duplicate ${o.name}`) },
                'Duplicate',
              ),
              h(
                'button',
                { onclick: () => void act.rewrite('delete', { name: o.name }, `Delete ${o.name}`) },
                'Delete',
              ),
            ]),
        h(
          'button',
          { onclick: () => void navigator.clipboard?.writeText(o.name).then(() => act.say(`${o.name} copied`)) },
          'Copy name',
        ),
      ),
    )
  }
  on(['selection', 'rev', 'params'], () => void build())
}

export function messagesPanel(host: HTMLElement, act: Actions): void {
  const log = h('div', { role: 'log', 'aria-live': 'polite', 'aria-label': 'diagnostics', class: 'log' })
  host.append(log)
  let timer = 0
  /** A message with its sign, and more words below it. */
  function message(f: RemarkFact, where: string, more: string[]): HTMLElement {
    const item = h(
      'div',
      { class: `message ${f.severity}` },
      h(
        'button',
        { class: 'text' },
        h(
          'span',
          { class: 'sign', 'aria-hidden': 'true' },
          f.severity === 'error' ? '✕' : f.severity === 'warning' ? '!' : 'i',
        ),
        h('span', { class: 'sr' }, `${f.severity}: `),
        f.message,
        where ? h('span', { class: 'where' }, where) : '',
      ),
    )
    item.querySelector('button')!.addEventListener('click', () => {
      if (f.object) act.select(f.object, 'message')
    })
    for (const words of more.filter(Boolean)) item.append(h('div', { class: 'more' }, words))
    return item
  }
  function one(f: FaultFact): HTMLElement {
    const where = f.file ? `${fileName(f.file)}:${f.line}` : f.line ? `line ${f.line}` : ''
    const found = [f.expected ? `expected ${f.expected}` : '', f.found ? `found ${f.found}` : '']
    const item = message(f, where, [...found, ...f.notes, ...f.help])
    const go = () => {
      if (f.file && f.elsewhere) act.show(f.elsewhere, f.file)
      else if (f.place) act.show(f.place)
    }
    item.querySelector('button')!.addEventListener('click', go)
    if (f.edit)
      item.append(
        h(
          'button',
          {
            class: 'fix',
            onclick: () =>
              act.apply(
                [{ from: f.edit!.place[0], to: f.edit!.place[1], insert: f.edit!.insert }],
                undefined,
                f.edit!.title,
              ),
          },
          `Fix: ${f.edit.title}`,
        ),
      )
    return item
  }
  function build(): void {
    const all = model.faults.slice(0, 200)
    log.replaceChildren(
      ...all.map(one),
      ...model.made.remarks.slice(0, 200).map((r) => message(r, model.made.file, r.help)),
      ...model.printed.slice(0, 200).map((line) => h('div', { class: 'message printed' }, line)),
    )
    if (!log.childElementCount) log.append(h('div', { class: 'message quiet' }, 'No problems'))
  }
  on(['faults', 'printed', 'made'], () => {
    // Half-typed texts are red in the editor at once, and here after a rest.
    clearTimeout(timer)
    const worse = model.faults.some((f) => f.severity === 'error')
    timer = window.setTimeout(build, worse ? 400 : 0)
  })
}

export function strip(host: HTMLElement, act: Actions, given: (host: HTMLElement) => GivenNumbers): void {
  const box = h('div', { class: 'numbers', role: 'group', 'aria-label': 'watched numbers' })
  const add = h('input', {
    type: 'text',
    placeholder: '+ number to watch',
    'aria-label': 'watch an expression',
    class: 'add',
    list: 'watchable',
    disabled: act.still,
  })
  const list = h('datalist', { id: 'watchable' })
  for (const [word, [, about]] of Object.entries(FIGURES)) list.append(h('option', { value: word, label: about }))
  const numbers = given(host)
  const setMark = h('button', { class: 'link', title: 'Changes are shown since this moment' }, 'Mark')
  host.append(box, add, list, setMark)
  let marked = new Map<string, number>()
  setMark.addEventListener('click', () => {
    marked = new Map(
      model.watched.filter((w) => typeof w.value === 'number').map((w) => [w.expression, w.value as number]),
    )
    act.say('Changes are shown since now')
    build()
  })
  add.addEventListener('keydown', (event) => {
    if (event.key !== 'Enter' || !add.value.trim()) return
    act.watch([...model.watched.map((w) => w.expression), add.value.trim()])
    add.value = ''
  })
  function build(): void {
    // A number that is dragged keeps its element.
    if (numbers.busy) return
    box.replaceChildren(
      ...model.watched.map((w) => {
        const was = marked.get(w.expression)
        const value = typeof w.value === 'number' ? w.value : null
        if (value !== null && was === undefined) marked.set(w.expression, value)
        const delta = value !== null && was !== undefined && value !== was ? value - was : 0
        const percent = was ? ` (${delta > 0 ? '+' : '−'}${shown(Math.abs((100 * delta) / was), 3)} %)` : ''
        return h(
          'span',
          {
            class: `number-box ${w.error ? 'bad' : ''}`,
            title: w.error ?? [w.expression, ...(figure(w.expression)?.slice(1) ?? [])].join(': '),
          },
          h('span', { class: 'key' }, w.expression.replace(/^(hydrostatics|mesh)\./, '')),
          value !== null && !act.still && model.params.length
            ? numbers.handle(w.expression, value)
            : h('span', { class: 'value mono' }, w.error ? '–' : shown(w.value)),
          !w.error && unitOf(w.expression) ? h('span', { class: 'unit' }, unitOf(w.expression)) : '',
          delta
            ? h(
                'span',
                { class: `delta ${delta > 0 ? 'up' : 'down'}` },
                `${delta > 0 ? '+' : '−'}${shown(Math.abs(delta), 3)}${percent}`,
              )
            : '',
          act.still
            ? ''
            : h(
                'button',
                {
                  class: 'icon',
                  'aria-label': `stop watching ${w.expression}`,
                  onclick: () => act.watch(model.watched.map((o) => o.expression).filter((e) => e !== w.expression)),
                },
                '×',
              ),
        )
      }),
    )
  }
  on('watched', build)
}

export { changed }
