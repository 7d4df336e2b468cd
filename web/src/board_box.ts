// The box of a dimension at its place: a value, an expression, or Enter for what the picture suggests.

import type { Mark, Page } from './board_paint'
import { h, shown } from './dom'

/** Decades that the slider spans each way. */
const SPAN = 0.6

export interface BoxActions {
  commit(mark: Mark, value: string): void
  leave(): void
  next(step: number): boolean
  /** The box is closed; true when values were tried. */
  closed(tried: boolean): void
  /** A value that is tried: the solid has it while the slider moves. */
  tried(mark: Mark, value: string): void
}

export class BoardBox {
  readonly element = h('div', { class: 'board-box', hidden: true })
  mark: Mark | null = null
  private readonly input = h('input', { type: 'text', spellcheck: 'false', autocomplete: 'off', inputmode: 'decimal' })
  private readonly label = h('span', { class: 'what' })
  /** A depth that nothing determines, in decades from what the picture suggests. */
  private readonly slider = h('input', { type: 'range', min: -SPAN, max: SPAN, step: 0.005 })
  private readonly axis = h('select', { 'aria-label': 'axis' })
  private tried = false
  private own: ((value: string) => void) | null = null

  constructor(
    private readonly page: Page,
    private readonly act: BoxActions,
  ) {
    this.element.append(this.label, this.axis, this.input, this.slider)
    this.input.addEventListener('keydown', (e) => this.key(e))
    this.input.addEventListener('input', () => this.element.classList.remove('refused'))
    this.slider.addEventListener('input', () => {
      this.input.value = this.slid()
      if (!this.mark) return
      this.tried = true
      this.act.tried(this.mark, this.input.value)
    })
    this.slider.addEventListener('change', () => this.mark && this.act.commit(this.mark, this.slid()))
    this.slider.addEventListener('keydown', (e) => e.stopPropagation())
    this.axis.addEventListener('change', () => {
      if (this.mark) this.mark.axis = this.axis.value
      this.input.focus()
    })
  }

  open(
    mark: Mark,
    missing: boolean,
    begun = '',
    axes: string[] = [],
    own: ((value: string) => void) | null = null,
  ): void {
    this.mark = { ...mark }
    this.own = own
    const words = own ? mark.text : missing ? `${mark.axis} ${mark.p} → ${mark.q}` : mark.name
    this.label.textContent = words
    this.axis.hidden = axes.length < 2
    this.axis.replaceChildren(...axes.map((a) => h('option', { value: a }, a)))
    this.input.setAttribute(
      'aria-label',
      missing && !own
        ? `distance along ${mark.axis} from point ${mark.p} to ${mark.q}`
        : own
          ? mark.text
          : `value of ${mark.name}`,
    )
    this.input.placeholder = missing && mark.value !== null ? `≈ ${shown(mark.value, 3)}` : ''
    this.input.value = begun || (missing || mark.value === null ? '' : String(mark.value))
    const open = missing && !own && mark.p !== undefined && !!mark.value
    this.slider.hidden = !open
    this.slider.value = '0'
    if (open) this.slider.setAttribute('aria-label', `depth along ${mark.axis} from point ${mark.p} to ${mark.q}`)
    this.element.hidden = false
    this.element.classList.remove('refused')
    this.place()
    this.input.focus({ preventScroll: true })
    if (begun) this.input.setSelectionRange(begun.length, begun.length)
    else this.input.select()
  }

  /** The value of the slider, to three digits. */
  private slid(): string {
    return String(Number(((this.mark?.value ?? 1) * 10 ** Number(this.slider.value)).toPrecision(3)))
  }

  place(): void {
    if (!this.mark) return
    const [x, y] = this.page.to(this.mark.at)
    const [w, t] = this.page.size
    this.element.style.left = `${Math.max(70, Math.min(w - 90, x))}px`
    this.element.style.top = `${Math.max(16, Math.min(t - 20, y))}px`
  }

  /** What was typed is not taken: it stays, to be mended. */
  refuse(): void {
    this.element.classList.add('refused')
    this.input.focus()
    this.input.select()
  }

  close(): void {
    this.mark = null
    this.own = null
    this.element.hidden = true
    this.act.closed(this.tried)
    this.tried = false
  }

  private key(e: KeyboardEvent): void {
    e.stopPropagation()
    if (!this.mark) return
    if (e.key === 'Escape') {
      this.close()
      this.act.leave()
    } else if (e.key === 'Tab') {
      if (this.own || this.mark.p === undefined || !this.mark.name) return
      e.preventDefault()
      this.act.next(e.shiftKey ? -1 : 1)
    } else if (e.key === 'Enter') {
      e.preventDefault()
      const typed = this.input.value.trim().replace(/^(\d+),(\d+)$/, '$1.$2')
      const value =
        typed ||
        (this.mark.p !== undefined && this.mark.value !== null ? String(Number(this.mark.value.toPrecision(3))) : '')
      if (!value) return this.refuse()
      if (this.own) this.own(value)
      else this.act.commit(this.mark, value)
    }
  }
}
