// Analyses drawn over a shape: colours by numbers with their legend, combs of curves.

import { ink, ramp, type Scale } from './colour'
import { h, shown } from './dom'
import { type Link, Newest } from './link'
import { model } from './state'
import type { Paint, View } from './view'

/** Fields whose sign matters. */
const SIGNED = new Set(['gaussian_curvature', 'mean_curvature', 'largest_curvature', 'smallest_curvature'])

export interface AnalysisActions {
  say(words: string): void
  /** The choice of colours has changed. */
  painted(): void
  /** The colours of what else has a scale: its name too. */
  other(): { scale: Scale; name: string } | null
}

const end = (name: string, x: number) => h('span', { class: `mono ${name}` }, shown(x, 3))

export class Analysis {
  /** The field that colours show, and its parameter. */
  field = ''
  by = ''
  private readonly combs = new Set<string>()
  private readonly colouring = new Newest<void>(() => this.colour())
  private readonly combing = new Newest<void>(() => this.comb())

  constructor(
    private readonly view: View,
    private readonly link: Link,
    private readonly legendHost: HTMLElement,
    private readonly act: AnalysisActions,
  ) {}

  /** The scene has changed. */
  refresh(): void {
    if (this.field) this.colouring.push(undefined)
    if (this.combs.size) this.combing.push(undefined)
  }

  paint(paint: Paint, field = '', by = ''): void {
    const { view } = this
    view.paint = paint
    if (field !== this.field || by !== this.by) view.fixed = null
    ;[this.field, this.by] = [field, by]
    this.legend()
    if (field !== 'derivative') view.overlay('arrows', null)
    if (paint === 'field') this.colouring.push(undefined)
    view.settle()
    this.act.painted()
  }

  private async colour(): Promise<void> {
    const { view, field, by } = this
    if (!field) return
    try {
      const frame = await this.link.ask('field', by ? { field, by } : { field })
      view.field(frame, SIGNED.has(field))
      view.overlay('arrows', field === 'derivative' ? view.arrows() : null, ink('arrow'))
      this.legend()
    } catch (error) {
      this.act.say((error as Error).message)
    }
  }

  legend(): void {
    const { view, field } = this
    const name = field === 'derivative' ? `motion by ${this.by}` : field.replace('_', ' ')
    const found = view.paint === 'field' ? view.fieldScale && { scale: view.fieldScale, name } : this.act.other()
    this.legendHost.hidden = !found
    if (!found) return
    const { scale: s } = found
    const bar = h('div', { class: 'ramp' })
    bar.style.background = ramp(s.signed)
    this.legendHost.replaceChildren(
      h('span', { class: 'key' }, found.name),
      bar,
      ...(view.paint === 'field' ? this.ends(s) : [end('low', s.low), end('high', s.high)]),
    )
  }

  /** The ends of the scale as fields; an empty one gives back what nearly all values have. */
  private ends(s: Scale): HTMLElement[] {
    const { view } = this
    const one = (name: 'low' | 'high') => {
      const field = h('input', { type: 'text', class: `number ${name}`, 'aria-label': `${name} end of the scale` })
      field.value = shown(s[name], 4)
      field.addEventListener('change', () => {
        const typed = field.value.trim().replace('−', '-')
        const x = Number(typed)
        const other = name === 'low' ? s.high : s.low
        if (!typed) view.fixed = null
        else if (Number.isFinite(x) && x !== other) {
          const [low, high] = name === 'low' ? [x, other] : [other, x]
          view.fixed = { low: Math.min(low, high), high: Math.max(low, high) }
        } else this.act.say(`${typed} is no end of a scale whose other end is ${shown(other, 4)}`)
        this.colouring.push(undefined)
      })
      return field
    }
    return [one('low'), one('high')]
  }

  /** Shows or removes the comb of a curve. */
  toggleComb(name: string): void {
    const o = model.objects.find((k) => k.name === name)
    if (!o || !['curve', 'snake'].includes(o.class)) return this.act.say('Select a curve first')
    if (!this.combs.delete(o.name)) this.combs.add(o.name)
    if (this.combs.size) this.combing.push(undefined)
    else this.view.overlay('combs', null)
  }

  private async comb(): Promise<void> {
    const { view } = this
    const frame = await this.link.ask('combs', { names: [...this.combs] })
    const runs: number[][] = []
    const size = view.box.isEmpty() ? 1 : view.box.min.distanceTo(view.box.max)
    for (const comb of frame.head.combs ?? []) {
      const [p, b, k] = [frame.floats(comb.position), frame.floats(comb.bend), frame.floats(comb.curvature)]
      // One sharp place does not flatten all others.
      const most = [...k].sort((x, y) => x - y)[Math.floor(0.95 * (k.length - 1))] || 1
      const factor = (0.12 * size) / most
      const tips: number[] = []
      for (let j = 0; j < p.length; j += 3) {
        const share = Math.min(1, (2.5 * most) / Math.max(k[j / 3], 1e-30))
        const tip = [0, 1, 2].map((c) => p[j + c] - factor * share * b[j + c])
        tips.push(...tip)
        runs.push([p[j], p[j + 1], p[j + 2], ...tip])
      }
      runs.push(tips)
    }
    view.overlay('combs', runs, ink('comb'))
  }
}
