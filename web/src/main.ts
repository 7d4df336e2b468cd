// The workbench: one page in which a model lives.

import './style.css'
import { Analysis } from './analysis'
import { BlockPlanes } from './blocks'
import { Board } from './board'
import type { Standard } from './camera'
import { Desk } from './desk'
import { h, shown, store, stored } from './dom'
import { Editor } from './editor'
import { Foreign } from './foreign'
import type { Frame } from './frame'
import { Hands } from './hands'
import { type Held, historyButtons } from './history'
import { door, Host } from './host'
import { type Link, Newest, Refused, SocketLink, StillLink } from './link'
import { LivingLink, WorkerEngine } from './living'
import { Making } from './making'
import { Cell } from './notebook'
import { GivenNumbers } from './numbers'
import { Orientation } from './orientation'
import { type Command, help, palette } from './palette'
import { type Actions, inspectorPanel, messagesPanel, parametersPanel, strip, treePanel } from './panels'
import { type SheetName, Sheets } from './sheets'
import { startPage } from './start'
import { changed, model, on } from './state'
import { typed } from './typed'
import { type Paint, type Style, View } from './view'

const nonce = document.querySelector<HTMLMetaElement>('meta[name=nonce]')?.content ?? ''
/** The editor that the page is inside of, if any: the text is there. */
let host = null as Host | null
/** The notebook's cell that the page is inside of, if any: it follows the text. */
let cell = null as Cell | null
let inCell = false

/** The link: a server has an engine; a file carries its last scene, and an engine where the package has one. */
function linked(): Link & { start(): Promise<void> } {
  const carried = document.getElementById('moldloft-model')
  if (!carried?.textContent) return new SocketLink()
  const { hello, frames, files, host: where, cell: within } = JSON.parse(carried.textContent)
  inCell = within === true
  const api = where ? door() : null
  if (api) {
    host = new Host(api, hello, where)
    document.body.dataset.host = 'editor'
    host.link.onReady = () => {
      document.body.dataset.engine = 'ready'
      showSaved()
    }
    return host.link
  }
  const bytes = (text: string) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer as ArrayBuffer
  const first: Record<string, ArrayBuffer> = Object.fromEntries(
    Object.entries(frames as Record<string, string>).map(([k, v]) => [k, bytes(v)]),
  )
  const part = (id: string) => document.getElementById(id)?.textContent ?? ''
  if (!document.getElementById('moldloft-worker')) return new StillLink(hello, first)
  // A file may start a worker of a blob only.
  const make = () =>
    new Worker(URL.createObjectURL(new Blob([JSON.parse(part('moldloft-worker'))], { type: 'text/javascript' })))
  const beginning = async () => {
    // The engine comes last in the file: what is seen does not wait for it.
    if (document.readyState === 'loading')
      await new Promise((r) => document.addEventListener('DOMContentLoaded', r, { once: true }))
    return { packed: part('moldloft-engine'), name: hello.name, files }
  }
  const living = new LivingLink(hello, first.open ?? null, new WorkerEngine(make, beginning), !inCell)
  living.onReady = () => {
    document.body.dataset.engine = 'ready'
    showSaved()
  }
  return living
}

const link = linked()
const inside = () => host
let selected = ''
let dirty = false
let online = false
let fitted = false
let theirs: string | null = null
const contours = stored('contours', true)
let instance = ''
/** For tests: when frames came, how long they took. */
const stamps: { kind: string; from: number; to: number }[] = []

// The frame of the page.

const $ = <K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, unknown> = {},
  ...children: any[]
) => h(tag, attributes, ...children)
const title = $('h1', {}, 'Moldloft')
const file = $('span', { class: 'file' })
const saved = $('span', { class: 'saved', role: 'status' })
const saveButton = link.local
  ? $('button', { class: 'primary', title: 'The text as a file (Ctrl+S)' }, 'Download')
  : $('button', { class: 'primary', title: 'Write the text to the file (Ctrl+S)' }, 'Save')
const paletteButton = $('button', { title: 'All commands (Ctrl+K)' }, 'Commands', $('kbd', {}, 'Ctrl K'))
const exportButton = $('button', { title: 'Picture, meshes, curves, panels' }, 'Export')
const themeButton = $('button', { class: 'icon', 'aria-label': 'light or dark', title: 'Light or dark' }, '◐')
const helpButton = $('button', { class: 'icon', 'aria-label': 'help', title: 'Help (F1)' }, '?')
const header = $(
  'header',
  { class: 'top' },
  title,
  file,
  saved,
  $('span', { class: 'history-place' }),
  $('span', { class: 'grow' }),
  paletteButton,
  exportButton,
  link.still ? '' : saveButton,
  themeButton,
  helpButton,
)
const banner = $('div', { class: 'banner', hidden: true, role: 'alert' })
const editorHost = $('div', { class: 'editor' })
const messagesHost = $('section', { class: 'messages', 'aria-label': 'messages' })
const viewHost = $('div', { class: 'view' })
const sheetHost = $('div', { class: 'sheet', hidden: true, tabindex: 0 })
const toolbar = $('div', { class: 'toolbar', role: 'toolbar', 'aria-label': 'view' })
const tabs = $('div', { class: 'tabs', role: 'tablist', 'aria-label': 'what is shown' })
const legend = $('div', { class: 'legend', hidden: true })
const section = $('div', { class: 'section', hidden: true })
const planesHost = $('div', { class: 'section', role: 'group', 'aria-label': 'plane of a block', hidden: true })
const status = $('output', { class: 'status', 'aria-live': 'polite' })
const params = $('section', { class: 'card', 'aria-label': 'parameters' })
const tree = $('section', { class: 'card tall', 'aria-label': 'model objects' })
const inspector = $('section', { class: 'card', 'aria-label': 'inspector' })
const footer = $('footer', { class: 'strip' })
const left = $(
  'div',
  { class: 'left' },
  editorHost,
  $('div', {
    class: 'grip row',
    'data-size': 'messages',
    role: 'separator',
    'aria-orientation': 'horizontal',
    tabindex: 0,
    'aria-label': 'height of messages',
  }),
  messagesHost,
)
const middle = $(
  'main',
  { class: 'middle' },
  tabs,
  $(
    'div',
    { class: 'stage' },
    viewHost,
    toolbar,
    legend,
    $('div', { class: 'sections' }, section, planesHost),
    sheetHost,
  ),
  status,
)
const right = $(
  'div',
  { class: 'right' },
  ...[
    ['Parameters', params],
    ['Objects', tree],
    ['Inspector', inspector],
  ].map(([words, part]) => $('div', { class: 'panel' }, $('h2', {}, words), part)),
)
const grip = (side: string) =>
  $('div', {
    class: 'grip',
    'data-size': side,
    role: 'separator',
    'aria-orientation': 'vertical',
    tabindex: 0,
    'aria-label': `width of ${side}`,
  })
const body = $('div', { class: 'body' }, left, grip('left'), middle, grip('right'), right)
document.getElementById('app')!.append(header, banner, body, footer)

function say(words: string): void {
  status.textContent = words
}

function warn(words: string, ...buttons: HTMLElement[]): void {
  banner.replaceChildren(words, ...buttons)
  banner.hidden = !words
}

// Theme and sizes.

const media = matchMedia('(prefers-color-scheme: dark)')
let theme = stored<'light' | 'dark' | 'system'>('theme', 'system')
const isDark = () => (theme === 'system' ? media.matches : theme === 'dark')
const sizes = stored<Record<string, number>>('sizes', { left: 420, right: 300, messages: 130 })
function resize(): void {
  for (const [name, size] of Object.entries(sizes)) document.documentElement.style.setProperty(`--${name}`, `${size}px`)
}
resize()
for (const g of document.querySelectorAll<HTMLElement>('.grip')) {
  const name = g.dataset.size!
  const limits = (x: number) => Math.max(name === 'messages' ? 60 : 180, Math.min(name === 'messages' ? 500 : 900, x))
  const put = (x: number) => {
    sizes[name] = limits(x)
    resize()
    store('sizes', sizes)
  }
  g.addEventListener('pointerdown', (e) => {
    g.setPointerCapture(e.pointerId)
    const [from, size] = [name === 'messages' ? e.clientY : e.clientX, sizes[name]]
    const move = (m: PointerEvent) =>
      put(size + (name === 'messages' ? from - m.clientY : (name === 'right' ? -1 : 1) * (m.clientX - from)))
    g.addEventListener('pointermove', move)
    g.addEventListener('pointerup', () => g.removeEventListener('pointermove', move), { once: true })
  })
  g.addEventListener('keydown', (e) => {
    const by = { ArrowLeft: -20, ArrowUp: 20, ArrowRight: 20, ArrowDown: -20 }[e.key]
    if (by) put(sizes[name] + (name === 'right' ? -by : by))
  })
}

// The picture.

const view = new View(viewHost)
const canvas = view.canvas
canvas.tabIndex = 0
canvas.setAttribute('role', 'application')
canvas.setAttribute('aria-label', 'model')
canvas.setAttribute('aria-describedby', 'selection')
const selection = $('span', { class: 'sr', id: 'selection' })
viewHost.append(selection)

function applyTheme(): void {
  document.documentElement.dataset.theme = isDark() ? 'dark' : 'light'
  view.theme(isDark())
}
media.addEventListener('change', applyTheme)
themeButton.addEventListener('click', () => {
  theme = isDark() ? 'light' : 'dark'
  store('theme', theme)
  applyTheme()
})

const orientation = new Orientation(
  view.camera,
  (name) => look(name),
  () => view.height,
)
viewHost.parentElement!.append(orientation.element)
canvas.addEventListener('pointermove', (e) => orientation.hover(e))
view.onFrame = () => {
  orientation.draw()
  hands.drawn()
}

// What the page does.

const setting = new Newest<Record<string, number>>(
  async (values) => {
    const from = performance.now()
    try {
      await link.ask('set', { values })
      stamps.push({ kind: 'set', from, to: performance.now() })
    } catch (error) {
      if (error instanceof Refused && error.message !== 'superseded') say(error.message)
    }
  },
  (a, b) => ({ ...a, ...b }),
)

/** One after the other: the engine must have what the last one wrote before it writes the next. */
let writing: Promise<void> = Promise.resolve()
function edits(kind: string, fields: Record<string, unknown>, name: string): Promise<void> {
  writing = writing.then(() => written(kind, fields, name))
  return writing
}

/** Values of parameters that the text computes from others, while they are held. */
const held = new Map<string, number>()

async function written(kind: string, fields: Record<string, unknown>, name: string): Promise<void> {
  try {
    await editor.synced()
    await setting.settled()
    const { head } = await link.ask(kind, fields)
    const now = (head.kept ?? []).map((n: string) => ({
      name: n,
      from: held.get(n) ?? null,
      to: model.params.find((p) => p.name === n)?.value ?? null,
    }))
    const news = now.filter((one: Held) => one.from !== one.to)
    for (const one of news) if (one.to !== null) held.set(one.name, one.to)
    editor.apply(head.edits ?? [], head.version, name, news)
    if (news.length)
      say(
        `${news.map((one: Held) => one.name).join(', ')} follows from an expression: the value holds for this session and is not in the text`,
      )
  } catch (error) {
    say((error as Error).message)
  }
}

/** What waits for the hand to rest. */
let rests: { name: string; run: () => Promise<void>; timer: number } | null = null
const REST = 600
function rested(): Promise<void> {
  const one = rests
  rests = null
  if (one) clearTimeout(one.timer)
  return one ? one.run() : Promise.resolve()
}

function values(list: Record<string, number>): string {
  const one = ([n, x]: [string, number]) => {
    const was = model.params.find((p) => p.name === n)?.value
    return was === undefined ? `${n}: ${shown(x)}` : `${n}: ${shown(was)} → ${shown(x)}`
  }
  return Object.entries(list).map(one).join(', ')
}

/** Steps of the history, back or, with a negative count, again; what is under way is a step, too. */
function turn(count: number): void {
  if (host) return host.undo(count > 0)
  if (link.still) return
  if (hands.busy) {
    hands.cancel()
    if (count > 0) return
  }
  void rested()
  // Between what was written before the key and what is written after it.
  writing = writing.then(async () => {
    await hands.settled()
    const back = count > 0
    const step = (back ? editor.steps.done : editor.steps.undone).at(-1)
    const gone = editor.steps.go(editor.view, count)
    say(
      !gone
        ? `Nothing to ${back ? 'undo' : 'redo'}`
        : `${back ? 'Undone' : 'Redone'}: ${gone > 1 ? `${gone} steps` : step}`,
    )
  })
}

function revert(): void {
  void rested()
  writing = writing.then(async () => {
    try {
      await hands.settled()
      await editor.synced()
      const { text } = await link.tell({ kind: 'revert' })
      editor.replace(text, false, false, 'Revert to the saved file')
      say('Reverted to the saved file; Ctrl+Z takes it back')
      warn('')
    } catch (error) {
      say((error as Error).message)
    }
  })
}

const hidden = new Set<string>(stored<string[]>('hidden', []))
const inspecting = new Newest<() => Promise<void>>((run) => run())
const actions: Actions & { hidden: Set<string>; selected: () => string } = {
  still: link.still,
  hidden,
  selected: () => selected,
  set: (name, value) => setting.push({ [name]: value }),
  typed: (text) => typed(text, link),
  rested,
  rest(name, run) {
    if (rests && rests.name !== name) void rested()
    if (rests) clearTimeout(rests.timer)
    rests = { name, run, timer: window.setTimeout(() => void rested(), REST) }
  },
  write: (list, name) => edits('write', { values: list }, name ?? values(list)),
  say,
  hover(name) {
    if (view.hovered === name) return
    view.hovered = name
    view.settle()
  },
  select(name, from) {
    if ((from === 'view' || from === 'tree') && making.pick(name)) return
    if (name !== selected) {
      selected = view.selected = name
      const o = model.objects.find((k) => k.name === name)
      selection.textContent = o ? `${o.name}, ${o.kind}` : name
      view.settle()
      changed('selection')
    }
    if (from !== 'text') void locate(name, false)
  },
  locate: (name) => locate(name, true),
  show: (place) => editor.show(place, true),
  apply: (list, version, name) => editor.apply(list, version, name),
  async rewrite(kind, fields, name) {
    await rested()
    await edits(kind, fields, name)
  },
  toggle(name) {
    const o = model.objects.find((k) => k.name === name)
    if (o && !o.shown) {
      say(`${name} is hidden by the program (visible = 0)`)
      return
    }
    if (!hidden.delete(name)) hidden.add(name)
    hide()
  },
  ghost: (on) => view.ghost(on),
  isolate(name) {
    hidden.clear()
    if (name) for (const o of model.objects) if (o.name !== name) hidden.add(o.name)
    hide()
  },
  async inspect(name, by) {
    let found: any = null
    inspecting.push(async () => {
      const { head } = await link.ask('inspect', by ? { name, by } : { name })
      found = head
    })
    await inspecting.settled().catch(() => undefined)
    return found
  },
  watch(expressions) {
    store(`watch.${model.name}`, expressions)
    void link.ask('watch', { expressions }).catch((error) => say(error.message))
  },
}

/** The control polygons of the selected curve, or of those that the selected point is in. */
function polygons(): void {
  const points = new Map([...view.items.values()].filter((i) => i.kind === 'point').map((i) => [i.object, i]))
  const near = model.objects.filter(
    (o) =>
      (o.class === 'curve' || o.class === 'snake') &&
      o.parents.length > 2 &&
      (o.name === selected || o.parents.includes(selected)),
  )
  const runs = near.map((o) =>
    o.parents.flatMap((p) => {
      const item = points.get(p)
      return item && view.seen(item) ? view.place(item).toArray() : []
    }),
  )
  view.overlay('polygon', runs.length ? runs : null, 0x8a94a0, 1)
}
on(['selection', 'rev'], polygons)

async function locate(name: string, focus: boolean): Promise<void> {
  if (!name || link.still) return editor.show(null)
  try {
    const { head } = await link.ask('locate', { name })
    editor.show(head.place ?? null, focus)
  } catch {
    editor.show(null)
  }
}

function hide(): void {
  view.hidden = hidden
  store('hidden', [...hidden])
  view.settle()
  changed('objects')
}
view.hidden = hidden

const editor = new Editor(editorHost, link, nonce.startsWith('__') ? '' : nonce, [
  { key: 'Mod-s', run: () => (void save(), true) },
  { key: 'Mod-k', run: () => (openPalette(), true) },
  { key: 'Mod-z', run: () => (turn(1), true) },
  { key: 'Mod-Shift-z', run: () => (turn(-1), true) },
  { key: 'Mod-y', run: () => (turn(-1), true) },
])
editor.steps.onHeld = ({ name, to }) => {
  if (to === null) held.delete(name)
  else held.set(name, to)
  // The engine gives up all that the text does not state, and takes again what is still held.
  writing = writing
    .then(async () => {
      await editor.synced()
      if (to === null) await link.ask('reset')
      if (held.size) await link.ask('write', { values: Object.fromEntries(held) })
    })
    .catch((error) => say(error.message))
}
header.querySelector('.history-place')!.replaceWith(link.still ? '' : historyButtons(editor.steps, turn, !host))
editor.onTrouble = (words) => say(words)
editor.onPending = () => showSaved()
let cursorTimer = 0
editor.onCursor = (offset) => {
  clearTimeout(cursorTimer)
  cursorTimer = window.setTimeout(() => {
    // The text may be shorter than it was when the cursor stood there.
    const word = offset > editor.view.state.doc.length ? null : editor.view.state.wordAt(offset)
    const name = word ? editor.view.state.sliceDoc(word.from, word.to) : ''
    if (name && name !== selected && model.objects.some((o) => o.name === name)) actions.select(name, 'text')
  }, 120)
}

const hands = new Hands(view, link, viewHost, {
  select: (name) => actions.select(name, 'view'),
  hover: actions.hover,
  say,
  status: say,
  apply: (list, version, name) => editor.apply(list, version, name),
  synced: () => editor.synced(),
  open: (name) => void locate(name, true),
  place: (at, grain) => making.place(at, grain),
  corner: (e) => orientation.click(e),
})
const making = new Making(right, link, {
  say,
  select: (name) => actions.select(name, 'text'),
  apply: (list, version, name) => editor.apply(list, version, name),
  synced: () => editor.synced(),
})
const start = startPage({
  begin: (text, name, reach) => {
    // An empty scene is looked at from where its first points will be.
    fitted = reach !== undefined
    if (reach) Object.assign(view.camera, { reach, target: view.camera.target.set(0, 0, 0) })
    view.draw()
    editor.replace(text, false, false, name)
  },
  add: (kind) => void editor.synced().then(() => making.open(kind)),
})
viewHost.parentElement!.append(start)
editor.steps.onText = () => (start.hidden = link.still || editor.text.trim() !== '' || /\.skt$/i.test(model.name))
const board = new Board(link, editor, say)
const desk = new Desk(link, editor, say, give)
viewHost.parentElement!.append(board.element, desk.element)
const sheets = new Sheets(sheetHost, link, actions)
parametersPanel(params, actions)
treePanel(tree, actions)
inspectorPanel(inspector, actions)
messagesPanel(messagesHost, actions)
strip(
  footer,
  actions,
  (host) =>
    new GivenNumbers(host, link, {
      say,
      write: actions.write,
      typed: actions.typed,
      reset: async () => {
        await link.ask('reset')
        if (held.size) await link.ask('write', { values: Object.fromEntries(held) })
      },
    }),
)

function showSaved(): void {
  const waits = editor.pending
  if (host) {
    saved.textContent = document.body.dataset.engine === 'ready' ? '' : 'the engine starts…'
    return
  }
  if (link.local && !link.still) {
    const running = document.body.dataset.engine === 'ready'
    saved.textContent = !running
      ? 'the engine starts…'
      : !dirty
        ? 'as it was'
        : keeps()
          ? 'changed, kept in this browser'
          : 'changed, not saved'
    saved.dataset.state = dirty ? 'dirty' : 'saved'
    return
  }
  saved.textContent = link.still
    ? 'as it was'
    : !online
      ? waits
        ? 'not connected: what you type is kept in this page'
        : 'not connected'
      : waits
        ? 'sending…'
        : dirty
          ? 'draft kept, not in the file'
          : 'saved'
  saved.dataset.state = !online ? 'off' : dirty || waits ? 'dirty' : 'saved'
}

/** Whether this browser keeps what is stored: one without storage forgets. */
function keeps(): boolean {
  store('keeps', true)
  return stored('keeps', false)
}

async function save(force = false): Promise<void> {
  if (host) return host.save()
  try {
    await rested()
    await writing
    await editor.synced()
    const answer = await link.tell({ kind: 'save', force })
    if (link.local) return give(new Blob([answer.text], { type: 'text/plain' }), model.name)
    if (answer.kind === 'conflict') conflict(answer.theirs)
    else {
      dirty = false
      say('Saved')
    }
  } catch (error) {
    say((error as Error).message)
  }
  showSaved()
}

function conflict(text: string): void {
  theirs = text
  const lines = (t: string) => t.split('\n').length
  warn(
    `The file was changed by another program (${lines(text)} lines there, ${lines(editor.text)} here), and there are changes here, too. `,
    $('button', { onclick: () => void save(true).then(() => warn('')) }, 'Keep mine, write the file'),
    $('button', { onclick: revert }, 'Take theirs'),
    $('button', { onclick: () => compare() }, 'Show both'),
  )
}

function compare(): void {
  const dialog = $(
    'dialog',
    { class: 'compare', 'aria-label': 'both texts' },
    $('h3', {}, 'The file'),
    $('pre', {}, theirs ?? ''),
    $('h3', {}, 'Here'),
    $('pre', {}, editor.text),
    $('button', { onclick: () => dialog.close() }, 'Close'),
  )
  document.body.append(dialog)
  dialog.addEventListener('close', () => dialog.remove())
  dialog.showModal()
}

// What comes.

function take(frame: Frame): void {
  const { head } = frame
  const facts: [string, keyof typeof model, Parameters<typeof changed>[0]][] = [
    ['params', 'params', 'params'],
    ['objects', 'objects', 'objects'],
    ['diagnostics', 'faults', 'faults'],
    ['printed', 'printed', 'printed'],
    ['watched', 'watched', 'watched'],
  ]
  if (head.unit !== undefined) model.unit = head.unit
  if (head.program !== undefined) model.program = head.program
  const scene = view.take(frame)
  for (const [key, name, topic] of facts) {
    if (head[key] === undefined) continue
    ;(model as any)[name] = head[key]
    changed(topic)
  }
  if (head.diagnostics) editor.diagnose(model.faults)
  if (scene && !fitted && !view.box.isEmpty()) {
    fitted = true
    view.fit()
  }
  if (head.rev !== undefined && head.rev !== model.rev && head.watched === undefined && model.watched.length) measure()
  if (scene) {
    analysis.refresh()
    foreign.refresh()
  }
  if (head.rev !== undefined && head.rev !== model.rev) planes.refresh()
  if (head.rev !== undefined && head.rev !== model.rev) {
    model.rev = head.rev
    changed('rev')
  }
  document.body.dataset.state = 'alive'
}

// Watched numbers follow the scene: at once while they are quick, else now and then, slow ones when the hand rests:
// a slider that moves does not wait for them.
let took = 0
let resting = 0
const measuring = new Newest<void>(async () => {
  const from = performance.now()
  await link.ask('measure').catch(() => undefined)
  took = performance.now() - from
})
function measure(): void {
  if (took < 4) return measuring.push(undefined)
  if (took < 60 && resting) return
  clearTimeout(resting)
  resting = window.setTimeout(() => {
    resting = 0
    measuring.push(undefined)
  }, 150)
}

link.onFrame = take
link.onState = (state) => {
  online = state === 'up'
  if (!online) {
    editor.offline()
    if (!link.still) warn('The server does not answer. What you type is kept here and sent when it is back.')
  }
  showSaved()
}
link.onMessage = (message) => {
  switch (message.kind) {
    case 'hello':
      void begin(message)
      break
    case 'updates':
      dirty = message.dirty
      editor.received(message.updates, message.from)
      board.refresh()
      cell?.changed()
      showSaved()
      break
    case 'saved':
      dirty = !!message.dirty
      showSaved()
      break
    case 'conflict':
      conflict(message.theirs)
      break
    case 'engine':
      if (message.state === 'lost') warn(`The engine was stopped: ${message.reason}. Your text is safe.`)
      else {
        warn('')
        if (held.size) void link.ask('write', { values: Object.fromEntries(held) }).catch(() => undefined)
        if (!link.local)
          void link.ask('watch', { expressions: model.watched.map((w) => w.expression) }).catch(() => undefined)
        void foreign.again()
      }
      break
    case 'full':
      warn(message.error)
      break
  }
}

async function begin(hello: any): Promise<void> {
  warn('')
  const again = instance !== ''
  instance = hello.instance ?? 'still'
  model.name = hello.name
  file.textContent = hello.name
  document.title = `${hello.name} · Moldloft`
  dirty = hello.dirty
  editor.begin(hello.text, hello.version, again)
  editor.steps.onText()
  if (inCell) cell ??= new Cell(editor)
  if (hello.words) editor.words(hello.words)
  if (hello.watched) {
    model.watched = hello.watched
    changed('watched')
  }
  if (!link.local && !tabs.querySelector('[data-sheet=desk]')) tabs.append(tab('desk', 'Fairing desk'))
  if (!link.local && /\.skt$/i.test(hello.name) && !tabs.querySelector('[data-sheet=board]')) {
    tabs.append(tab('board', 'Drawing board'))
    if (!/^\s*SKETCH/im.test(hello.text)) sheet('board')
  }
  if (hello.recovered)
    say(
      'Unsaved changes of an earlier session are back. Save keeps them; “Revert to the saved file” in the commands drops them.',
    )
  if (hello.dropped) say(`This page was disconnected: ${hello.dropped}. It shows the newest state.`)
  showSaved()
  try {
    // A file's own scene is there at once; a server's is asked for with all that is to be drawn.
    if (link.local) await link.ask('open')
    if (!link.still) await link.ask('show', { contours })
    if (!link.local) await link.ask('open')
    // A model that is mirrored in its middle plane and crosses z = 0 floats; of others the hydrostatics mean nothing.
    const floats = view.mirrored.includes('y') && view.box.min.z < 0 && view.box.max.z > 0
    const usual = ![...view.items.values()].some((i) => i.kind === 'patch')
      ? []
      : floats
        ? ['mesh.area', 'hydrostatics.volume', 'hydrostatics.lcb', 'hydrostatics.kmt']
        : ['mesh.area', 'mesh.volume']
    const watched = stored<string[]>(`watch.${model.name}`, usual)
    if (!link.still) await link.ask('watch', { expressions: watched })
    if (!again && !link.still) formats = (await link.ask('formats')).head.formats
    if (!again && !hello.words && !link.still) editor.words((await link.ask('words')).head.words)
  } catch (error) {
    if (error instanceof Refused) say(error.message)
  }
}

const planes = new BlockPlanes(planesHost, view, link, { say, legend: () => analysis.legend() })
const foreign = new Foreign(view, link, { say, legend: () => analysis.legend() })
const analysis = new Analysis(view, link, legend, section, {
  say,
  painted: () => buildToolbar(),
  other: () =>
    foreign.scale
      ? { scale: foreign.scale, name: `deviation, ${model.unit}` }
      : planes.scale && { scale: planes.scale, name: 'scaled Jacobian' },
})
viewHost.addEventListener('dragover', (e) => e.preventDefault())
viewHost.addEventListener('drop', (e) => {
  e.preventDefault()
  if (!link.still) for (const f of e.dataTransfer?.files ?? []) void foreign.lay(f)
})

// Commands: one table for buttons, keys and the palette.

/** The formats of the engine: names, and what they hold. */
let formats: [string, string][] = []
const openPalette = (words = '') =>
  palette(
    [
      ...commands(),
      ...model.objects
        .slice(0, 2000)
        .map((o) => ({ name: `Select ${o.name}`, keys: o.kind, run: () => actions.select(o.name, 'tree') })),
    ],
    words,
  )

const looks: [Standard, string, string][] = [
  ['iso', 'Isometric', '1'],
  ['profile', 'Profile', '2'],
  ['plan', 'Plan', '3'],
  ['body', 'Body plan from the bow', '4'],
  ['stern', 'From the stern', '5'],
  ['starboard', 'Profile from the other side', '6'],
  ['bottom', 'From below', '7'],
]
const styles: [Style, string, string][] = [
  ['shaded', 'Shaded with panels', 'S'],
  ['panels', 'Panels', 'P'],
  ['smooth', 'Smooth', 'A'],
  ['wire', 'Wireframe', 'W'],
  ['xray', 'X-ray', 'R'],
]
const look = (name: Standard) => {
  view.camera.look(name)
  view.fit()
}
const setStyle = (s: Style) => {
  view.style = s
  view.settle()
  buildToolbar()
}
const layer = (kind: string) => {
  view.layers[kind] = !view.layers[kind]
  view.settle()
  buildToolbar()
}

async function download(kind: string): Promise<void> {
  try {
    const stem = model.name.replace(/\.\w+$/, '')
    if (kind === 'png') {
      const blob = await view.picture()
      if (blob) give(blob, `${stem}.png`)
      return
    }
    const frame = await link.ask('export', { format: kind, stem })
    for (const part of frame.head.files)
      give(new Blob([frame.bytes(part).slice()]), String(part.name).split(/[/\\]/).pop() ?? 'model')
  } catch (error) {
    say((error as Error).message)
  }
}
function give(blob: Blob, name: string): void {
  if (host) return void host.give(blob, name)
  const a = $('a', { download: name })
  a.href = URL.createObjectURL(blob)
  a.click()
  setTimeout(() => URL.revokeObjectURL(a.href), 10_000)
}

const SHEETS: [SheetName, string][] = [
  ['model', 'Model'],
  ['lines', 'Lines plan'],
  ['hydrostatics', 'Hydrostatics'],
  ['areas', 'Section areas'],
  ['mesh', 'Mesh'],
  ['graph', 'Dependencies'],
  ['curvature', 'Curvature'],
]
function sheet(name: SheetName | 'board' | 'desk'): void {
  sheets.show(name === 'board' || name === 'desk' ? 'model' : name)
  board.show(name === 'board')
  desk.show(name === 'desk')
  toolbar.hidden = name !== 'model'
  for (const t of tabs.querySelectorAll('[role=tab]'))
    t.setAttribute('aria-selected', String((t as HTMLElement).dataset.sheet === name))
}

function commands(): Command[] {
  return [
    { name: link.local ? 'Download the text' : 'Save', keys: 'Ctrl+S', run: () => void save() },
    ...(link.still
      ? []
      : [
          { name: 'Undo', keys: 'Ctrl+Z', run: () => turn(1) },
          { name: 'Redo', keys: 'Ctrl+Shift+Z', run: () => turn(-1) },
          { name: link.local ? 'Revert to the text as it came' : 'Revert to the saved file', run: revert },
        ]),
    { name: 'Fit the model', keys: 'F', run: () => view.fit() },
    ...looks.map(([n, words, key]) => ({ name: `View: ${words}`, keys: key, run: () => look(n) })),
    {
      name: 'Perspective or orthographic',
      keys: 'O',
      run: () => ((view.camera.perspective = !view.camera.perspective), view.fit()),
    },
    ...styles.map(([n, words, key]) => ({ name: `Style: ${words}`, keys: key, run: () => setStyle(n) })),
    { name: 'Colour: patches apart', run: () => analysis.paint('patches') },
    { name: 'Colour: of the model', run: () => analysis.paint('model') },
    {
      name: 'Colour: zebra stripes',
      keys: 'Z',
      run: () => analysis.paint(view.paint === 'zebra' ? 'patches' : 'zebra'),
    },
    { name: 'Colour: reflection lines', run: () => analysis.paint('reflection') },
    { name: 'Colour: isophotes', run: () => analysis.paint('isophotes') },
    { name: 'Colour: highlight lines', run: () => analysis.paint('highlight') },
    { name: 'Colour: Gaussian curvature', run: () => analysis.paint('field', 'gaussian_curvature') },
    { name: 'Colour: mean curvature', run: () => analysis.paint('field', 'mean_curvature') },
    { name: 'Colour: largest curvature', run: () => analysis.paint('field', 'largest_curvature') },
    { name: 'Colour: smallest curvature', run: () => analysis.paint('field', 'smallest_curvature') },
    ...['aspect', 'skew', 'warp', 'jump'].map((m) => ({
      name: `Colour: panel ${m}`,
      run: () => analysis.paint('field', m),
    })),
    ...model.params.map((p) => ({
      name: `Colour: motion by ${p.name}`,
      run: () => analysis.paint('field', 'derivative', p.name),
    })),
    ...[
      ['point', 'points', '.'],
      ['curve', 'curves', ','],
      ['contour', 'contours', 'C'],
      ['patch', 'surfaces', ''],
      ['grid', 'grids', ''],
    ].map(([k, w, key]) => ({ name: `Show or hide ${w}`, keys: key, run: () => layer(k) })),
    { name: 'Show or hide the mirror image', keys: 'M', run: () => ((view.mirror = !view.mirror), view.settle()) },
    ...(link.still || !model.program
      ? []
      : [
          { name: 'Add an object', keys: 'Shift+A', run: () => void making.open() },
          {
            name: 'Delete the selected object',
            keys: 'Delete',
            run: () => selected && void actions.rewrite('delete', { name: selected }, `Delete ${selected}`),
          },
          {
            name: 'Duplicate the selected object',
            keys: 'Ctrl+D',
            run: () => selected && void actions.rewrite('duplicate', { name: selected }, `Duplicate ${selected}`),
          },
          {
            name: 'Rename the selected object',
            keys: 'Shift+R',
            run: () => inspector.querySelector<HTMLInputElement>('input.title')?.select(),
          },
        ]),
    { name: 'Hide or show the selected object', keys: 'H', run: () => selected && actions.toggle(selected) },
    { name: 'Isolate the selected object', keys: 'I', run: () => selected && actions.isolate(selected) },
    { name: 'Show all', keys: 'Shift+H', run: () => actions.isolate(null) },
    { name: 'Move the selected point by keys', keys: 'G', run: () => hands.take(selected) },
    {
      name: 'Measure between places',
      keys: 'D',
      run: () => {
        hands.measuring = !hands.measuring
        say(hands.measuring ? 'Measure: click two or three places; D or Esc ends' : '')
        if (!hands.measuring) view.overlay('measure', null)
        buildToolbar()
      },
    },
    { name: 'Lay a mesh or offsets over the model (STL, OBJ, PLY, OFF, GDF, table)', run: () => foreign.choose() },
    { name: 'Remove what lies over the model', run: () => void foreign.remove().catch((e) => say(e.message)) },
    { name: 'Curvature comb of the selected curve', keys: 'K', run: () => analysis.toggleComb(selected) },
    ...[0, 1, 2].map((k) => ({
      name: `Section across ${'xyz'[k]}`,
      keys: `Shift+${'XYZ'[k]}`,
      run: () => analysis.cut(view.clip?.axis === k ? null : k),
    })),
    { name: 'Plane of a volume block, folded cells', keys: 'B', run: () => planes.toggle() },
    ...(link.local
      ? []
      : [
          { name: 'Fairing desk', run: () => sheet('desk') },
          {
            name: 'Fair the selected curve or surface',
            run: () => (sheet('desk'), selected && void desk.open({ object: selected })),
          },
        ]),
    ...SHEETS.map(([n, words], k) => ({ name: `Sheet: ${words}`, keys: `Alt+${k + 1}`, run: () => sheet(n) })),
    { name: 'Go to the program', keys: 'Ctrl+1', run: () => editor.view.focus() },
    { name: 'Go to the model', keys: 'Ctrl+2', run: () => canvas.focus() },
    { name: 'Go to parameters', keys: 'Ctrl+3', run: () => params.querySelector('input')?.focus() },
    {
      name: 'Go to objects',
      keys: 'Ctrl+4',
      run: () => tree.querySelector<HTMLElement>('[role=treeitem][tabindex="0"]')?.focus(),
    },
    { name: 'Format the program', keys: 'Shift+Alt+F', run: () => void editor.format() },
    { name: 'Rename the name at the cursor', keys: 'F2', run: () => void editor.rename() },
    { name: 'Export: picture (PNG)', run: () => void download('png') },
    ...formats.map(([f, about]) => ({ name: `Export: ${f}, ${about}`, run: () => void download(f) })),
    { name: 'Light or dark', run: () => themeButton.click() },
    { name: 'Help', keys: 'F1', run: () => help(commands()) },
  ]
}

function buildToolbar(): void {
  const focus = (document.activeElement as HTMLElement | null)?.getAttribute('aria-label')
  const button = (label: string, words: string, run: () => void, on = false) =>
    $('button', { 'aria-label': words, 'aria-pressed': on, title: words, class: on ? 'on' : '', onclick: run }, label)
  const choice = (name: string, value: string, options: [string, string][], run: (v: string) => void) => {
    const s = $(
      'select',
      { 'aria-label': name, title: name },
      ...options.map(([v, words]) => $('option', { value: v, selected: v === value }, words)),
    )
    s.addEventListener('change', () => run(s.value))
    return s
  }
  const { field, by } = analysis
  const value = view.paint === 'field' ? (field === 'derivative' ? `d:${by}` : field) : view.paint
  toolbar.replaceChildren(
    link.still ? '' : button('+', 'Add an object (Shift+A)', () => void making.open()),
    button('⤢', 'Fit the model (F)', () => view.fit()),
    choice('view', '', [['', 'View'], ...looks.map(([n, w, k]) => [n, `${w}  ${k}`] as [string, string])], (v) => {
      if (v) look(v as Standard)
      buildToolbar()
    }),
    button(
      view.camera.perspective ? '◭' : '▱',
      'Perspective or orthographic (O)',
      () => {
        view.camera.perspective = !view.camera.perspective
        view.fit()
        buildToolbar()
      },
      view.camera.perspective,
    ),
    choice(
      'style',
      view.style,
      styles.map(([n, w]) => [n, w]),
      (v) => setStyle(v as Style),
    ),
    choice(
      'colour',
      value,
      [
        ['patches', 'Patches apart'],
        ['model', 'Colours of the model'],
        ['zebra', 'Zebra'],
        ['reflection', 'Reflection lines'],
        ['isophotes', 'Isophotes'],
        ['highlight', 'Highlight lines'],
        ...(link.still
          ? []
          : ([
              ['gaussian_curvature', 'Gaussian curvature'],
              ['mean_curvature', 'Mean curvature'],
              ['largest_curvature', 'Largest curvature'],
              ['smallest_curvature', 'Smallest curvature'],
              ['aspect', 'Panel aspect'],
              ['skew', 'Panel skewness'],
              ['warp', 'Panel warp'],
              ['jump', 'Jump of panel area'],
              ...model.params.map((p) => [`d:${p.name}`, `Motion by ${p.name}`]),
            ] as [string, string][])),
      ],
      (v) =>
        ['patches', 'model', 'zebra', 'reflection', 'isophotes', 'highlight'].includes(v)
          ? analysis.paint(v as Paint)
          : v.startsWith('d:')
            ? analysis.paint('field', 'derivative', v.slice(2))
            : analysis.paint('field', v),
    ),
    button('•', 'Points (.)', () => layer('point'), view.layers.point),
    button('∿', 'Curves (,)', () => layer('curve'), view.layers.curve),
    button('≋', 'Contours (C)', () => layer('contour'), view.layers.contour),
    button(
      '⇔',
      'Measure (D)',
      () =>
        commands()
          .find((c) => c.keys === 'D')!
          .run(),
      hands.measuring,
    ),
  )
  if (focus) toolbar.querySelector<HTMLElement>(`[aria-label="${CSS.escape(focus)}"]`)?.focus()
}
function tab(name: SheetName | 'board' | 'desk', words: string): HTMLElement {
  return $(
    'button',
    {
      role: 'tab',
      'aria-selected': name === 'model',
      'data-sheet': name,
      onclick: () => sheet(name),
      disabled: link.still && name !== 'model' && name !== 'graph',
    },
    words,
  )
}
for (const [name, words] of SHEETS) tabs.append(tab(name, words))

paletteButton.addEventListener('click', () => openPalette())
exportButton.addEventListener('click', () => openPalette('Export: '))
helpButton.addEventListener('click', () => help(commands()))
saveButton.addEventListener('click', () => void save())

/** The texts of fields when the focus came to them. */
const came = new WeakMap<HTMLInputElement, string>()
addEventListener('focusin', (e) => {
  if (e.target instanceof HTMLInputElement && e.target.type !== 'range') came.set(e.target, e.target.value)
})
addEventListener('keydown', (e) => {
  const target = e.target as HTMLElement
  const typing = target.closest('input, select, textarea, .cm-editor, dialog') !== null
  const name = `${e.ctrlKey || e.metaKey ? 'Ctrl+' : ''}${e.altKey ? 'Alt+' : ''}${e.shiftKey && e.key.length === 1 && /[a-z]/i.test(e.key) ? 'Shift+' : ''}${e.key.length === 1 ? e.key.toUpperCase() : e.key}`
  if (name === 'Ctrl+K') {
    if (e.defaultPrevented) return
    e.preventDefault()
    return openPalette()
  }
  const turns: Record<string, number> = { 'Ctrl+Z': 1, 'Ctrl+Shift+Z': -1, 'Ctrl+Y': -1 }
  if (name in turns) {
    // A field with something typed in it takes that back first.
    const field = target.closest('input')
    if (e.defaultPrevented || target.closest('dialog') || (field && (came.get(field) ?? field.value) !== field.value))
      return
    e.preventDefault()
    return turn(turns[name])
  }
  const command = commands().find((c) => c.keys === name)
  if (e.key === 'Escape' && !typing) {
    if (hands.busy) hands.cancel()
    else if (making.isOpen) making.close()
    else if (hands.measuring)
      commands()
        .find((c) => c.keys === 'D')!
        .run()
    else if (view.clip) analysis.cut(null)
    else if (planes.shown) planes.close()
    else actions.select('', 'view')
    return
  }
  if (!command || e.defaultPrevented || hands.busy) return
  const plain = !e.ctrlKey && !e.metaKey && !e.altKey && !/^F\d/.test(e.key)
  if (plain && (typing || target.closest('[role=tree]'))) return
  if (typing && target.closest('dialog')) return
  e.preventDefault()
  command.run()
})
addEventListener('beforeunload', (e) => {
  if (editor.pending) e.preventDefault()
})

applyTheme()
buildToolbar()
showSaved()
// The engine's words for parameters come with the first scene.
let known = ''
setInterval(() => {
  const now = model.params.map((p) => p.name).join()
  if (now !== known) {
    known = now
    buildToolbar()
  }
}, 500)

/** For tests: numbers of the picture, never a way to change it. */
Object.assign(window, {
  moldloft: {
    stamps,
    model,
    project: (name: string) => {
      const item = [...view.items.values()].find((i) => i.object === name && i.kind === 'point')
      if (!item) return null
      const box = canvas.getBoundingClientRect()
      const [x, y] = view.project(view.place(item))
      return [box.left + x, box.top + y]
    },
    items: () =>
      [...view.items.values()].map((i) => ({
        name: i.name,
        object: i.object,
        kind: i.kind,
        stale: i.stale,
        vertices: i.position.length / 3,
        seen: view.seen(i),
      })),
    positions: (object: string) =>
      [...view.items.values()].filter((i) => i.object === object).flatMap((i) => Array.from(i.position)),
    text: () => editor.text,
    board,
    desk,
    steps: () => ({ done: [...editor.steps.done], undone: [...editor.steps.undone] }),
    settled: async () => {
      await rested()
      await hands.settled()
      await editor.synced()
      await setting.settled()
      await writing
    },
    camera: () => ({ azimuth: view.camera.azimuth, elevation: view.camera.elevation, reach: view.camera.reach }),
    camera_set: (azimuth: number, elevation: number) => {
      Object.assign(view.camera, { azimuth, elevation })
      view.fit()
    },
  },
})

if (inCell) document.body.dataset.host = 'cell'
inside()?.begin({ editor: () => editor, say, cursor: (offset) => editor.onCursor(offset) })
void link.start().catch((error) => warn(error.message))
