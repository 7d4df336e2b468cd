// The form for a section line of a network: a plane across an axis, or a diagonal.

import { h } from './dom'

/** Planes by their commands: `cut PLANE VALUE`, or with a normal `cut PLANE:VALUE`. */
const PLANES: [string, string][] = [
  ['z', 'Waterline, z ='],
  ['y', 'Buttock, y ='],
  ['x', 'Station, x ='],
  ['0,1,1', 'Diagonal, y + z ='],
]

/** The command for a plane, or nothing for a value that is no number. */
export function cutCommand(plane: string, value: string): string {
  const number = value.trim().replace('−', '-').replace(',', '.')
  if (number === '' || !Number.isFinite(Number(number))) return ''
  return plane.includes(',') ? `cut ${plane}:${number}` : `cut ${plane} ${number}`
}

export class CutForm {
  private readonly plane = h(
    'select',
    { 'aria-label': 'plane' },
    ...PLANES.map(([plane, words]) => h('option', { value: plane }, words)),
  )
  private readonly value = h('input', { type: 'text', inputmode: 'decimal', 'aria-label': 'place of the plane' })
  readonly element = h('form', { class: 'desk-cut', 'aria-label': 'section line', hidden: true })

  constructor(run: (command: string) => Promise<boolean>, say: (words: string) => void, leave: () => void) {
    this.element.append(this.plane, this.value, h('button', { class: 'primary' }, 'Cut'))
    this.element.addEventListener('submit', (e) => {
      e.preventDefault()
      const command = cutCommand(this.plane.value, this.value.value)
      if (!command) return say(`expected a number for the plane, found \`${this.value.value}\``)
      void run(command).then((fine) => {
        if (!fine) return this.value.select()
        this.element.hidden = true
        leave()
      })
    })
    this.element.addEventListener('keydown', (e) => {
      e.stopPropagation()
      if (e.key !== 'Escape') return
      this.element.hidden = true
      leave()
    })
  }

  open(): void {
    this.element.hidden = !this.element.hidden
    if (this.element.hidden) return
    this.value.focus()
    this.value.select()
  }
}
