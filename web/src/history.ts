// One history of all that a hand changes: typing, slides, drags, forms, reverts; in all texts of the model.
//
// Each step is a step of a text's own history, because each becomes text; what it changes besides, a value that the
// text does not state, travels with it as an effect.

import { history, invertedEffects, isolateHistory, redo, redoDepth, undo, undoDepth } from '@codemirror/commands'
import { Annotation, type Extension, StateEffect, StateField, Transaction } from '@codemirror/state'
import type { EditorView, ViewUpdate } from '@codemirror/view'
import { h } from './dom'
import { icon } from './icons'

/** What a step is called in the list. */
export const called = Annotation.define<string>()

/** Whether a change belongs to the step before it, which is in another text. */
const joins = Annotation.define<boolean>()

/** A value of a parameter that the text computes from others: null is that of the text. */
export interface Held {
  name: string
  from: number | null
  to: number | null
}
export const holding = StateEffect.define<Held>()

const MOST_STEPS = 2000

const deletes = (tr: Transaction) => tr.isUserEvent('delete')

/** Whether the text was last changed by a deletion. */
const deleted = StateField.define<boolean>({
  create: () => false,
  update: (was, tr) => (tr.docChanged ? deletes(tr) : was),
})

/** The extension of an editor that keeps the steps. */
export function keptSteps(): Extension {
  return [
    deleted,
    // Typing and deletion are steps of their own: together they might come to nothing, and such a step cannot be redone.
    history({
      minDepth: MOST_STEPS,
      joinToEvent: (tr, adjacent) => adjacent && deletes(tr) === tr.startState.field(deleted),
    }),
    invertedEffects.of((tr) =>
      tr.effects
        .filter((e) => e.is(holding))
        .map((e) => holding.of({ name: e.value.name, from: e.value.to, to: e.value.from })),
    ),
  ]
}

/** Annotation after which a step begins, as after saving. */
export const stepEnds = isolateHistory.of('full')

/** Annotations of a step of its own. */
export const stepOf = (name: string, joined = false) => [stepEnds, called.of(name), joins.of(joined)]

function word(tr: Transaction): string {
  const given = tr.annotation(called)
  if (given) return given
  let line = 1
  tr.changes.iterChangedRanges((_a, _b, from) => (line = tr.newDoc.lineAt(from).number))
  const what = tr.isUserEvent('delete')
    ? 'Deletion'
    : tr.isUserEvent('input.paste')
      ? 'Paste'
      : tr.isUserEvent('input.type')
        ? 'Typing'
        : 'Edit'
  return `${what}, line ${line}`
}

/** A step of a room that keeps a log of its own. */
export interface LogStep {
  name: string
  back(): void
  again(): void
}

/** A step, and the text that it is in, if it is one of a text. */
type Step = ({ name: string; of: EditorView } | (LogStep & { of: null })) & { joined: boolean }

const names = (list: Step[]) => list.filter((s) => !s.joined).map((s) => s.name)

const count = (list: Step[], of: EditorView) => list.filter((s) => s.of === of).length

/** Drops the first steps of a text. */
function drop(list: Step[], of: EditorView, many: number): void {
  for (let k = 0; many > 0 && k < list.length; )
    if (list[k].of === of) {
      list.splice(k, 1)
      many--
    } else k++
}

/** The steps in their order over all texts, beside the record that each text has of its own. */
export class Steps {
  private readonly past: Step[] = []
  private readonly ahead: Step[] = []
  onChange: () => void = () => {}
  /** The text is another one, whoever changed it. */
  onText: () => void = () => {}
  /** True when the last step taken back or done again changed nothing, such as a word that an input method took back. */
  private idle = false
  /** A value that is held goes with a step that was taken back or done again. */
  onHeld: (held: Held) => void = () => {}
  /** A step of this text was taken back or done again. */
  onTurned: (of: EditorView) => void = () => {}

  /** Whether a text has steps. */
  has(of: EditorView): boolean {
    return count(this.past, of) + count(this.ahead, of) > 0
  }

  /** The names of the steps, the last one last. */
  get done(): string[] {
    return names(this.past)
  }

  /** The names of those that were taken back, the next one last. */
  get undone(): string[] {
    return names(this.ahead)
  }

  follow(update: ViewUpdate): void {
    if (!update.transactions.length) return
    const of = update.view
    if (update.docChanged) this.onText()
    let [name, joined] = ['Edit', false]
    for (const tr of update.transactions) {
      const back = tr.isUserEvent('undo')
      if (back || tr.isUserEvent('redo')) {
        const list = back ? this.past : this.ahead
        const [step] = list.splice(
          list.findLastIndex((s) => s.of === of),
          count(list, of) && 1,
        )
        this.idle = !tr.docChanged && !tr.effects.some((e) => e.is(holding))
        if (step !== undefined && !this.idle) (back ? this.ahead : this.past).push(step)
        for (const e of tr.effects) if (e.is(holding)) this.onHeld(e.value)
      } else if (tr.docChanged || tr.effects.some((e) => e.is(holding))) {
        name = word(tr)
        joined = tr.annotation(joins) ?? false
        // What was taken back of any text cannot be done again after a change of one.
        if (tr.annotation(Transaction.addToHistory) !== false) this.ahead.length = 0
      }
    }
    while (count(this.past, of) < undoDepth(update.state)) {
      if (this.past.at(-1)?.of !== of) this.end()
      this.past.push({ name, of, joined })
    }
    drop(this.past, of, count(this.past, of) - undoDepth(update.state))
    drop(this.ahead, of, count(this.ahead, of) - redoDepth(update.state))
    this.onChange()
  }

  /** Text that is typed from now on comes after the last step. */
  private end(): void {
    this.past.at(-1)?.of?.dispatch({ annotations: stepEnds })
  }

  /** A step of a log, after which none that was taken back can be done again. */
  add(step: LogStep): void {
    this.end()
    this.ahead.length = 0
    this.past.push({ ...step, of: null, joined: false })
    this.onChange()
  }

  /** Takes steps back, or does them again when the count is negative; how many there were. A single one changes something. */
  go(many: number): number {
    const single = Math.abs(many) === 1
    let gone = 0
    while (gone < Math.abs(many)) {
      const [from, to] = many > 0 ? [this.past, this.ahead] : [this.ahead, this.past]
      const step = from.at(-1)
      if (step?.of === null) {
        to.push(...from.splice(-1))
        if (many > 0) step.back()
        else step.again()
        this.onChange()
        if (many > 0 || !this.ahead.at(-1)?.joined) gone++
        continue
      }
      if (!step || !(many > 0 ? undo : redo)(step.of)) break
      this.onTurned(step.of)
      const within = many > 0 ? step.joined : this.ahead.at(-1)?.joined
      if (!within && !(single && this.idle)) gone++
    }
    return gone
  }
}

/** Buttons and the list. `go` takes that many steps back, or does them again when it is negative. */
export function historyButtons(steps: Steps, go: (count: number) => void, listed: boolean): HTMLElement {
  const back = h('button', { class: 'icon', 'aria-label': 'undo', onclick: () => go(1) }, icon('undo'))
  const again = h('button', { class: 'icon', 'aria-label': 'redo', onclick: () => go(-1) }, icon('redo'))
  const open = h(
    'button',
    {
      class: 'icon',
      'aria-label': 'history',
      title: 'History',
      'aria-expanded': false,
      'aria-haspopup': 'true',
      onclick: () => show(!!list.hidden),
    },
    '▾',
  )
  const list = h('div', { class: 'history', role: 'group', 'aria-label': 'steps', hidden: true })
  const box = h('div', { class: 'steps' }, back, again, listed ? open : '', list)
  function show(on: boolean): void {
    list.hidden = !on
    open.setAttribute('aria-expanded', String(on))
    if (on) build()
  }
  function build(): void {
    // An editor around the page has its own history, which is not known here.
    const [last, next] = listed ? [steps.done.at(-1), steps.undone.at(-1)] : []
    back.disabled = listed && last === undefined
    again.disabled = listed && next === undefined
    back.title = last ? `Undo: ${last} (Ctrl+Z)` : 'Undo (Ctrl+Z)'
    again.title = next ? `Redo: ${next} (Ctrl+Shift+Z)` : 'Redo (Ctrl+Shift+Z)'
    if (list.hidden) return
    const row = (name: string, count: number, state: string) =>
      h(
        'button',
        { class: state, onclick: () => (count ? go(count) : undefined), 'aria-current': count === 0 ? 'step' : null },
        name,
      )
    const later = steps.undone.map((name, k) => row(name, k - steps.undone.length, 'undone'))
    const before = steps.done
      .map((name, k) => row(name, steps.done.length - 1 - k, k === steps.done.length - 1 ? 'now' : ''))
      .reverse()
    // The focus stays in the list that it came from: Escape closes that.
    const within = list.contains(document.activeElement)
    list.replaceChildren(...later, ...before, row('As opened', steps.done.length, steps.done.length ? '' : 'now'))
    const now = list.querySelector<HTMLElement>('.now')
    now?.scrollIntoView({ block: 'nearest' })
    if (within) now?.focus({ preventScroll: true })
  }
  addEventListener('pointerdown', (e) => {
    if (!list.hidden && !box.contains(e.target as Node)) show(false)
  })
  box.addEventListener('keydown', (e) => {
    if (e.key !== 'Escape' || list.hidden) return
    e.stopPropagation()
    show(false)
    open.focus()
  })
  steps.onChange = build
  build()
  return box
}
