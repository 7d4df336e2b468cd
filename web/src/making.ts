// Making: an object of any kind from the registry's rows. Each argument is a line of text; what is picked in the picture
// or in the list of objects is written there. The engine writes the statement where it belongs.

import type { Vector3 } from 'three'
import { h } from './dom'
import type {} from './editor'
import type { Link } from './link'
import type { ArgumentFact, EditFact, KindFact } from './protocol'
import { model, on } from './state'

interface Kind extends KindFact {
  /** For a function or an operator: the kind that names its value. */
  made?: 'Set' | 'Field'
  /** What is written between the arguments of an operator. */
  operator?: string
}

export interface MakingActions {
  say(words: string): void
  select(name: string): void
  apply(edits: EditFact[], version: number, name: string): void
  /** Settles when the engine has all that was typed. */
  synced(): Promise<void>
}

/** Classes of arguments that are typed and not picked. */
const TYPED = ['number', 'integer', 'text', 'numbers', 'vectors', 'any']
/** First letters of new names. */
const STEMS: Record<string, string> = {
  point: 'P',
  bead: 'b',
  magnet: 'm',
  ring: 'r',
  curve: 'c',
  snake: 'n',
  surface: 's',
  solid: 'body',
  plane: 'plane',
  frame: 'frame',
  set: 'part',
  field: 'f',
  mesh: 'mesh',
}
const GROUPS = [
  'parameter',
  'point',
  'curve',
  'surface',
  'bead',
  'magnet',
  'ring',
  'snake',
  'plane',
  'solid',
  'mesh',
  'set',
  'field',
  'block',
]
const PARAMETER: Kind = {
  name: 'param',
  class: 'parameter',
  about: 'A number with a slider.',
  also: 'parameter variable slider',
  fields: ['value', 'least', 'largest'].map((name) => ({
    name,
    help: '',
    class: 'number',
    accepts: [],
    many: false,
    least: 0,
    required: name === 'value',
    default: null,
    words: [],
  })),
}

/** The operators of sets: name, what is written between the sets, what it is. */
const OPERATORS: [string, string, string][] = [
  ['union', ' | ', 'What is in any of the sets.'],
  ['intersection', ' & ', 'What is in all of the sets.'],
  ['difference', ' - ', 'What is in the first set and in none of the others.'],
]

/** The operands that are written in a field. */
const sets = (text: string) =>
  text
    .split(',')
    .map((t) => t.trim())
    .filter(Boolean)

const operators = (accepts: string[]): Kind[] =>
  OPERATORS.map(([name, operator, about]) => ({
    name,
    class: 'set',
    made: 'Set',
    operator,
    about,
    also: 'boolean set combine solid',
    fields: [
      {
        ...PARAMETER.fields[0],
        name: 'sets',
        help: `${about} In this order.`,
        class: 'set',
        accepts,
        many: true,
        least: 2,
      },
    ],
  }))

/** The kinds of the engine, and beside them the operators and functions whose values have a name of their own. */
export function rowsOf(kinds: Kind[], functions: Kind[]): Kind[] {
  // What a class of arguments accepts is stated by the kinds.
  const accepts = new Map(kinds.flatMap((k) => k.fields).map((f) => [f.class, f.accepts]))
  const complete = (k: Kind): Kind => ({
    ...k,
    fields: k.fields.map((f) => ({ ...f, accepts: accepts.get(f.class) ?? [] })),
  })
  return [PARAMETER, ...kinds, ...operators(accepts.get('set') ?? ['set']), ...functions.map(complete)]
}

export class Making {
  private kinds: Kind[] = []
  private kind: Kind | null = null
  /** The field that is given what is picked. */
  private active: ArgumentFact | null = null
  private adding: Promise<void> = Promise.resolve()
  /** Names of objects that are being added. */
  private readonly coming = new Set<string>()
  private inputs = new Map<string, HTMLInputElement | HTMLSelectElement>()
  private readonly panel = h('section', { class: 'making', 'aria-label': 'add an object', hidden: true })
  private readonly fault = h('p', { class: 'bad', role: 'alert', hidden: true })
  private named = h('input', { type: 'text' })

  constructor(
    host: HTMLElement,
    private readonly link: Link,
    private readonly act: MakingActions,
  ) {
    host.prepend(this.panel)
    on('objects', () => {
      for (const { name } of model.objects) this.coming.delete(name)
    })
    this.panel.addEventListener('keydown', (e) => {
      if (e.key === 'Escape') this.close()
      else if (e.key === 'Enter' && this.kind && e.target instanceof HTMLInputElement) void this.add()
      else return
      e.stopPropagation()
      e.preventDefault()
    })
  }

  get isOpen(): boolean {
    return !this.panel.hidden
  }

  async rows(): Promise<Kind[]> {
    if (!this.kinds.length) {
      const { kinds } = (await this.link.ask('kinds')).head
      // A page in a file has no list of functions.
      const functions = this.link.local ? [] : (await this.link.ask('functions')).head.functions
      this.kinds = rowsOf(kinds, functions)
    }
    return this.kinds
  }

  close(): void {
    this.panel.hidden = true
    this.kind = this.active = null
  }

  /** The list of kinds, or the form of one. */
  async open(name = ''): Promise<void> {
    try {
      await this.rows()
    } catch (error) {
      return this.act.say((error as Error).message)
    }
    this.panel.hidden = false
    const kind = this.kinds.find((k) => k.name === name)
    if (kind) this.form(kind)
    else this.list()
  }

  private heading(words: string, ...more: HTMLElement[]): HTMLElement {
    return h(
      'header',
      {},
      h('strong', {}, words),
      ...more,
      h('span', { class: 'grow' }),
      h('button', { class: 'icon', 'aria-label': 'close', onclick: () => this.close() }, '×'),
    )
  }

  private list(): void {
    this.kind = this.active = null
    const search = h('input', { type: 'search', placeholder: 'Search kinds', 'aria-label': 'search kinds' })
    const rows = h('div', { class: 'kinds', role: 'group', 'aria-label': 'kinds' })
    const order = (k: Kind) => (GROUPS.includes(k.class) ? GROUPS.indexOf(k.class) : GROUPS.length)
    const build = () => {
      const words = search.value.toLowerCase().split(/\s+/).filter(Boolean)
      const found = this.kinds.filter((k) =>
        words.every((w) => `${k.name} ${k.class} ${k.about} ${k.also}`.toLowerCase().includes(w)),
      )
      const nearness = (k: Kind) => {
        const [name, word] = [k.name.toLowerCase(), words.join('')]
        // `Intersection` is a curve, `intersection` an operator of sets.
        if (k.name === search.value.trim()) return -1
        return !word || name === word ? 0 : name.startsWith(word) ? 1 : name.includes(word) ? 2 : 3
      }
      found.sort((a, b) => nearness(a) - nearness(b) || order(a) - order(b))
      rows.replaceChildren(
        ...found.map((k) =>
          h(
            'button',
            { title: k.about, onclick: () => this.form(k) },
            h('span', {}, k.made ? `${k.name} (${k.made.toLowerCase()})` : k.name),
            h('span', { class: 'quiet' }, k.about),
          ),
        ),
      )
    }
    search.addEventListener('input', build)
    search.addEventListener('keydown', (e) => {
      if (e.key !== 'Enter') return
      e.stopPropagation()
      rows.querySelector('button')?.click()
    })
    build()
    this.panel.replaceChildren(this.heading('Add'), search, rows)
    search.focus()
  }

  /** Objects that an argument may be. */
  private takes(field: ArgumentFact): boolean {
    return field.accepts.some((c) => !TYPED.includes(c))
  }

  private free(kind: Kind): string {
    const stem = STEMS[kind.class] ?? kind.name.toLowerCase()
    const taken = new Set([...model.objects.map((o) => o.name), ...model.params.map((p) => p.name), ...this.coming])
    for (let k = 1; ; k++) if (!taken.has(`${stem}${k}`)) return `${stem}${k}`
  }

  private form(kind: Kind, chosen = ''): void {
    this.kind = kind
    this.inputs.clear()
    this.fault.hidden = true
    this.named = h('input', { type: 'text', 'aria-label': 'name', spellcheck: 'false' })
    this.named.value = this.free(kind)
    const row = (f: ArgumentFact) => {
      const words = f.words.length > 1 ? f.words : []
      const input = words.length
        ? h(
            'select',
            { 'aria-label': f.name },
            h('option', { value: '' }, f.default === null ? '' : `${f.default}`),
            ...words.map((w) => h('option', { value: w }, w)),
          )
        : h('input', {
            type: 'text',
            'aria-label': f.name,
            spellcheck: 'false',
            placeholder:
              f.default === null
                ? this.takes(f)
                  ? `pick ${f.many ? 'several' : f.class}`
                  : f.class
                : String(f.default),
          })
      input.addEventListener('focus', () => this.activate(f))
      this.inputs.set(f.name, input)
      return h(
        'label',
        { class: 'fact', title: f.help, 'data-field': f.name },
        h('span', { class: 'key' }, f.name),
        input,
      )
    }
    const needed = kind.fields.filter((f) => f.required || kind === PARAMETER)
    const others = kind.fields.filter((f) => !needed.includes(f))
    this.panel.replaceChildren(
      this.heading(kind.name, h('button', { class: 'link', onclick: () => this.list() }, 'other kinds')),
      h('p', { class: 'quiet' }, kind.about),
      h('label', { class: 'fact' }, h('span', { class: 'key' }, 'name'), this.named),
      ...needed.map(row),
      ...(others.length ? [h('details', {}, h('summary', {}, `Options (${others.length})`), ...others.map(row))] : []),
      this.fault,
      h(
        'div',
        { class: 'buttons' },
        h('button', { class: 'primary', onclick: () => void this.add() }, 'Add'),
        this.places() ? h('span', { class: 'quiet' }, 'or click in the picture') : '',
      ),
    )
    const first = needed.find((f) => this.takes(f)) ?? needed[0] ?? null
    if (first) this.activate(first)
    if (chosen) this.pick(chosen)
    this.inputs.get(first?.name ?? '')?.focus()
  }

  private activate(field: ArgumentFact): void {
    this.active = field
    for (const row of this.panel.querySelectorAll<HTMLElement>('[data-field]'))
      row.classList.toggle('active', row.dataset.field === field.name)
    if (this.takes(field)) this.act.say(`${field.name}: ${field.help} Pick in the picture or the list of objects.`)
  }

  /** True when the form takes coordinates from a click. */
  private places(): boolean {
    const names =
      this.kind?.fields
        .filter((f) => f.required)
        .map((f) => f.name)
        .join() ?? ''
    return names === 'x,y,z'
  }

  /** Writes an object that was picked into the active argument; false when it is not wanted there. */
  pick(name: string): boolean {
    if (!this.isOpen || !this.kind || !this.active || !name) return false
    const of = model.objects.find((o) => o.name === name)?.class ?? ''
    const input = this.inputs.get(this.active.name)
    if (!input || !this.takes(this.active)) return false
    if (!this.active.accepts.includes(of)) {
      this.act.say(
        `${name} is a ${of}; ${this.active.name} takes ${this.active.accepts.filter((c) => !TYPED.includes(c)).join(', ')}`,
      )
      return true
    }
    if (this.active.many) {
      const items = input.value
        .split(',')
        .map((t) => t.trim())
        .filter(Boolean)
      // Picked again, it is taken out.
      input.value = (items.includes(name) ? items.filter((i) => i !== name) : [...items, name]).join(', ')
    } else {
      input.value = name
      const next = this.kind.fields.find((f) => f.required && this.takes(f) && !this.inputs.get(f.name)?.value)
      if (next) this.activate(next)
    }
    return true
  }

  /** A place that was clicked: a point is made there. */
  async place(at: Vector3, grain: number): Promise<boolean> {
    if (!this.isOpen || !this.places()) return false
    const digits = Math.max(0, Math.min(12, Math.ceil(-Math.log10(grain || 1))))
    at.toArray().forEach((x, k) => (this.inputs.get('xyz'[k])!.value = String(Number(x.toFixed(digits)) + 0)))
    await this.add()
    return true
  }

  private spelled(f: ArgumentFact): string {
    const text = this.inputs.get(f.name)!.value.trim()
    if (!text) return ''
    if (f.class === 'text' && !text.startsWith('"')) return `"${text}"`
    // The name of all objects of a loop is a list by itself.
    const list = text.startsWith('{') || (/^\w+$/.test(text) && !model.objects.some((o) => o.name === text))
    return f.many && !list ? `{${text}}` : text
  }

  /** The statement as the form has it; an error names what is missing. */
  private statement(kind: Kind): string {
    const name = this.named.value.trim()
    if (kind === PARAMETER) {
      const [value, least, largest] = kind.fields.map((f) => this.spelled(f))
      return `param float ${name} = ${value || 0}${least && largest ? ` in [${least}, ${largest}]` : ''};`
    }
    const few = (f: ArgumentFact) =>
      f.least > 1 && sets(this.inputs.get(f.name)!.value).length < f.least && kind.operator
    const missing = kind.fields.find((f) => (f.required && !this.spelled(f)) || few(f))
    if (missing)
      throw new Error(`${missing.name} is missing: ${few(missing) ? `at least ${missing.least}. ` : ''}${missing.help}`)
    let positional = true
    const given = kind.fields.flatMap((f) => {
      const text = this.spelled(f)
      if (!text) {
        positional = false
        return []
      }
      return positional && f.required ? text : `${f.name} = ${text}`
    })
    if (kind.operator) return `${kind.made} ${name}(${sets(this.inputs.get('sets')!.value).join(kind.operator)});`
    const call = `(${given.join(', ')})`
    return kind.made ? `${kind.made} ${name}(${kind.name}${call});` : `${kind.name} ${name}${call};`
  }

  /** Writes the object of the form; what is typed from now on is the next one's. */
  private add(): Promise<void> {
    const { kind } = this
    if (!kind) return this.adding
    let statement: string
    try {
      statement = this.statement(kind)
    } catch (error) {
      this.refuse((error as Error).message)
      return this.adding
    }
    const name = this.named.value.trim()
    const given = [...this.inputs].map(([field, input]): [string, string] => [field, input.value])
    this.coming.add(name)
    this.form(kind)
    const next = this.named
    // One after the other: the engine has each before the next.
    this.adding = this.adding.then(() => this.added(statement, name, given, next))
    return this.adding
  }

  private refuse(words: string): void {
    this.fault.textContent = words
    this.fault.hidden = false
    this.act.say(words)
  }

  private async added(
    statement: string,
    name: string,
    given: [string, string][],
    next: HTMLInputElement,
  ): Promise<void> {
    try {
      await this.act.synced()
      const { head } = await this.link.ask('add', { statement })
      this.act.apply(head.edits ?? [], head.version, `Add ${name}`)
      await this.act.synced()
      if (this.named === next) this.act.select(name)
      this.act.say(`${statement} was added`)
    } catch (error) {
      this.coming.delete(name)
      // It is in the form again, to be mended, unless another one is begun there.
      if (this.named === next && [...this.inputs.values()].every((input) => !input.value)) {
        next.value = name
        for (const [field, value] of given) this.inputs.get(field)!.value = value
      }
      this.refuse((error as Error).message)
    }
  }
}
