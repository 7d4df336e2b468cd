// Commands: one table for buttons, keys and the palette.

import type { App } from './app'
import type { Standard } from './camera'
import { store } from './dom'
import { fileName } from './editor'
import { chooseLaid } from './files'
import { type Command, help } from './palette'
import { model } from './state'
import type { Style } from './view'

/** Views: name, words, key. */
export const LOOKS: [Standard, string, string][] = [
  ['iso', 'Isometric', '1'],
  ['profile', 'Profile', '2'],
  ['plan', 'Plan', '3'],
  ['body', 'Body plan from the bow', '4'],
  ['stern', 'From the stern', '5'],
  ['starboard', 'Profile from the other side', '6'],
  ['bottom', 'From below', '7'],
]

export const STYLES: [Style, string, string][] = [
  ['shaded', 'Shaded', 'S'],
  ['panels', 'Panels', 'P'],
  ['smooth', 'Smooth', 'A'],
  ['wire', 'Wireframe', 'W'],
  ['xray', 'X-ray', 'R'],
]

export const SHEETS = [
  ['model', 'Model'],
  ['lines', 'Lines plan'],
  ['hydrostatics', 'Hydrostatics'],
  ['areas', 'Section areas'],
  ['mesh', 'Mesh'],
  ['graph', 'Dependencies'],
  ['curvature', 'Curvature'],
  ['tables', 'Tables'],
] as const

export type SheetName = (typeof SHEETS)[number][0]

/** Colours that the engine computes at the vertices: name of the field, words. */
export const FIELDS: [string, string][] = [
  ['gaussian_curvature', 'Gaussian curvature'],
  ['mean_curvature', 'Mean curvature'],
  ['largest_curvature', 'Largest curvature'],
  ['smallest_curvature', 'Smallest curvature'],
  ['aspect', 'Panel aspect'],
  ['skew', 'Panel skewness'],
  ['warp', 'Panel warp'],
  ['jump', 'Jump of panel area'],
]

const LAYERS: [string, string, string][] = [
  ['point', 'points', '.'],
  ['curve', 'curves', ','],
  ['contour', 'contours', 'C'],
  ['patch', 'surfaces', ''],
  ['grid', 'grids', ''],
]

/** Parts of the ground: what they are, and their keys. */
const GROUNDS: ['water' | 'grid', string, string][] = [
  ['water', 'the water plane of a floating model', ''],
  ['grid', 'the grid at z = 0', ''],
]

export function toggleGround(app: App, part: 'water' | 'grid'): void {
  const { ground } = app.view
  ground[part] = !ground[part]
  store('ground', { water: ground.water, grid: ground.grid })
  app.view.settle()
  app.buildToolbar()
}

export function setStyle(app: App, style: Style): void {
  app.view.style = style
  app.view.settle()
  app.buildToolbar()
}

export function toggleLayer(app: App, kind: string): void {
  app.view.layers[kind] = !app.view.layers[kind]
  app.view.settle()
  app.buildToolbar()
}

export function toggleMeasure(app: App): void {
  const { hands, shell, view } = app
  hands.measuring = !hands.measuring
  shell.say(hands.measuring ? 'Measure: click two or three places; D or Esc ends' : '')
  if (!hands.measuring) view.overlay('measure', null)
  app.buildToolbar()
}

function textCommands(app: App): Command[] {
  const { link, changes, saving } = app
  const save = { name: link.local ? 'Download the text' : 'Save', keys: 'Ctrl+S', run: () => void saving.save() }
  if (link.still) return [save]
  return [
    save,
    { name: 'Undo', keys: 'Ctrl+Z', run: () => changes.turn(1) },
    { name: 'Redo', keys: 'Ctrl+Shift+Z', run: () => changes.turn(-1) },
    {
      name: link.local ? 'Revert to the text as it came' : 'Revert to the saved file',
      run: () => changes.revert(),
    },
    { name: 'Copy a link that holds the model', run: () => void app.copyLink() },
  ]
}

function viewCommands(app: App): Command[] {
  const { view } = app
  return [
    { name: 'Fit the model', keys: 'F', run: () => view.fit() },
    ...LOOKS.map(([n, words, key]) => ({ name: `View: ${words}`, keys: key, run: () => app.look(n) })),
    {
      name: 'Perspective or orthographic',
      keys: 'O',
      run: () => {
        view.camera.perspective = !view.camera.perspective
        view.fit()
        app.buildToolbar()
      },
    },
    {
      name: 'One view or four: profile, body plan, plan and the turned one',
      keys: 'Q',
      run: () => {
        view.four = !view.four
        app.buildToolbar()
      },
    },
    ...STYLES.map(([n, words, key]) => ({ name: `Style: ${words}`, keys: key, run: () => setStyle(app, n) })),
    ...LAYERS.map(([k, w, key]) => ({ name: `Show or hide ${w}`, keys: key, run: () => toggleLayer(app, k) })),
    ...GROUNDS.map(([part, words, key]) => ({
      name: `Show or hide ${words}`,
      keys: key,
      run: () => toggleGround(app, part),
    })),
    {
      name: 'Show or hide the mirror image',
      keys: 'M',
      run: () => {
        view.mirror = !view.mirror
        view.settle()
      },
    },
  ]
}

function colourCommands({ analysis, view }: App): Command[] {
  const field = (f: string, by?: string) => () => analysis.paint('field', f, by)
  return [
    { name: 'Colour: by patch', run: () => analysis.paint('patches') },
    { name: 'Colour: of the model', run: () => analysis.paint('model') },
    {
      name: 'Colour: zebra stripes',
      keys: 'Z',
      run: () => analysis.paint(view.paint === 'zebra' ? 'patches' : 'zebra'),
    },
    { name: 'Colour: reflection lines', run: () => analysis.paint('reflection') },
    { name: 'Colour: isophotes', run: () => analysis.paint('isophotes') },
    { name: 'Colour: highlight lines', run: () => analysis.paint('highlight') },
    ...FIELDS.map(([f, words]) => ({
      name: `Colour: ${words.toLowerCase().replace('gauss', 'Gauss')}`,
      run: field(f),
    })),
    ...model.params.map((p) => ({ name: `Colour: motion by ${p.name}`, run: field('derivative', p.name) })),
  ]
}

function objectCommands(app: App): Command[] {
  const { actions, making, shell } = app
  const chosen = (run: (name: string) => void) => () => {
    const name = actions.selected()
    if (name) run(name)
    else shell.say('Select an object first')
  }
  const rewrite = (kind: 'delete' | 'duplicate', words: string) =>
    chosen((name) => void actions.rewrite(kind, { name }, `${words} ${name}`))
  const changing =
    app.link.still || !model.program
      ? []
      : [
          { name: 'Add an object', keys: 'Shift+A', run: () => void making.open() },
          { name: 'Delete the selected object', keys: 'Delete', run: rewrite('delete', 'Delete') },
          { name: 'Duplicate the selected object', keys: 'Ctrl+D', run: rewrite('duplicate', 'Duplicate') },
          {
            name: 'Rename the selected object',
            keys: 'Shift+R',
            run: chosen(() => shell.inspector.querySelector<HTMLInputElement>('input.title')?.select()),
          },
        ]
  return [
    ...changing,
    { name: 'Hide or show the selected object', keys: 'H', run: chosen((name) => actions.toggle(name)) },
    { name: 'Isolate the selected object', keys: 'I', run: chosen((name) => actions.isolate(name)) },
    { name: 'Show all', keys: 'Shift+H', run: () => actions.isolate(null) },
    { name: 'Move the selected point by keys', keys: 'G', run: () => app.hands.take(actions.selected()) },
  ]
}

function analysisCommands(app: App): Command[] {
  const { analysis, foreign, planes, section, shell } = app
  const fair = () => {
    const name = app.actions.selected()
    if (name) app.actions.fair?.(name)
    else shell.say('Select an object first')
  }
  return [
    { name: 'Measure between places', keys: 'D', run: () => toggleMeasure(app) },
    { name: 'Lay a file over the model (STEP, IGES, STL, OBJ, PLY, OFF, GDF, table)', run: () => chooseLaid(app) },
    {
      name: 'Remove what lies over the model',
      run: () => void foreign.remove().catch((e: Error) => shell.say(e.message)),
    },
    { name: 'Compare: keep the shape as it is now, to lay it over what comes', run: () => void foreign.keepShape() },
    {
      name: 'Curvature comb of the selected curve',
      keys: 'K',
      run: () => analysis.toggleComb(app.actions.selected()),
    },
    ...[0, 1, 2].map((k) => ({
      name: `Section across ${'xyz'[k]}`,
      keys: `Shift+${'XYZ'[k]}`,
      run: () => section.cut(section.axis === k ? null : k),
    })),
    { name: 'Plane of a volume block, folded cells', keys: 'B', run: () => planes.toggle() },
    ...(app.link.local
      ? []
      : [
          { name: 'Fairing desk', run: () => void app.sheet('desk') },
          { name: 'Studies', run: () => void app.sheet('studies') },
          { name: 'Fair the selected curve or surface', run: fair },
        ]),
    ...SHEETS.map(([n, words], k) => ({ name: `Sheet: ${words}`, keys: `Alt+${k + 1}`, run: () => void app.sheet(n) })),
  ]
}

function placeCommands({ editor, shell, view }: App): Command[] {
  const { params, tree } = shell
  return [
    { name: 'Go to the program', keys: 'Ctrl+1', run: () => editor.view.focus() },
    { name: 'Go to the model', keys: 'Ctrl+2', run: () => view.canvas.focus() },
    { name: 'Go to parameters', keys: 'Ctrl+3', run: () => params.querySelector('input')?.focus() },
    {
      name: 'Go to objects',
      keys: 'Ctrl+4',
      run: () => tree.querySelector<HTMLElement>('[role=treeitem][tabindex="0"]')?.focus(),
    },
    { name: 'Format the program', keys: 'Shift+Alt+F', run: () => void editor.format() },
    { name: 'Rename the name at the cursor', keys: 'F2', run: () => void editor.rename() },
  ]
}

function fileCommands({ files }: App): Command[] {
  const one = (file: string) => ({ name: `File: ${fileName(file)}`, run: () => void files.show(file) })
  return model.files.length
    ? [{ name: `File: ${model.name}`, run: () => void files.show('') }, ...model.files.map(one)]
    : []
}

export function commands(app: App): Command[] {
  return [
    ...textCommands(app),
    ...viewCommands(app),
    ...colourCommands(app),
    ...objectCommands(app),
    ...analysisCommands(app),
    ...placeCommands(app),
    ...fileCommands(app),
    { name: 'Export: picture as it is seen (PNG)', run: () => void app.download('picture') },
    ...app.formats.map(([f, about]) => ({ name: `Export: ${f}, ${about}`, run: () => void app.download(f) })),
    { name: 'Export: print what is shown, or save it as PDF', run: () => print() },
    ...app.recent.map(({ path }) => ({ name: `Open again: ${path}`, run: () => app.reopen(path) })),
    { name: 'Light or dark', run: () => app.shell.themeButton.click() },
    { name: 'Help', keys: 'F1', run: () => help(commands(app)) },
  ]
}
