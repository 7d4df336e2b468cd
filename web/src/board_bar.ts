// The buttons of the drawing board, what an empty text begins with, and the doubts with their fixes.

import type { Board } from './board'
import { type Check, letter } from './board_paint'
import { type Shape, shapes } from './board_shapes'
import { h } from './dom'
import type { Facts } from './frame'

const PRESETS: [string, string][] = [
  ['345 40 90', 'Trimetric 345 40 90'],
  ['ISO', 'Isometric'],
  ['CAVALIER', 'Cavalier'],
  ['CABINET', 'Cabinet'],
  ['MILITARY', 'Military'],
  ['DIN', 'Dimetric 42/7'],
  ['AUTO', 'As the lines show'],
]

/** What the buttons do, and what they show. */
export type BarActs = Pick<
  Board,
  | 'tool'
  | 'drawn'
  | 'chosen'
  | 'checks'
  | 'proposed'
  | 'last'
  | 'act'
  | 'use'
  | 'fit'
  | 'focus'
  | 'choose'
  | 'choosePart'
  | 'toConfirm'
  | 'confirmNext'
  | 'acceptProposed'
  | 'make'
  | 'askShape'
  | 'face'
  | 'sketchOnFace'
>

function button(words: string, key: string, run: () => void, more: Facts = {}): HTMLElement {
  const title = key ? `${words} (${key})` : words
  return h('button', { title, onclick: run, ...more }, words, key ? h('kbd', {}, key) : '')
}

function select(name: string, options: [string, string][], value: string, run: (v: string) => void): HTMLElement {
  const made = h(
    'select',
    { 'aria-label': name, title: name },
    ...options.map(([v, words]) => h('option', { value: v, selected: v === value }, words)),
  )
  made.addEventListener('change', () => run(made.value))
  return made
}

export class BoardBar {
  readonly element = h('div', { class: 'board-bar', role: 'toolbar', 'aria-label': 'drawing' })
  readonly issues = h('div', { class: 'board-issues', role: 'log', 'aria-label': 'doubts and contradictions' })
  readonly start = h('div', { class: 'board-start' })
  /** The face that is traced, with its answers. */
  readonly asked = h('div', { class: 'board-asked', role: 'group', 'aria-label': 'face to judge', hidden: true })

  constructor(
    private readonly board: BarActs,
    private readonly underlay: () => HTMLElement[],
  ) {}

  /** What an empty text begins with. */
  starting(): void {
    const { board } = this
    this.start.hidden = board.drawn.object !== null
    if (this.start.hidden || this.start.childElementCount) return
    const begin = (words: string, command: string) =>
      h(
        'button',
        { onclick: () => void board.act([{ do: 'run', command, last: true }]).then(() => board.focus()) },
        words,
      )
    this.start.append(
      h('h3', {}, 'A new drawing'),
      h('p', { class: 'quiet' }, 'Only the directions of lines count; dimensions come after.'),
      begin('Pictorial: a solid with its depth', `SKETCH PART\nAXES ${PRESETS[0][0]}`),
      ...['XZ', 'XY', 'YZ'].map((plane) => begin(`Cross section in ${plane.toLowerCase()}`, `SKETCH PART 2D ${plane}`)),
    )
  }

  private ask(): void {
    const { board } = this
    const { asked } = board.drawn
    this.asked.hidden = asked === null
    if (!asked) return
    const answer = (words: string, key: string, command: string, about: string) =>
      button(words, key, () => void board.act([{ do: 'run', command, last: true }]).then(() => board.focus()), {
        title: about,
      })
    this.asked.replaceChildren(
      h('span', { role: 'status' }, `Face ${asked.map((loop) => loop.join(' ')).join(', hole ')}?`),
      answer('Accept', 'Enter', 'ACCEPT', 'A face of the solid'),
      answer('Reverse', '', 'REVERSE', 'The other side is outside'),
      answer('Reject', '', 'REJECT', 'No face: the solid is open or hollow there'),
    )
  }

  /** Dimensions given of those needed, along each axis. */
  private progress(): HTMLElement {
    const { drawn } = this.board
    const planes: Record<string, number> = {}
    for (const [axis] of drawn.planes) planes[axis] = (planes[axis] ?? 0) + 1
    const counts = Object.entries(drawn.missing)
      .filter(([axis]) => axis in drawn.axes)
      .map(([axis, open]) => {
        const all = Math.max(0, (planes[axis] ?? 1) - 1)
        return h('span', { class: `count type-${axis} ${open ? '' : 'done'}` }, `${axis} ${all - open}/${all}`)
      })
    return h('span', { class: 'progress', role: 'status', 'aria-label': 'dimensions given of those needed' }, ...counts)
  }

  buttons(): void {
    const { board } = this
    const d = board.drawn
    const tool = (name: 'draw' | 'select', words: string, key: string) =>
      button(words, key, () => board.use(name), {
        'aria-pressed': board.tool === name,
        class: board.tool === name ? 'on' : '',
      })
    const confirm = board.toConfirm()
    this.ask()
    const complete = d.lines.length > 2 && d.next.length === 0 && !d.faces && !d.asked
    const action =
      !d.section && complete && board.last?.exact && board.last.vertices
        ? button('Make the solid', 'Enter', () => void board.make(), { class: 'primary' })
        : ''
    const trace =
      !d.section && complete && board.last?.exact
        ? button(
            'Trace the faces',
            '',
            () => void board.act([{ do: 'run', command: 'GENERATE FACES ASK', last: true }]),
          )
        : ''
    const shape = (one: Shape) =>
      button(one.words, one.key.toUpperCase(), () => board.askShape(one), {
        class: one.words === 'Extrude' && complete ? 'primary' : '',
      })
    const objects: [string, string][] = d.objects.map((o) => [o, o])
    const axes: [string, string][] = [['', `Axes ${d.angles.join(' ')}`], ...PRESETS]
    this.element.replaceChildren(
      tool('draw', 'Draw', 'D'),
      tool('select', 'Select', 'V'),
      objects.length > 1 ? select('object', objects, d.object ?? '', (name) => board.choose(name)) : '',
      d.object && !d.section ? select('axes', axes, '', (x) => x && void board.act([{ do: 'axes', axes: x }])) : '',
      this.progress(),
      board.face
        ? button(`Sketch on face ${board.face.name}`, 'S', () => void board.sketchOnFace(), { class: 'primary' })
        : '',
      confirm.length ? button(`${confirm.length} to confirm`, 'C', () => board.confirmNext()) : '',
      board.proposed.size
        ? button(`Accept ${board.proposed.size} proposed`, 'T', () => void board.acceptProposed())
        : '',
      h('span', { class: 'grow' }),
      ...this.underlay(),
      ...(d.lines.length > 1 || d.faces ? shapes(d, board.chosen) : []).map(shape),
      trace,
      action,
      button('Fit', '0', () => board.fit()),
    )
  }

  listIssues(): void {
    const { board } = this
    const { drawn, checks } = board
    const fault = drawn.faults[0]
    const fix = (command: string, show: () => void) => {
      const typed = /^TYPE (\d+) AS (\w+)$/.exec(command)
      const change = typed ? { do: 'type', lines: [Number(typed[1])], type: typed[2] } : { do: 'run', command }
      return h('button', { onclick: () => void board.act([change]), onpointerenter: show, onfocus: show }, command)
    }
    // A doubt is ended by what is proposed, or by what is there.
    const sure = (c: Check) => {
      const [id] = c.about.lines
      const type = board.proposed.get(id) ?? drawn.lines.find((l) => l[0] === id)?.[3]
      return /doubtful|oblique|untyped/.test(c.about.kind) && type
        ? [`TYPE ${id} AS ${letter(type, drawn.section)}`]
        : []
    }
    const issue = (c: Check) =>
      h(
        'div',
        {
          class: 'issue',
          tabindex: 0,
          onfocus: () => board.choosePart(c),
        },
        c.text,
        ' ',
        ...[...new Set([...c.fixes, ...sure(c)])].map((command) => fix(command, () => board.choosePart(c))),
      )
    this.issues.replaceChildren(
      ...(fault ? [h('div', { class: 'bad' }, `line ${fault.line}: ${fault.text}`)] : []),
      ...checks.slice(0, 5).map(issue),
      ...(checks.length > 5 ? [h('div', { class: 'quiet' }, `and ${checks.length - 5} more`)] : []),
    )
  }
}
