// The side of the fairing desk: the lines with their states, the suspects to accept, the marks to take away.

import type { DeskFacts } from './desk_paint'
import { h, shown } from './dom'

export interface ListActs {
  run(command: string): void
  showLine(line: number): void
  showPoint(line: number, point: number): void
}

export class DeskLists {
  private readonly lines = h('div', { class: 'desk-lines', role: 'listbox', tabindex: 0, 'aria-label': 'lines' })
  private readonly suspects = h('div', { class: 'desk-suspects', role: 'log', 'aria-label': 'suspects' })
  private readonly marks = h('div', { class: 'desk-marks', role: 'group', 'aria-label': 'marks' })
  readonly element = h(
    'div',
    { class: 'desk-side' },
    h('h2', {}, 'Lines'),
    this.lines,
    h('h2', {}, 'Suspects'),
    this.suspects,
    h('h2', {}, 'Marks'),
    this.marks,
  )
  private line = 0

  constructor(private readonly act: ListActs) {
    this.lines.addEventListener('keydown', (e) => {
      const by = { ArrowDown: 1, ArrowUp: -1 }[e.key]
      if (!by) return
      e.preventDefault()
      e.stopPropagation()
      act.showLine(this.line + by)
    })
  }

  fill(f: DeskFacts): void {
    this.fillLines(f)
    this.fillSuspects(f)
    this.fillMarks(f)
  }

  fillLines(f: DeskFacts): void {
    const { act } = this
    this.line = f.line
    this.lines.replaceChildren(
      ...f.list.map((o, k) => {
        const lock = h(
          'button',
          {
            title: o.locked ? 'Unlock the line' : 'Lock the line as it is',
            'aria-label': `${o.locked ? 'unlock' : 'lock'} ${o.name}`,
            onclick: (e: Event) => (e.stopPropagation(), act.run(`${o.locked ? 'unlock' : 'lock'} ${k + 1}`)),
          },
          o.locked ? 'Locked' : 'Lock',
        )
        const compared = f.compared?.[k]
        return h(
          'div',
          { role: 'option', 'aria-selected': k === f.line, 'data-line': k, onclick: () => act.showLine(k) },
          h('span', {}, o.name),
          lock,
          h(
            'span',
            { class: 'facts' },
            `bends ${o.inflections[0]} → ${o.inflections[1]}, pieces ${o.pieces[0]} → ${o.pieces[1]}, moved ${shown(o.moved, 3)} (${Math.round(100 * o.share)} %)${compared ? `, ${shown(compared, 2)} by the last step` : ''}`,
          ),
        )
      }),
    )
  }

  private fillSuspects(f: DeskFacts): void {
    const { act } = this
    this.suspects.replaceChildren(
      ...(f.suspects.length
        ? f.suspects.map((x) =>
            h(
              'div',
              { 'data-point': x.point },
              x.text,
              x.reading && f.kind !== 'curves' ? ` Reading: ${shown(x.reading, 6)}. ` : ' ',
              h(
                'button',
                { 'aria-pressed': x.accepted, onclick: () => act.run(`accept ${x.point + 1}`) },
                x.accepted ? 'Accepted' : 'Accept',
              ),
              h('button', { onclick: () => act.showPoint(x.line, x.point) }, 'Show'),
            ),
          )
        : [h('p', { class: 'quiet' }, 'none')]),
    )
  }

  private fillMarks(f: DeskFacts): void {
    const button = (words: string, command: string) =>
      h('button', { title: `take away: ${words}`, onclick: () => this.act.run(command) }, `${words} ×`)
    const { knuckles, fixed, released } = f.detail
    this.marks.replaceChildren(
      ...knuckles.map((p) => button(`knuckle ${p + 1}`, `knuckle ${p + 1}`)),
      ...fixed.map((p) => button(`fixed ${p + 1}`, `free ${p + 1}`)),
      ...released.map((p) => button(`released ${p + 1}`, `accept ${p + 1}`)),
      ...f.shapes
        .filter((x) => x.line === f.line)
        .map((x) =>
          x.ends
            ? button(
                x.text,
                `${x.text.split('=')[0]} ${x.ends.map((p) => p + 1).join('-')}${x.text.includes(':') && !x.text.startsWith('within') ? ` ${x.text.split(':')[1]}` : ''}`,
              )
            : button(x.text, `${x.text.replace('=', ' ')} line ${x.line + 1}`),
        ),
      ...(f.span ? [button(`range ${f.span[1] + 1}-${f.span[2] + 1}`, 'range off')] : []),
    )
  }
}
