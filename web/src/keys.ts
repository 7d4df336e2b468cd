// Keys of the whole page; fields, the program and the picture take theirs first.

import type { App } from './app'
import { commands, toggleMeasure } from './commands'

const TURNS: Record<string, number> = { 'Ctrl+Z': 1, 'Ctrl+Shift+Z': -1, 'Ctrl+Y': -1 }

/** The name of a key in the table of commands. */
export function nameOf(e: Pick<KeyboardEvent, 'key' | 'ctrlKey' | 'metaKey' | 'altKey' | 'shiftKey'>): string {
  const letter = e.key.length === 1 && /[a-z]/i.test(e.key)
  const key = e.key.length === 1 ? e.key.toUpperCase() : e.key
  return `${e.ctrlKey || e.metaKey ? 'Ctrl+' : ''}${e.altKey ? 'Alt+' : ''}${e.shiftKey && letter ? 'Shift+' : ''}${key}`
}

function leave(app: App): void {
  const { hands, making, section, planes } = app
  if (hands.busy) hands.cancel()
  else if (making.isOpen) making.close()
  else if (hands.measuring) toggleMeasure(app)
  else if (section.axis !== null) section.cut(null)
  else if (planes.shown) planes.close()
  else app.actions.select('', 'view')
}

export function installKeys(app: App): void {
  /** The texts of fields when the focus came to them. */
  const came = new WeakMap<HTMLInputElement, string>()
  addEventListener('focusin', (e) => {
    if (e.target instanceof HTMLInputElement && e.target.type !== 'range') came.set(e.target, e.target.value)
  })
  addEventListener('keydown', (e) => {
    const target = e.target as HTMLElement
    const typing = target.closest('input, select, textarea, .cm-editor, dialog') !== null
    const name = nameOf(e)
    if (name === 'Ctrl+K') {
      if (e.defaultPrevented) return
      e.preventDefault()
      return app.openPalette()
    }
    if (name in TURNS) {
      // A field with something typed in it takes that back first.
      const field = target.closest('input')
      const typed = field && (came.get(field) ?? field.value) !== field.value
      if (e.defaultPrevented || target.closest('dialog') || typed) return
      e.preventDefault()
      return app.changes.turn(TURNS[name])
    }
    if (e.key === 'Escape' && !typing) return leave(app)
    const command = commands(app).find((c) => c.keys === name)
    if (!command || e.defaultPrevented || app.hands.busy) return
    const plain = !e.ctrlKey && !e.metaKey && !e.altKey && !/^F\d/.test(e.key)
    if (plain && (typing || target.closest('[role=tree]'))) return
    if (typing && target.closest('dialog')) return
    e.preventDefault()
    command.run()
  })
}
