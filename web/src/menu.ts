// A menu at a place of the page: arrows choose, Enter runs, Escape and a click elsewhere close it.

import { h } from './dom'

export interface Item {
  name: string
  keys?: string
  run: () => void
}

/** Opens a menu; the focus returns to its former element. */
export function openMenu(label: string, items: Item[], x: number, y: number): void {
  const before = document.activeElement as HTMLElement | null
  const close = (back: boolean) => {
    removeEventListener('pointerdown', away, true)
    menu.remove()
    if (back) before?.focus()
  }
  const away = (e: Event) => menu.contains(e.target as Node) || close(false)
  const rows = items.map((item) => {
    const run = () => {
      close(true)
      item.run()
    }
    return h(
      'button',
      { role: 'menuitem', tabindex: -1, onclick: run },
      item.name,
      item.keys ? h('kbd', {}, item.keys) : '',
    )
  })
  const menu = h('div', { class: 'menu', role: 'menu', 'aria-label': label }, ...rows)
  menu.addEventListener('keydown', (e) => {
    const at = rows.indexOf(document.activeElement as HTMLButtonElement)
    const to = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: rows.length - 1 }[e.key]
    if (to !== undefined) rows[(to + rows.length) % rows.length].focus()
    else if (e.key === 'Escape' || e.key === 'Tab') close(true)
    else return
    e.preventDefault()
    e.stopPropagation()
  })
  document.body.append(menu)
  const { width, height } = menu.getBoundingClientRect()
  menu.style.left = `${Math.max(4, Math.min(x, innerWidth - width - 4))}px`
  menu.style.top = `${Math.max(4, Math.min(y, innerHeight - height - 4))}px`
  addEventListener('pointerdown', away, true)
  rows[0]?.focus()
}
