// The workbench: one page in which a model lives.

import './style.css'
import { Analysis } from './analysis'
import type { App, TabName } from './app'
import { BlockPlanes } from './blocks'
import { Changes, valuesInWords } from './changes'
import { ink } from './colour'
import { commands, SHEETS } from './commands'
import { connected } from './connection'
import { h, store, stored } from './dom'
import { Editor, isSketch } from './editor'
import { FileTabs } from './file_tabs'
import { copyLink, download, give, installDrop, openFiles, openLink } from './files'
import { Foreign } from './foreign'
import type { Frame } from './frame'
import { Hands } from './hands'
import { historyButtons } from './history'
import { installKeys } from './keys'
import { Newest, Refused } from './link'
import { Making } from './making'
import { Cell } from './notebook'
import { GivenNumbers } from './numbers'
import { Orientation } from './orientation'
import { help, palette } from './palette'
import { inspectorPanel, messagesPanel, parametersPanel, strip } from './panels'
import { Preview } from './preview'
import { triangles } from './probe'
import type { ValueFact } from './protocol'
import { Rooms } from './rooms'
import { Saving } from './saving'
import { SectionPlane } from './section'
import { Sheets } from './sheets'
import { makeShell, themes } from './shell'
import { startPage } from './start'
import { changed, model, on } from './state'
import { tablesOf, tablesSheet } from './tables'
import { buildToolbar } from './toolbar'
import { treePanel } from './tree'
import { typed } from './typed'
import { floats, IMMERSED, usualNumbers, usualOf } from './usual'
import { View } from './view'

const nonce = document.querySelector<HTMLMetaElement>('meta[name=nonce]')?.content ?? ''
const { link, host, inCell } = connected(() => saving.show())
const shell = makeShell(link)
const { say, warn } = shell
/** The notebook's cell that the page is inside of, if any: it follows the text. */
let cell: Cell | null = null
let selected = ''
/** True while a hand holds a slider or a number. */
let held = false
let fitted = false
let instance = ''
const contours = stored('contours', true)

// The picture.

const view = new View(shell.view)
const canvas = view.canvas
Object.assign(view.ground, stored('ground', { water: true, grid: false }))
canvas.tabIndex = 0
canvas.setAttribute('role', 'application')
canvas.setAttribute('aria-label', 'model')
canvas.setAttribute('aria-describedby', 'selection')
const selection = h('span', { class: 'sr', id: 'selection' })
shell.view.append(selection)
view.covered = () => (shell.toolbar.hidden ? 0 : shell.toolbar.offsetTop + shell.toolbar.offsetHeight)
const orientation = new Orientation(
  () => view.camera,
  (name) => app.look(name),
  () => view.height,
)
shell.view.append(orientation.element)
canvas.addEventListener('pointermove', (e) => orientation.hover(e))
view.onFrame = () => {
  orientation.draw()
  hands.drawn()
  section.placed()
}

// What the page does.

const preview = new Preview(link)
const changes = new Changes(link, preview, host, say, warn)
const saving = new Saving(link, host, shell, changes, (blob, name) => give(app, blob, name))
const hidden = new Set<string>()
const inspecting = new Newest<() => Promise<void>>((run) => run())

const actions: App['actions'] = {
  still: link.still,
  hidden,
  selected: () => selected,
  set: (name, value) => changes.set(name, value),
  typed: (text) => typed(text, link),
  rested: () => changes.rested(),
  rest: (name, run) => changes.rest(name, run),
  write: (list, name) => changes.edits('write', { values: list }, name ?? valuesInWords(list)),
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
  show: (place, file) => void (file ? files.show(file, place) : files.show('').then(() => editor.show(place, true))),
  apply: (list, version, name) => editor.apply(list, version, name),
  async rewrite(kind, fields, name) {
    await changes.rested()
    await changes.edits(kind, fields, name)
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
  ghost: (on) => {
    held = on
    view.ghost(on)
  },
  fair: link.local ? null : (name) => void fair(name),
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
  view.overlay('polygon', runs.length ? runs : null, ink('guide'), 1)
}
on(['selection', 'rev'], polygons)

async function locate(name: string, focus: boolean): Promise<void> {
  if (!name || link.still) return editor.show(null)
  try {
    const { head } = await link.ask('locate', { name })
    if (focus && head.elsewhere) return void files.show(head.elsewhere.file, head.elsewhere.place)
    if (focus) await files.show('')
    editor.show(head.place ?? null, focus)
  } catch {
    editor.show(null)
  }
}

/** What is hidden, by the name of the model. */
function hide(): void {
  store(`hidden.${model.name}`, [...hidden])
  view.settle()
  changed('objects')
}
view.hidden = hidden

async function fair(object: string): Promise<void> {
  await sheet('desk')
  await (await rooms.load('desk')).open({ object })
}

// The parts.

const editorNonce = nonce.startsWith('__') ? '' : nonce
const editorKeys = [
  { key: 'Mod-s', run: () => (void saving.save(), true) },
  { key: 'Mod-k', run: () => (app.openPalette(), true) },
  { key: 'Mod-z', run: () => (changes.turn(1), true) },
  { key: 'Mod-Shift-z', run: () => (changes.turn(-1), true) },
  { key: 'Mod-y', run: () => (changes.turn(-1), true) },
]
const editor = new Editor(shell.editor, link, editorNonce, editorKeys)
let words: Record<string, string[]> = {}
const files = new FileTabs(shell.editor, link, editor, {
  say,
  make(place, file) {
    const made = new Editor(place, link, editorNonce, editorKeys, editor.steps, file)
    made.words(words)
    made.onTrouble = say
    made.onPending = () => saving.show()
    return made
  },
  saved: () => saving.show(),
})
changes.editor = editor
changes.files = saving.files = files
editor.steps.onHeld = (held) => changes.holds(held)
shell.historyPlace.replaceWith(link.still ? '' : historyButtons(editor.steps, (n) => changes.turn(n), !host))
editor.onTrouble = say
editor.onPending = () => saving.show()
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

const hands = new Hands(view, link, preview, shell.view, {
  select: (name) => actions.select(name, 'view'),
  hover: actions.hover,
  say,
  status: say,
  written: (head, name) => changes.written(head, name),
  synced: () => editor.synced(),
  open: (name) => void locate(name, true),
  place: (at, grain) => making.place(at, grain),
  corner: (e) => orientation.click(e),
})
changes.hands = hands
const making = new Making(shell.right, link, {
  say,
  select: (name) => actions.select(name, 'text'),
  apply: (list, version, name) => editor.apply(list, version, name),
  synced: () => editor.synced(),
})
/** The drawing board is there for a sketch and for a model that reads one. */
function offerBoard(): void {
  const there = shell.tabs.querySelector('[data-sheet=board]') !== null
  if (!link.local && !there && [model.name, ...model.files].some(isSketch))
    shell.tabs.append(tab('board', 'Drawing board'))
}
on(['files'], offerBoard)
on(['shown'], () => {
  if (document.body.dataset.room === 'board' && isSketch(files.current.file)) void rooms.show('board')
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
  open: (file) => openFiles(app, [file]),
  recent: async () => (await askRecent(), app.recent),
  reopen: (path) => app.reopen(path),
})
shell.stage.append(start.element)
editor.steps.onText = () => {
  const hidden = link.still || editor.text.trim() !== '' || isSketch(model.name)
  if (start.element.hidden && !hidden) void start.refresh()
  start.element.hidden = hidden
}
const rooms = new Rooms(
  shell.stage,
  link,
  editor,
  () => files.sketch(),
  say,
  (blob, name) => give(app, blob, name),
  {
    say,
    preview: (values) => changes.preview(values),
    write: actions.write,
  },
)
const sheets = new Sheets(shell.sheet, link, actions, () => tablesSheet(editor, actions))
const section = new SectionPlane(view, shell.section, {
  say,
  typed: actions.typed,
  changed: () => buildToolbar(app),
})
const planes = new BlockPlanes(shell.planes, view, link, { say, legend: () => analysis.legend() })
const foreign = new Foreign(view, link, { say, legend: () => analysis.legend() })
const analysis = new Analysis(view, link, shell.legend, {
  say,
  painted: () => buildToolbar(app),
  other: () =>
    foreign.scale
      ? { scale: foreign.scale, name: `deviation, ${model.unit}` }
      : planes.scale && { scale: planes.scale, name: 'scaled Jacobian' },
})
parametersPanel(shell.params, actions)
treePanel(shell.tree, actions)
inspectorPanel(shell.inspector, actions)
messagesPanel(shell.messages, actions)
strip(
  shell.footer,
  actions,
  (place) =>
    new GivenNumbers(place, preview, {
      say,
      write: actions.write,
      typed: actions.typed,
      reset: () => changes.reset(),
      ghost: actions.ghost,
    }),
)

const app: App = {
  ...{
    shell,
    link,
    host,
    view,
    editor,
    hands,
    files,
    making,
    analysis,
    section,
    foreign,
    planes,
    rooms,
    actions,
    changes,
    saving,
  },
  formats: [],
  recent: [],
  reopen: (path) =>
    void link
      .tell({ kind: 'open_recent', path })
      .then(({ url }) => location.assign(url))
      .catch((error) => say((error as Error).message)),
  look(name) {
    view.camera.look(name)
    view.fit()
  },
  sheet,
  openPalette(words = '') {
    const objects = model.objects
      .slice(0, 2000)
      .map((o) => ({ name: `Select ${o.name}`, keys: o.kind, run: () => actions.select(o.name, 'tree') }))
    palette(() => [...commands(app), ...objects], words, askRecent())
  },
  download: (kind) => download(app, kind),
  copyLink: () => copyLink(app),
  buildToolbar: () => buildToolbar(app),
}

async function askRecent(): Promise<void> {
  if (!link.local) app.recent = (await link.tell({ kind: 'recent' })).files
}

// Tabs over the picture.

/** The state of the model when it was last seen. */
let seen = -1
async function sheet(name: TabName): Promise<void> {
  const inRoom = name === 'board' || name === 'desk'
  // Beside the picture, which shows what is chosen there.
  const beside = name === 'studies'
  const { room } = document.body.dataset
  if (inRoom) document.body.dataset.room = name
  else delete document.body.dataset.room
  if (inRoom && !room) seen = model.rev
  sheets.show(inRoom || beside ? 'model' : name)
  shell.toolbar.hidden = shell.view.hidden = name !== 'model' && !beside
  shell.tabs.querySelector<HTMLElement>(`[data-sheet=${name}]`)?.removeAttribute('hidden')
  for (const t of shell.tabs.querySelectorAll<HTMLElement>('[role=tab]')) {
    const on = t.dataset.sheet === name
    t.setAttribute('aria-selected', String(on))
    t.tabIndex = on ? 0 : -1
  }
  await rooms.show(inRoom || beside ? name : null)
  if (beside) requestAnimationFrame(() => view.fit())
  // What was made in a room is seen whole.
  if (room && !inRoom && seen !== model.rev) view.fit()
}

function tab(name: TabName, words: string): HTMLElement {
  const disabled = link.still && name !== 'model' && name !== 'graph'
  const on = name === 'model'
  const attributes = { role: 'tab', 'aria-selected': on, 'data-sheet': name, tabindex: on ? 0 : -1, disabled }
  return h('button', { ...attributes, onclick: () => void sheet(name) }, words)
}
for (const [name, words] of SHEETS) shell.tabs.append(tab(name, words))
shell.tabs.addEventListener('keydown', (e) => {
  const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key]
  if (!step) return
  const all = [...shell.tabs.querySelectorAll<HTMLButtonElement>('[role=tab]:not([hidden], :disabled)')]
  const next = all[(all.indexOf(e.target as HTMLButtonElement) + step + all.length) % all.length]
  e.preventDefault()
  next.focus()
  next.click()
})

/** Sheets that never said anything of this model have no tab; the palette still has them. */
function fitTabs(): void {
  const means: Record<string, boolean> = {
    lines: view.mirrored.includes('y'),
    hydrostatics: model.floats,
    areas: model.floats,
    tables: tablesOf(editor).length > 0,
  }
  for (const [name, on] of Object.entries(means)) {
    const t = shell.tabs.querySelector<HTMLButtonElement>(`[data-sheet=${name}]`)!
    const selected = t.getAttribute('aria-selected') === 'true'
    // One that was shown stays: without it the row of tabs may be lower, and the picture would jump under the hand.
    if (on) t.dataset.shown = ''
    t.hidden = t.dataset.shown === undefined && !selected
    if (!link.still) t.disabled = !on && !selected
  }
}

// What comes.

function take(frame: Frame): void {
  const { head } = frame
  const facts: [string, keyof typeof model, Parameters<typeof changed>[0]][] = [
    ['params', 'params', 'params'],
    ['objects', 'objects', 'objects'],
    ['reads', 'files', 'files'],
    ['diagnostics', 'faults', 'faults'],
    ['printed', 'printed', 'printed'],
    ['watched', 'watched', 'watched'],
  ]
  if (head.unit !== undefined) model.unit = head.unit
  if (head.program !== undefined) model.program = head.program
  if (head.mirror !== undefined) model.mirror = head.mirror
  const scene = view.take(frame)
  for (const [key, name, topic] of facts) {
    if (head[key] === undefined) continue
    ;(model as any)[name] = head[key]
    changed(topic)
  }
  if (head.diagnostics) files.diagnose()
  if (scene && !fitted && !view.box.isEmpty()) {
    fitted = true
    view.fit()
  }
  if (head.rev !== undefined && head.rev !== model.rev && head.watched === undefined && model.watched.length) measure()
  if (scene) {
    fitTabs()
    section.show()
    analysis.refresh()
    foreign.refresh()
  }
  if (head.rev !== undefined && head.rev !== model.rev) planes.refresh()
  if (head.rev !== undefined && head.rev !== model.rev) {
    model.rev = head.rev
    changed('rev')
    if (!link.still) askFloating()
    void watchUsual()
  }
  document.body.dataset.state = 'alive'
}

/** How long a hand rests before numbers are computed, ms. */
const REST = 150
let lastMove = 0
addEventListener('pointermove', () => (lastMove = performance.now()), true)

/** Delays a run until for a moment nothing has come and no hand has moved. */
function atRest(run: () => void): () => void {
  let timer = 0
  const moving = () => (held || hands.busy) && performance.now() - lastMove < REST
  const wait = () => {
    clearTimeout(timer)
    timer = window.setTimeout(() => (moving() ? wait() : run()), REST)
  }
  return wait
}

/** Asks whether the model floats. */
const floating = new Newest<void>(async () => {
  const ask = async () => (await link.ask('evaluate', { expressions: [IMMERSED] })).head.values[0].value
  const immersed = view.mirrored.includes('y') ? await ask().catch(() => null) : null
  afloat(floats(view.mirrored, immersed))
  fitTabs()
})
/** The model floats, or does not: the picture has its water. */
function afloat(on: boolean): void {
  model.floats = on
  if (view.afloat === on) return
  view.afloat = on
  view.settle()
  buildToolbar(app)
}
const askFloating = atRest(() => floating.push(undefined))

// Watched numbers follow the scene: at once while they are quick and no hand holds anything, else when the hand rests. A
// move ends their computation.
let took = 0
const measuring = new Newest<void>(async () => {
  const from = performance.now()
  await link.ask('measure').catch(() => undefined)
  took = performance.now() - from
})
const measureLater = atRest(() => measuring.push(undefined))
function measure(): void {
  if (took < 4 && !held && !hands.busy) measuring.push(undefined)
  else measureLater()
}

link.onFrame = take
link.onState = (state) => {
  // The texts are online when they are joined with the server's.
  if (state === 'down') {
    for (const one of files.all) one.offline()
    if (!link.still) warn('The server does not answer. What you type is kept here and sent when it is back.')
  }
  saving.show()
}
link.onMessage = (message) => {
  switch (message.kind) {
    case 'hello':
      void begin(message)
      break
    case 'updates':
      saving.is(message.file, message.dirty)
      files.of(message.file)?.received(message.updates, message.from)
      rooms.refresh()
      if (!message.file) cell?.changed()
      break
    case 'saved':
      saving.is(message.file, !!message.dirty)
      break
    case 'conflict':
      saving.conflict(message.theirs, message.file)
      break
    case 'unsaved':
      void files.load(message.file).catch(() => undefined)
      break
    case 'engine':
      if (message.state === 'lost') warn(`The engine was stopped: ${message.reason}. Your text is safe.`)
      else {
        warn('')
        void changes.holdAgain().catch(() => undefined)
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

/** Numbers that are watched at first; a model that was begun here has them with its first surface. */
let watching = false
async function watchUsual(): Promise<void> {
  const kept = stored<string[] | null>(`watch.${model.name}`, null)
  const shown = [...view.items.values()].some((i) => i.kind === 'patch')
  if (link.still || watching || (!kept && !shown)) return
  watching = true
  floating.push(undefined)
  await floating.settled()
  const expressions = kept ?? usualNumbers(model.floats, model.objects)
  await link.ask('watch', { expressions }).catch(() => (watching = false))
}

/** The words of the language, for all texts. */
function spell(all: Record<string, string[]>): void {
  words = all
  for (const one of files.all) one.words(words)
}

async function begin(hello: any): Promise<void> {
  warn('')
  const before = instance
  const again = before !== ''
  instance = hello.instance ?? 'still'
  model.name = hello.name
  shell.file.textContent = hello.name
  document.title = `${hello.name} · Moldloft`
  editor.dirty = hello.dirty
  hidden.clear()
  for (const name of stored<string[]>(`hidden.${hello.name}`, [])) hidden.add(name)
  if (!again) editor.begin(hello.text, hello.version)
  else if (instance === before) await editor.resume()
  else editor.rejoin(hello.text, hello.version)
  editor.steps.onText()
  if (inCell) cell ??= new Cell(editor)
  if (hello.words) spell(hello.words)
  const has = (name: string) => shell.tabs.querySelector(`[data-sheet=${name}]`) !== null
  if (!link.local && !has('desk')) shell.tabs.append(tab('desk', 'Fairing desk'), tab('studies', 'Studies'))
  offerBoard()
  if (isSketch(hello.name) && !/^\s*SKETCH/im.test(hello.text)) void sheet('board')
  if (hello.recovered)
    say(
      'Unsaved changes of an earlier session are back. Save keeps them; “Revert to the saved file” in the commands drops them.',
    )
  if (hello.dropped) say(`This page was disconnected: ${hello.dropped}. It shows the newest state.`)
  saving.show()
  try {
    // The scene of a file is loaded at once; that of a server is requested with all it draws.
    if (link.local) await link.ask('open')
    if (hello.watched) {
      const immersed = hello.watched.find((w: ValueFact) => w.expression === IMMERSED)?.value
      afloat(floats(view.mirrored, immersed))
      model.watched = usualOf(hello.watched, model.floats)
      changed('watched')
      fitTabs()
    }
    if (again) await changes.holdAgain()
    if (!link.still) await link.ask('show', { contours })
    if (!link.local) await link.ask('open')
    if (!link.local) files.begin(hello.unsaved ?? [])
    watching = false
    await watchUsual()
    if (!again && !link.still) app.formats = (await link.ask('formats')).head.formats
    if (!again && !hello.words && !link.still) spell((await link.ask('words')).head.words)
    if (!again) await askRecent()
    if (!again) await openLink(app)
  } catch (error) {
    if (error instanceof Refused) say(error.message)
  }
}

shell.paletteButton.addEventListener('click', () => app.openPalette())
shell.exportButton.addEventListener('click', () => app.openPalette('Export: '))
shell.linkButton.addEventListener('click', () => void app.copyLink())
shell.helpButton.addEventListener('click', () => help(commands(app)))
shell.saveButton.addEventListener('click', () => void saving.save())
addEventListener('beforeunload', (e) => {
  if (files.all.some((one) => one.pending)) e.preventDefault()
})
installKeys(app)
installDrop(app, shell.view)
themes(shell.themeButton, (dark) => view.theme(dark))
buildToolbar(app)
saving.show()
let known = ''
on('params', () => {
  // The colours by parameters are in the bar.
  const now = model.params.map((p) => p.name).join()
  if (now !== known) buildToolbar(app)
  known = now
})

/** For tests: numbers of the picture, never a way to change it. */
Object.assign(window, {
  moldloft: {
    stamps: changes.stamps,
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
      [...view.items.entries()]
        .filter(([, i]) => i.object === object)
        .sort(([a], [b]) => (a < b ? -1 : 1))
        .flatMap(([, i]) => Array.from(i.position)),
    text: (file = '') => files.of(file)?.text,
    over: (name: string) => view.drawnOver(name),
    ground: () => ({ ...view.ground.shown, bounds: [...view.box.min.toArray(), ...view.box.max.toArray()] }),
    triangles: () => triangles(view),
    get board() {
      return rooms.loaded.board
    },
    get desk() {
      return rooms.loaded.desk
    },
    get studies() {
      return rooms.loaded.studies
    },
    steps: () => ({ done: [...editor.steps.done], undone: [...editor.steps.undone] }),
    settled: () => changes.settled(),
    camera: () => ({ azimuth: view.camera.azimuth, elevation: view.camera.elevation, reach: view.camera.reach }),
    camera_set: (azimuth: number, elevation: number) => {
      Object.assign(view.camera, { azimuth, elevation })
      view.fit()
    },
  },
})

if (inCell) document.body.dataset.host = 'cell'
host?.begin({ editor: () => editor, say, cursor: (offset) => editor.onCursor(offset) })
void link.start().catch((error) => warn(error.message))
