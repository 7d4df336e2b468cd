// The start page: what an empty program may begin as.

import bottle from '../../examples/gallery/bottle.sdl?raw'
import bracket from '../../examples/gallery/bracket.sdl?raw'
import propeller from '../../examples/propeller/propeller.sdl?raw'
import hull from '../../examples/sailboat/hull.sdl?raw'
import wing from '../../examples/wing/wing.sdl?raw'
import { h } from './dom'
import { OPENED } from './files'

export interface OpenedBefore {
  name: string
  path: string
}

export interface StartActions {
  /** The text that the program begins as, the name of that step, and half the height of what is seen of nothing. */
  begin(text: string, name: string, reach?: number): void
  /** Opens the form of a kind, or the list of all. */
  add(kind?: string): void
  /** Opens a program, or a CAD file as one. */
  open(file: File): void
  /** The models that were opened before. */
  recent(): Promise<OpenedBefore[]>
  /** Goes to the page of one of them. */
  reopen(path: string): void
}

const TEMPLATES: [string, string, string][] = [
  ['Hull', 'Sections, a loft, hydrostatics', hull],
  ['Bottle', 'A spline turned about an axis, with a wall', bottle],
  ['Propeller', 'Blades of sections on cylinders', propeller],
  ['Wing', 'Tapered and swept, four spacings of panels', wing],
  ['Bracket', 'A plate and a web with bolt holes', bracket],
]
/** Units and how many metres they are worth to a first view. */
const UNITS: Record<string, [string, number]> = {
  m: ['metres', 1],
  mm: ['millimetres', 0.05],
  ft: ['feet', 0.5],
  in: ['inches', 0.5],
}

/** Shown while the program is empty; `refresh` asks for the models that were opened before. */
export function startPage(act: StartActions): { element: HTMLElement; refresh: () => Promise<void> } {
  const unit = h(
    'select',
    { 'aria-label': 'unit of length' },
    ...Object.entries(UNITS).map(([u, [words]]) => h('option', { value: u }, words)),
  )
  const mirrored = h('input', { type: 'checkbox' })
  const empty = () => {
    act.begin(
      `Model info(${mirrored.checked ? 'symmetry = "y", ' : ''}units = "${unit.value}");\n`,
      'New model',
      10 / UNITS[unit.value][1],
    )
    act.add('AbsPoint')
  }
  const card = (title: string, words: string, run: () => void) =>
    h('button', { class: 'template', onclick: run }, h('strong', {}, title), h('span', { class: 'quiet' }, words))
  const chosen = h('input', { type: 'file', accept: OPENED, 'aria-label': 'open a program', hidden: true })
  chosen.addEventListener('change', () => chosen.files?.[0] && act.open(chosen.files[0]))
  const list = h('div', { class: 'recent', role: 'group', 'aria-label': 'opened before' })
  const recent = h('div', { hidden: true }, h('h2', {}, 'Opened before'), list)
  const refresh = async () => {
    const files = await act.recent().catch(() => [])
    const row = ({ name, path }: OpenedBefore) => {
      const folder = path.slice(0, path.length - name.length - 1)
      const words = [h('strong', {}, name), h('span', { class: 'quiet' }, folder)]
      return h('button', { class: 'link', title: path, onclick: () => act.reopen(path) }, ...words)
    }
    list.replaceChildren(...files.slice(0, 6).map(row))
    recent.hidden = files.length === 0
  }
  const element = h(
    'section',
    { class: 'start', 'aria-label': 'start', hidden: true },
    h('h2', {}, 'A new model'),
    h(
      'div',
      { class: 'fact' },
      h('label', {}, 'in ', unit),
      h('label', {}, mirrored, ' mirrored in y = 0'),
      h('button', { class: 'primary', onclick: empty }, 'Begin with points'),
      h('button', { onclick: () => chosen.click() }, 'Open a file…'),
      chosen,
    ),
    h('h2', {}, 'Or from an example'),
    h(
      'div',
      { class: 'templates' },
      ...TEMPLATES.map(([title, words, text]) => card(title, words, () => act.begin(text, `Begin from ${title}`))),
    ),
    recent,
    h('p', { class: 'quiet' }, 'Or type on the left. Ctrl+Z takes back what was begun.'),
  )
  return { element, refresh }
}
