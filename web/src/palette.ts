// The palette of commands, and the overlay of keys and gestures: both show one table.

import { h } from './dom'

export interface Command {
  name: string
  keys?: string
  run: () => void
}

/** `words`: what is typed there already. */
/** Commands to choose from by words; they are asked anew once `later` is there. */
export function palette(all: () => Command[], words = '', later?: Promise<unknown>): void {
  if (document.querySelector('dialog[open]')) return
  const input = h('input', {
    type: 'text',
    placeholder: 'Type a command or the name of an object',
    'aria-label': 'command',
    role: 'combobox',
    'aria-expanded': 'true',
    'aria-controls': 'commands',
  })
  const list = h('ul', { role: 'listbox', id: 'commands', 'aria-label': 'commands' })
  const dialog = h('dialog', { class: 'palette', 'aria-label': 'commands' }, input, list)
  let found: Command[] = []
  let at = 0
  const run = (c: Command | undefined) => {
    dialog.close()
    c?.run()
  }
  const build = () => {
    const sought = input.value.toLowerCase().split(/\s+/).filter(Boolean)
    found = all()
      .filter((c) => sought.every((w) => c.name.toLowerCase().includes(w)))
      .slice(0, 60)
    at = Math.max(0, Math.min(at, found.length - 1))
    list.replaceChildren(
      ...found.map((c, k) =>
        h(
          'li',
          { role: 'option', 'aria-selected': k === at, id: `command-${k}`, onclick: () => run(c) },
          c.name,
          c.keys ? h('kbd', {}, c.keys) : '',
        ),
      ),
    )
    list.children[at]?.scrollIntoView({ block: 'nearest' })
    input.setAttribute('aria-activedescendant', found.length ? `command-${at}` : '')
  }
  input.addEventListener('input', () => ((at = 0), build()))
  input.addEventListener('keydown', (e) => {
    if (e.key === 'ArrowDown') at++
    else if (e.key === 'ArrowUp') at--
    else if (e.key !== 'Enter') return
    // The button that opened the palette has the focus again, and would be pressed by the same key.
    e.preventDefault()
    if (e.key === 'Enter') return run(found[at])
    at = (at + found.length) % Math.max(1, found.length)
    build()
  })
  dialog.addEventListener('close', () => dialog.remove())
  dialog.addEventListener('click', (e) => e.target === dialog && dialog.close())
  document.body.append(dialog)
  dialog.showModal()
  input.value = words
  build()
  void later?.then(build, () => undefined)
  input.focus()
}

export function help(commands: Command[]): void {
  const rows = commands
    .filter((c) => c.keys)
    .map((c) => h('tr', {}, h('td', {}, h('kbd', {}, c.keys!)), h('td', {}, c.name)))
  const hand = [
    ['drag', 'orbit'],
    ['right or middle drag, Shift+drag', 'pan'],
    ['wheel, pinch', 'zoom to the pointer'],
    ['click', 'select'],
    ['double click', 'go to the declaration'],
    ['drag a point', 'move it: the number in the text follows'],
    ['X Y Z while dragging', 'along an axis; with Shift across it'],
    ['S while dragging', 'on the surface under the pointer'],
    ['digits while dragging', 'enter the value'],
    ['Alt while dragging', 'no snapping'],
    ['Esc', 'take it back'],
  ]
  const table = (body: Node[]) => h('table', {}, h('tbody', {}, ...body))
  const half = Math.ceil(rows.length / 2)
  const dialog = h(
    'dialog',
    { class: 'help', 'aria-label': 'help' },
    h('h2', { tabindex: -1, autofocus: true }, 'Keys and gestures'),
    h(
      'div',
      { class: 'columns' },
      table(hand.map(([k, w]) => h('tr', {}, h('td', {}, k), h('td', {}, w)))),
      table(rows.slice(0, half)),
      table(rows.slice(half)),
    ),
    h('button', { class: 'primary', onclick: () => dialog.close() }, 'Close'),
  )
  dialog.addEventListener('close', () => dialog.remove())
  document.body.append(dialog)
  dialog.showModal()
}
