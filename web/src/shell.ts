// The frame of the page: header, panels, their sizes, light and dark.

import { h, store, stored } from './dom'
import { icon } from './icons'
import type { Link } from './link'

const SIZES = { left: 420, right: 300, messages: 130 }
/** Least and greatest size of a panel, in picture points. */
const BOUNDS: Record<string, [number, number]> = { messages: [60, 500], left: [180, 900], right: [180, 900] }

function grip(name: string, words: string, orientation: 'vertical' | 'horizontal'): HTMLElement {
  const row = orientation === 'horizontal' ? ' row' : ''
  const [least, most] = BOUNDS[name]
  return h('div', {
    class: `grip${row}`,
    'data-size': name,
    role: 'separator',
    'aria-orientation': orientation,
    'aria-valuemin': least,
    'aria-valuemax': most,
    'aria-label': words,
    tabindex: 0,
  })
}

/** Makes the separators of the panels movable, by the pointer and by arrow keys; sizes are kept. */
function resizable(root: HTMLElement): void {
  const sizes = { ...SIZES, ...stored<Record<string, number>>('sizes', {}) } as Record<string, number>
  for (const g of root.querySelectorAll<HTMLElement>('.grip')) {
    const name = g.dataset.size!
    const [least, most] = BOUNDS[name]
    const put = (x: number) => {
      sizes[name] = Math.max(least, Math.min(most, x))
      document.documentElement.style.setProperty(`--${name}`, `${sizes[name]}px`)
      g.setAttribute('aria-valuenow', String(Math.round(sizes[name])))
    }
    const change = (x: number) => {
      put(x)
      store('sizes', sizes)
    }
    put(sizes[name])
    g.addEventListener('pointerdown', (e) => {
      g.setPointerCapture(e.pointerId)
      const [from, size] = [name === 'messages' ? e.clientY : e.clientX, sizes[name]]
      const move = (m: PointerEvent) =>
        change(size + (name === 'messages' ? from - m.clientY : (name === 'right' ? -1 : 1) * (m.clientX - from)))
      g.addEventListener('pointermove', move)
      g.addEventListener('pointerup', () => g.removeEventListener('pointermove', move), { once: true })
    })
    g.addEventListener('keydown', (e) => {
      const by = { ArrowLeft: -20, ArrowUp: 20, ArrowRight: 20, ArrowDown: -20 }[e.key]
      if (by) change(sizes[name] + (name === 'right' ? -by : by))
    })
  }
}

export type Shell = ReturnType<typeof makeShell>

/** The elements of the page, in their places. */
export function makeShell(link: Link) {
  const file = h('span', { class: 'file' })
  const saved = h('span', { class: 'saved', role: 'status' })
  const historyPlace = h('span', { class: 'history-place' })
  const saveButton = link.local
    ? h('button', { class: 'primary', title: 'The text as a file (Ctrl+S)' }, 'Download')
    : h('button', { class: 'primary', title: 'Write the text to the file (Ctrl+S)' }, 'Save')
  const paletteButton = h('button', { title: 'All commands (Ctrl+K)' }, 'Commands', h('kbd', {}, 'Ctrl K'))
  const linkButton = h('button', { title: 'Copy a link that holds the model' }, 'Link')
  const exportButton = h('button', { title: 'Picture, STEP, IGES, meshes, curves, panels' }, 'Export')
  const themeButton = h(
    'button',
    { class: 'icon', 'aria-label': 'light or dark', title: 'Light or dark' },
    icon('theme'),
  )
  const helpButton = h('button', { class: 'icon', 'aria-label': 'help', title: 'Help (F1)' }, icon('help'))
  const header = h(
    'header',
    { class: 'top' },
    h('h1', {}, 'Moldloft'),
    file,
    saved,
    historyPlace,
    h('span', { class: 'grow' }),
    paletteButton,
    link.still ? '' : linkButton,
    exportButton,
    link.still ? '' : saveButton,
    themeButton,
    helpButton,
  )
  const banner = h('div', { class: 'banner', hidden: true, role: 'alert' })
  const editor = h('div', { class: 'editor' })
  const messages = h('section', { class: 'messages', 'aria-label': 'messages' })
  const view = h('div', { class: 'view' })
  const sheet = h('div', { class: 'sheet', hidden: true, tabindex: 0 })
  const toolbar = h('div', { class: 'toolbar', role: 'toolbar', 'aria-label': 'view' })
  const tabs = h('div', { class: 'tabs', role: 'tablist', 'aria-label': 'what is shown' })
  const legend = h('div', { class: 'legend', hidden: true })
  const section = h('div', { class: 'section', role: 'group', 'aria-label': 'section', hidden: true })
  const planes = h('div', { class: 'section', role: 'group', 'aria-label': 'plane of a block', hidden: true })
  const status = h('output', { class: 'status', 'aria-live': 'polite' })
  const params = h('section', { class: 'card', 'aria-label': 'parameters' })
  const tree = h('section', { class: 'card tall', 'aria-label': 'model objects' })
  const inspector = h('section', { class: 'card', 'aria-label': 'inspector' })
  const footer = h('footer', { class: 'strip' })
  const left = h('div', { class: 'left' }, editor, grip('messages', 'height of messages', 'horizontal'), messages)
  const stage = h(
    'div',
    { class: 'stage' },
    view,
    toolbar,
    legend,
    h('div', { class: 'sections' }, section, planes),
    sheet,
  )
  const middle = h('div', { class: 'middle' }, tabs, stage, status)
  const panel = (name: string, words: string, part: HTMLElement) =>
    h('div', { class: `panel ${name}` }, h('h2', {}, words), part)
  const right = h(
    'div',
    { class: 'right' },
    panel('of-params', 'Parameters', params),
    panel('of-tree', 'Objects', tree),
    panel('of-inspector', 'Inspector', inspector),
  )
  const body = h(
    'main',
    { class: 'body' },
    left,
    grip('left', 'width of left', 'vertical'),
    middle,
    grip('right', 'width of right', 'vertical'),
    right,
  )
  document.getElementById('app')!.append(header, banner, body, footer)
  resizable(body)

  return {
    file,
    saved,
    historyPlace,
    saveButton,
    paletteButton,
    linkButton,
    exportButton,
    themeButton,
    helpButton,
    editor,
    messages,
    view,
    sheet,
    toolbar,
    tabs,
    legend,
    section,
    planes,
    params,
    tree,
    inspector,
    footer,
    stage,
    right,
    say(words: string): void {
      status.textContent = words
    },
    warn(words: string, ...buttons: HTMLElement[]): void {
      banner.replaceChildren(words, ...buttons)
      banner.hidden = !words
    },
  }
}

/** Light or dark, as the system has it until the button is pressed. */
export function themes(button: HTMLElement, draw: (dark: boolean) => void): void {
  const media = matchMedia('(prefers-color-scheme: dark)')
  let theme = stored<'light' | 'dark' | 'system'>('theme', 'system')
  const isDark = () => (theme === 'system' ? media.matches : theme === 'dark')
  const apply = () => {
    document.documentElement.dataset.theme = isDark() ? 'dark' : 'light'
    draw(isDark())
  }
  media.addEventListener('change', apply)
  button.addEventListener('click', () => {
    theme = isDark() ? 'light' : 'dark'
    store('theme', theme)
    apply()
  })
  apply()
}
