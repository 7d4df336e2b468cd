// Arrays of the program as tables: a column for each, a plot beside, and every cell an edit of the text.

import { ensureSyntaxTree } from '@codemirror/language'
import type { Text } from '@codemirror/state'
import { arraysOf, type Column, grouped, rowEdits, type WrittenArray } from './arrays'
import { h, s, shown } from './dom'
import type { Editor } from './editor'

export interface TableActions {
  say(words: string): void
  /** The number that a text means. */
  typed(text: string): Promise<number>
}

/** The syntax tree of a long program is waited for at most this long, in ms. */
const PARSING = 200
const [WIDTH, HEIGHT, MARGIN] = [220, 64, 4]

/** Those of the text that was looked through last: a slide asks at every frame. */
let known: { doc: Text; tables: WrittenArray[][] } | null = null

/** The tables of the text as it is now. */
export function tablesOf(editor: Editor): WrittenArray[][] {
  const { state } = editor.view
  if (known?.doc === state.doc) return known.tables
  const tree = ensureSyntaxTree(state, state.doc.length, PARSING)
  // Without it, comments cannot be distinguished from the program.
  if (!tree) return []
  const skipped = (at: number) => /comment|string/.test(tree.resolveInner(at, 1).name)
  known = { doc: state.doc, tables: grouped(arraysOf(editor.text, skipped)) }
  return known.tables
}

/** A column over the first one, or over its number. */
function plot(name: string, x: number[], y: number[]): SVGElement {
  const span = (v: number[]) => [Math.min(...v), Math.max(...v)]
  const [[x0, x1], [y0, y1]] = [span(x), span(y)]
  const X = (v: number) => MARGIN + ((WIDTH - 2 * MARGIN) * (v - x0)) / (x1 - x0 || 1)
  const Y = (v: number) => HEIGHT - MARGIN - ((HEIGHT - 2 * MARGIN) * (v - y0)) / (y1 - y0 || 1)
  const line = x.map((v, k) => `${k ? 'L' : 'M'}${X(v).toFixed(1)} ${Y(y[k]).toFixed(1)}`).join('')
  const dots = x.map((v, k) => s('circle', { cx: X(v), cy: Y(y[k]), r: 1.8 }))
  const label = `${name} from ${shown(y0, 4)} to ${shown(y1, 4)}`
  return s(
    'svg',
    { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: 'column-plot', role: 'img', 'aria-label': label },
    s('path', { d: line }),
    ...dots,
  )
}

/** One change after the other, each found anew in the text as it is then. */
let changing: Promise<void> = Promise.resolve()

function change(editor: Editor, act: TableActions, run: () => Promise<void>): void {
  changing = changing
    .then(() => editor.synced())
    .then(run)
    .catch((error) => act.say((error as Error).message))
}

function cell(editor: Editor, act: TableActions, column: Column, row: number): HTMLElement {
  const { name, numbers } = column
  const words = editor.text.slice(numbers[row].from, numbers[row].to)
  const label = `${name}, row ${row + 1}`
  const field = h('input', { type: 'text', class: 'number', 'aria-label': label, 'data-cell': label })
  field.value = words
  const enter = () => {
    const text = field.value.trim()
    if (text === words) return
    field.value = words
    change(editor, act, async () => {
      const value = String(await act.typed(text))
      const now = tablesOf(editor)
        .flat()
        .flatMap((a) => a.columns)
        .find((c) => c.name === name)
      if (now?.numbers[row]) editor.apply([{ ...now.numbers[row], insert: value }], undefined, `${label}: ${value}`)
    })
  }
  field.addEventListener('blur', enter)
  field.addEventListener('keydown', (e) => {
    const step = { Enter: 1, ArrowDown: 1, ArrowUp: -1 }[e.key]
    if (e.key === 'Escape') field.value = words
    if (!step) return
    e.preventDefault()
    const next = document.querySelector<HTMLInputElement>(`[data-cell="${name}, row ${row + 1 + step}"]`)
    if (next) next.focus()
    else field.blur()
  })
  field.addEventListener('focus', () => field.select())
  return field
}

function table(editor: Editor, act: TableActions, group: WrittenArray[]): HTMLElement {
  const text = editor.text
  const columns = group.flatMap((a) => a.columns)
  const values = columns.map((c) => c.numbers.map((n) => Number(text.slice(n.from, n.to))))
  const count = group[0].rows.length
  const rows = (more: boolean) => () =>
    change(editor, act, async () => {
      const now = tablesOf(editor).find((g) => g[0].name === group[0].name)
      const words = `${more ? 'Add' : 'Remove'} row ${count + (more ? 1 : 0)} of ${group.map((a) => a.name).join(', ')}`
      if (now) editor.apply(rowEdits(now, editor.text, more), undefined, words)
    })
  const increasing = values[0].every((v, k, all) => !k || v > all[k - 1])
  const x = increasing ? values[0] : values[0].map((_, k) => k)
  const plots = columns.map((c, k) => h('td', {}, plot(c.name, k && increasing ? x : x.map((_, j) => j), values[k])))
  return h(
    'div',
    { class: 'table-box' },
    h(
      'table',
      { class: 'cells' },
      h(
        'thead',
        {},
        h('tr', {}, h('th', {}, ''), ...columns.map((c) => h('th', {}, c.name))),
        h('tr', {}, h('th', {}, ''), ...plots),
      ),
      h(
        'tbody',
        {},
        ...Array.from({ length: count }, (_, k) =>
          h('tr', {}, h('th', { scope: 'row' }, k + 1), ...columns.map((c) => h('td', {}, cell(editor, act, c, k)))),
        ),
      ),
    ),
    h(
      'div',
      { class: 'buttons' },
      h('button', { onclick: rows(true) }, 'Add a row'),
      h('button', { onclick: rows(false), disabled: count < 2 }, 'Remove the last row'),
    ),
  )
}

/** The sheet of tables. */
export function tablesSheet(editor: Editor, act: TableActions): HTMLElement[] {
  const groups = tablesOf(editor)
  if (!groups.length)
    return [
      h(
        'p',
        { class: 'quiet pad' },
        'The program has no arrays of numbers or points, such as farray x = {0, 0.5, 1}; or curve c = {{0, 0, 0}, {1, 0, 0}};',
      ),
    ]
  const about =
    'Arrays of equal length that follow each other are one table; each is plotted over the first. A row of points has x, y and z.'
  return [
    h(
      'div',
      { class: 'pad' },
      h('h2', {}, 'Tables'),
      h('p', { class: 'quiet' }, about),
      ...groups.map((g) => table(editor, act, g)),
    ),
  ]
}
