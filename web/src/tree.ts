// The list of objects: found, selected, hidden, renamed, duplicated, moved and deleted, by pointer and by keys.

import { h, store, stored } from './dom'
import { type Item, openMenu } from './menu'
import type { Actions } from './panels'
import type { ObjectFact } from './protocol'
import { model, on } from './state'

const GROUPS: [string, string[]][] = [
  ['Surfaces', ['surface']],
  ['Bodies', ['mesh', 'solid', 'set']],
  ['Curves', ['curve', 'snake']],
  ['Points', ['point', 'bead', 'magnet', 'ring']],
  ['Planes and frames', ['plane', 'frame']],
  ['Contours', ['contours']],
  ['Others', []],
]
const MOST_ROWS = 300

export function treePanel(host: HTMLElement, act: Actions & { hidden: Set<string>; selected: () => string }): void {
  const search = h('input', { type: 'search', placeholder: 'Search objects', 'aria-label': 'search objects' })
  const tree = h('div', { role: 'tree', 'aria-label': 'objects', class: 'tree' })
  const folded = new Set<string>(stored<string[]>('folded', ['Points']))
  host.append(h('div', { class: 'search' }, search), tree)
  search.addEventListener('input', () => build())
  search.addEventListener('keydown', (event) => {
    if (event.key === 'ArrowDown') {
      event.preventDefault()
      ;(tree.querySelector('[role=treeitem]') as HTMLElement | null)?.focus()
    }
  })

  function groups(): [string, ObjectFact[]][] {
    const word = search.value.trim().toLowerCase()
    const found = model.objects.filter(
      (o) => !word || o.name.toLowerCase().includes(word) || o.kind.toLowerCase().includes(word),
    )
    const known = new Set(GROUPS.flatMap(([, c]) => c))
    return GROUPS.map(
      ([title, classes]) =>
        [title, found.filter((o) => (classes.length ? classes.includes(o.class) : !known.has(o.class)))] as [
          string,
          ObjectFact[],
        ],
    ).filter(([, all]) => all.length)
  }

  function build(): void {
    const focused = (document.activeElement as HTMLElement | null)?.dataset?.key
    tree.textContent = ''
    // A tree without items is none.
    const all = groups()
    tree.setAttribute('role', all.length ? 'tree' : 'group')
    for (const [title, objects] of all) {
      const open = !folded.has(title) || search.value.trim() !== ''
      const head = h(
        'div',
        {
          role: 'treeitem',
          'aria-level': 1,
          'aria-expanded': open,
          'aria-setsize': all.length,
          tabindex: -1,
          class: 'group',
          'data-key': `:${title}`,
        },
        h('span', { class: 'twist' }, open ? '▾' : '▸'),
        title,
        h('span', { class: 'count' }, objects.length),
      )
      head.addEventListener('click', () => fold(title))
      tree.append(head)
      if (!open) continue
      const shownRows = objects.slice(0, MOST_ROWS)
      shownRows.forEach((o, k) => tree.append(row(o, k, objects.length)))
      if (objects.length > MOST_ROWS)
        tree.append(h('div', { class: 'quiet more' }, `${objects.length - MOST_ROWS} more: search`))
    }
    if (!all.length)
      tree.append(
        h(
          'div',
          { class: 'quiet more' },
          model.objects.length ? 'No matches.' : 'The program declares no objects yet.',
        ),
      )
    const rows = items()
    const again =
      rows.find((r) => r.dataset.key === focused) ??
      rows.find((r) => r.getAttribute('aria-selected') === 'true') ??
      rows[0]
    if (again) {
      again.tabIndex = 0
      if (focused) again.focus()
    }
  }

  function row(o: ObjectFact, k: number, count: number): HTMLElement {
    const hidden = act.hidden.has(o.name) || !o.shown
    const eye = h(
      'button',
      {
        class: 'icon eye',
        tabindex: -1,
        'aria-label': `${hidden ? 'show' : 'hide'} ${o.name}`,
        title: hidden ? 'Show' : 'Hide',
      },
      hidden ? '○' : '●',
    )
    const item = h(
      'div',
      {
        role: 'treeitem',
        'aria-level': 2,
        'aria-posinset': k + 1,
        'aria-setsize': count,
        'aria-selected': o.name === act.selected(),
        tabindex: -1,
        class: `object ${o.state} ${hidden ? 'hidden' : ''}`,
        'data-key': o.name,
        title: o.state === 'ok' ? o.kind : `${o.kind}: ${o.state}`,
      },
      h('span', { class: 'label' }, o.name),
      h('span', { class: 'kind' }, o.state === 'ok' ? o.kind : o.state),
      eye,
    )
    eye.addEventListener('click', (event) => {
      event.stopPropagation()
      act.toggle(o.name)
    })
    item.addEventListener('click', () => act.select(o.name, 'tree'))
    item.addEventListener('contextmenu', (event) => {
      event.preventDefault()
      focus(item)
      menu(o.name, event.clientX, event.clientY)
    })
    item.addEventListener('dblclick', () => void act.locate(o.name))
    if (changeable()) carried(item, o.name)
    item.addEventListener('pointerenter', () => act.hover(o.name))
    item.addEventListener('pointerleave', () => act.hover(''))
    return item
  }

  const changeable = () => !act.still && model.program
  const erase = (name: string) => void act.rewrite('delete', { name }, `Delete ${name}`)

  /** Moves a statement before that of another object, or behind it. */
  const reorder = (name: string, beside: string, behind: boolean) =>
    void act.rewrite('reorder', { name, beside, behind }, `Move ${name} ${behind ? 'behind' : 'before'} ${beside}`)

  /** The next object of a row's group, up or down, takes its place. */
  function shift(name: string, down: boolean): void {
    const rows = items()
    const at = rows.findIndex((r) => r.dataset.key === name)
    const other = rows[at + (down ? 1 : -1)]?.dataset.key
    if (other && !other.startsWith(':')) reorder(name, other, down)
  }

  /** The row is dragged to another place of the list. */
  let held = ''
  function carried(item: HTMLElement, name: string): void {
    const below = (e: DragEvent) => {
      const box = item.getBoundingClientRect()
      return e.clientY > box.top + box.height / 2
    }
    const mark = (where: string) => {
      if (where) item.dataset.drop = where
      else delete item.dataset.drop
    }
    item.draggable = true
    item.addEventListener('dragstart', (e) => {
      held = name
      e.dataTransfer?.setData('text/plain', name)
    })
    item.addEventListener('dragend', () => (held = ''))
    item.addEventListener('dragover', (e) => {
      if (!held || held === name) return
      e.preventDefault()
      mark(below(e) ? 'behind' : 'before')
    })
    item.addEventListener('dragleave', () => mark(''))
    item.addEventListener('drop', (e) => {
      mark('')
      if (!held || held === name) return
      e.preventDefault()
      e.stopPropagation()
      reorder(held, name, below(e))
    })
  }

  /** What can be done with an object. */
  function menu(name: string, x: number, y: number): void {
    const hidden = act.hidden.has(name)
    const { fair } = act
    const faired = ['curve', 'surface'].includes(model.objects.find((o) => o.name === name)?.class ?? '')
    const fairing: Item[] = fair && faired ? [{ name: 'Fair on the desk', run: () => fair(name) }] : []
    const change: Item[] = changeable()
      ? [
          { name: 'Rename', keys: 'F2', run: () => rename(name) },
          {
            name: 'Duplicate',
            keys: 'Ctrl+D',
            run: () => void act.rewrite('duplicate', { name }, `Duplicate ${name}`),
          },
          { name: 'Move up', keys: 'Alt+↑', run: () => shift(name, false) },
          { name: 'Move down', keys: 'Alt+↓', run: () => shift(name, true) },
          { name: 'Delete', keys: 'Delete', run: () => erase(name) },
        ]
      : []
    openMenu(
      name,
      [
        { name: 'Show in the program', run: () => void act.locate(name) },
        { name: hidden ? 'Show' : 'Hide', keys: 'Space', run: () => act.toggle(name) },
        { name: 'Isolate', keys: 'Alt+I', run: () => act.isolate(name) },
        ...fairing,
        ...change,
      ],
      x,
      y,
    )
  }

  /** The name becomes a field. */
  function rename(name: string): void {
    const label = items()
      .find((r) => r.dataset.key === name)
      ?.querySelector<HTMLElement>('.label')
    if (!label) return
    const field = h('input', {
      type: 'text',
      class: 'rename',
      'aria-label': `new name of ${name}`,
      spellcheck: 'false',
    })
    field.value = name
    let ended = false
    const end = (write: boolean) => {
      // Leaving the page's tree is leaving the field, too.
      if (ended) return
      ended = true
      const now = field.value.trim()
      field.replaceWith(label)
      if (write && now && now !== name)
        void act.rewrite('rename_object', { name, new: now }, `Rename ${name} to ${now}`)
    }
    field.addEventListener('keydown', (event) => {
      event.stopPropagation()
      if (event.key !== 'Enter' && event.key !== 'Escape') return
      event.preventDefault()
      end(event.key === 'Enter')
      items()
        .find((r) => r.dataset.key === name)
        ?.focus()
    })
    field.addEventListener('blur', () => end(true))
    field.addEventListener('click', (event) => event.stopPropagation())
    label.replaceWith(field)
    field.select()
  }

  const focus = (to: HTMLElement) => {
    for (const r of items()) r.tabIndex = r === to ? 0 : -1
    to.focus()
  }
  const items = () => [...tree.querySelectorAll<HTMLElement>('[role=treeitem]')]
  function fold(title: string): void {
    if (!folded.delete(title)) folded.add(title)
    store('folded', [...folded])
    build()
  }

  let typed = ''
  let typedAt = 0
  tree.addEventListener('keydown', (event) => {
    const rows = items()
    const at = rows.indexOf(document.activeElement as HTMLElement)
    if (at < 0) return
    const key = rows[at].dataset.key ?? ''
    const go = (k: number) => {
      const to = rows[Math.max(0, Math.min(rows.length - 1, k))]
      rows[at].tabIndex = -1
      to.tabIndex = 0
      to.focus()
    }
    const group = key.startsWith(':') ? key.slice(1) : ''
    if (event.altKey && /^Arrow(Up|Down)$/.test(event.key) && !group && changeable())
      shift(key, event.key === 'ArrowDown')
    else if (event.key === 'ArrowDown') go(at + 1)
    else if (event.key === 'ArrowUp') go(at - 1)
    else if (event.key === 'Home') go(0)
    else if (event.key === 'End') go(rows.length - 1)
    else if (event.key === 'ArrowRight' && group && folded.has(group)) fold(group)
    else if (event.key === 'ArrowLeft' && group && !folded.has(group)) fold(group)
    else if (event.key === 'ArrowLeft' && !group)
      go(rows.findLastIndex((r, k) => k < at && r.classList.contains('group')))
    else if (event.key === 'Enter') group ? fold(group) : act.select(key, 'tree')
    else if (event.key === ' ' && !group) act.toggle(key)
    else if (event.key === 'i' && event.altKey && !group) act.isolate(key)
    else if (event.key === 'F2' && !group && changeable()) rename(key)
    else if (event.key === 'Delete' && !group && changeable()) erase(key)
    else if ((event.key === 'ContextMenu' || (event.key === 'F10' && event.shiftKey)) && !group) {
      const box = rows[at].getBoundingClientRect()
      menu(key, box.left + 24, box.bottom)
    } else if (event.key.length === 1 && !event.ctrlKey && !event.metaKey && !event.altKey && event.key !== ' ') {
      const now = performance.now()
      typed = now - typedAt < 600 ? typed + event.key.toLowerCase() : event.key.toLowerCase()
      typedAt = now
      const to = rows.findIndex((r, k) => k >= at && (r.dataset.key ?? '').toLowerCase().startsWith(typed))
      if (to >= 0) go(to)
    } else return
    event.preventDefault()
    event.stopPropagation()
  })
  on(['objects', 'selection'], build)
}
