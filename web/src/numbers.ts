// Numbers that are given: a watched number is typed or dragged, and chosen parameters follow by the least change.

import { h, shown, store, stored } from './dom'
import { Newest, Refused } from './link'
import type { Preview } from './preview'
import { model } from './state'

interface Adjustment {
  name: string
  before: number
  after: number
  share: number
}

export interface NumberActions {
  say(words: string): void
  write(values: Record<string, number>, name?: string): Promise<void>
  typed(text: string): Promise<number>
  /** Takes back what was set and not written. */
  reset(): Promise<void>
  /** Shows what was there before, while the hand moves. */
  ghost(on: boolean): void
}

/** A drag over this many picture points is as much as the number itself. */
const POINTS = 400

export class GivenNumbers {
  private readonly panel = h('div', { class: 'given', role: 'group', 'aria-label': 'give a value', hidden: true })
  private readonly paid = h('div', { class: 'paid', 'aria-live': 'polite' })
  private expression = ''
  private begin = 0
  private reached = 0
  private homes: Record<string, number> = {}
  private found: Adjustment[] = []
  private readonly asking: Newest<number>

  constructor(
    host: HTMLElement,
    private readonly preview: Preview,
    private readonly act: NumberActions,
  ) {
    host.append(this.panel)
    this.asking = new Newest(async (value) => {
      try {
        const weights = this.weights
        const by = Object.fromEntries(
          Object.entries(this.homes).map(([name, home]) => [name, { home, weight: weights[name] ?? 1 }]),
        )
        const { head } = await this.preview.ask('solve_for', {
          targets: { ...this.held(), [this.expression]: value },
          by,
        })
        this.found = head.adjustments
        const reached = new Map<string, number>(head.reached)
        this.reached = reached.get(this.expression) ?? value
        if (this.dragged) this.dragged.textContent = shown(this.reached)
        this.pay('')
      } catch (error) {
        if (error instanceof Refused && error.message !== 'superseded') this.pay(error.message)
      }
    })
    addEventListener('pointerdown', (e) => {
      if (!this.panel.hidden && !this.panel.contains(e.target as Node)) this.panel.hidden = true
    })
    this.panel.addEventListener('keydown', (e) => {
      if (e.key !== 'Escape') return
      e.stopPropagation()
      this.panel.hidden = true
    })
  }

  /** The value of a watched number, as what is dragged and opened. */
  handle(expression: string, value: number): HTMLElement {
    const button = h(
      'button',
      {
        class: 'value mono give',
        'aria-label': `${shown(value)}, give ${expression} a value`,
        title: 'Drag, or click to type a value: parameters follow',
      },
      shown(value),
    )
    let from: number | null = null
    let moved = false
    button.addEventListener('pointerdown', (e) => {
      if (e.button !== 0) return
      button.setPointerCapture(e.pointerId)
      ;[from, moved] = [e.clientX, false]
    })
    button.addEventListener('pointermove', (e) => {
      if (from === null || (!moved && Math.abs(e.clientX - from) < 4)) return
      if (!moved) {
        this.start(expression, value)
        this.act.ghost(true)
      }
      moved = true
      this.dragged = button
      this.asking.push(
        this.begin + ((e.clientX - from) / POINTS) * (Math.abs(this.begin) || 1) * (e.shiftKey ? 0.1 : 1),
      )
    })
    button.addEventListener('pointerup', () => {
      this.dragged = null
      this.act.ghost(false)
      if (from !== null) moved ? void this.finish() : this.open(button, expression, value)
      from = null
    })
    button.addEventListener('pointercancel', () => {
      this.dragged = null
      this.act.ghost(false)
      if (from !== null && moved) void this.cancel()
      from = null
    })
    button.addEventListener('keydown', (e) => {
      if (e.key !== 'Enter' && e.key !== ' ') return
      e.preventDefault()
      this.open(button, expression, value)
    })
    return button
  }

  /** The element that is dragged, and its number. */
  private dragged: HTMLElement | null = null

  get busy(): boolean {
    return this.dragged !== null
  }

  private get free(): string[] {
    return model.params.filter((p) => !p.whole && p.written).map((p) => p.name)
  }

  private get chosen(): string[] {
    const free = this.free
    const kept = stored<string[]>(`given.${model.name}`, free).filter((n) => free.includes(n))
    return kept.length ? kept : free
  }

  /** Weights of the parameters' changes over their ranges, where they are not 1. */
  private get weights(): Record<string, number> {
    return stored<Record<string, number>>(`weights.${model.name}`, {})
  }

  private weighing(name: string): HTMLElement {
    const field = h('input', {
      type: 'text',
      class: 'number weight',
      inputmode: 'decimal',
      'aria-label': `weight of ${name}`,
      title: 'Weight: twice as much changes it less',
    })
    const shownNow = () => (field.value = shown(this.weights[name] ?? 1))
    shownNow()
    field.addEventListener('change', () => {
      const weight = Number(field.value.replace(',', '.'))
      if (!(weight > 0 && weight < Infinity)) this.act.say(`${name}: expected a weight above 0, found ${field.value}`)
      else store(`weights.${model.name}`, { ...this.weights, [name]: weight })
      shownNow()
    })
    return field
  }

  /** The other watched numbers that stay as they are. */
  private held(): Record<string, number> {
    const names = stored<string[]>(`held.${model.name}`, [])
    return Object.fromEntries(
      names.filter((n) => n !== this.expression && n in this.heldValues).map((n) => [n, this.heldValues[n]]),
    )
  }
  private heldValues: Record<string, number> = {}

  private start(expression: string, value: number): void {
    this.expression = expression
    this.begin = value
    this.found = []
    const chosen = this.chosen
    this.homes = Object.fromEntries(model.params.filter((p) => chosen.includes(p.name)).map((p) => [p.name, p.value]))
    this.heldValues = Object.fromEntries(
      model.watched.filter((w) => typeof w.value === 'number').map((w) => [w.expression, w.value as number]),
    )
  }

  /** Which parameters pay, and how much. */
  private pay(refused: string): void {
    const rows = this.found.filter((a) => a.after !== a.before).sort((a, b) => b.share - a.share)
    const words = rows.map((a) => `${a.name} ${shown(a.before)} → ${shown(a.after)} (${Math.round(100 * a.share)} %)`)
    this.paid.replaceChildren(
      ...(refused ? [h('p', { class: 'bad' }, refused)] : []),
      ...words.map((w) => h('div', {}, w)),
    )
    this.act.say(refused || words.join('   '))
  }

  private async finish(): Promise<void> {
    await this.asking.settled()
    const values = Object.fromEntries(this.found.filter((a) => a.after !== a.before).map((a) => [a.name, a.after]))
    if (!Object.keys(values).length) return this.cancel()
    await this.act.write(values, `${this.expression}: ${shown(this.begin)} → ${shown(this.reached)}`)
  }

  private async cancel(): Promise<void> {
    await this.asking.settled()
    await this.act.reset()
  }

  private open(beside: HTMLElement, expression: string, value: number): void {
    const field = h('input', { type: 'text', class: 'number', 'aria-label': `value of ${expression}` })
    field.value = shown(value, 9)
    const boxes = (key: string, all: string[], on: string[], beside: (name: string) => HTMLElement | '' = () => '') => {
      const list = all.map((name) => {
        const box = h('input', { type: 'checkbox', checked: on.includes(name) })
        box.addEventListener('change', () =>
          store(
            `${key}.${model.name}`,
            list.filter((l) => l.box.checked).map((l) => l.name),
          ),
        )
        return { name, box, row: h('div', { class: 'choice' }, h('label', {}, box, name), beside(name)) }
      })
      return h('div', { class: 'choices' }, ...list.map((l) => l.row))
    }
    const give = async () => {
      try {
        this.start(expression, value)
        this.asking.push(await this.act.typed(field.value))
        await this.asking.settled()
        if (this.found.length) await this.finish()
      } catch (error) {
        this.act.say((error as Error).message)
      }
    }
    field.addEventListener('keydown', (e) => e.key === 'Enter' && void give())
    const others = model.watched.map((w) => w.expression).filter((e) => e !== expression)
    this.paid.replaceChildren()
    this.panel.replaceChildren(
      h('h3', {}, expression),
      h('div', { class: 'fact' }, field, h('button', { class: 'primary', onclick: () => void give() }, 'Give')),
      h('h3', {}, 'May change', h('span', { class: 'quiet' }, 'weight')),
      boxes('given', this.free, this.chosen, (name) => this.weighing(name)),
      ...(others.length
        ? [h('h3', {}, 'Stays'), boxes('held', others, stored<string[]>(`held.${model.name}`, []))]
        : []),
      this.paid,
    )
    const box = beside.getBoundingClientRect()
    this.panel.style.left = `${Math.max(8, Math.min(box.left, innerWidth - 300))}px`
    this.panel.hidden = false
    field.select()
  }
}
