// The bar over the picture.

import type { App } from './app'
import type { Standard } from './camera'
import { FIELDS, LOOKS, STYLES, setStyle, toggleGround, toggleLayer, toggleMeasure } from './commands'
import { h } from './dom'
import { type IconName, icon } from './icons'
import { model } from './state'
import type { Paint, Style } from './view'

const PAINTS: [Paint, string][] = [
  ['patches', 'By patch'],
  ['model', 'Model colours'],
  ['zebra', 'Zebra'],
  ['reflection', 'Reflection lines'],
  ['isophotes', 'Isophotes'],
  ['highlight', 'Highlight lines'],
]

function button(name: IconName, words: string, run: () => void, on: boolean | null = null): HTMLElement {
  const state = on === null ? {} : { 'aria-pressed': on }
  return h('button', { 'aria-label': words, title: words, class: on ? 'on' : '', onclick: run, ...state }, icon(name))
}

function choice(name: string, value: string, options: [string, string][], run: (v: string) => void): HTMLElement {
  const all = options.map(([v, words]) => h('option', { value: v, selected: v === value }, words))
  const select = h('select', { 'aria-label': name, title: name }, ...all)
  select.addEventListener('change', () => run(select.value))
  return select
}

function colours(app: App): HTMLElement {
  const { analysis, view } = app
  const { field, by } = analysis
  const value = view.paint === 'field' ? (field === 'derivative' ? `d:${by}` : field) : view.paint
  const computed: [string, string][] = app.link.still
    ? []
    : [...FIELDS, ...model.params.map((p): [string, string] => [`d:${p.name}`, `Motion by ${p.name}`])]
  return choice('colour', value, [...PAINTS, ...computed], (v) => {
    if (PAINTS.some(([p]) => p === v)) analysis.paint(v as Paint)
    else if (v.startsWith('d:')) analysis.paint('field', 'derivative', v.slice(2))
    else analysis.paint('field', v)
  })
}

/** Builds the bar anew; the focus stays where it was. */
export function buildToolbar(app: App): void {
  const { view, section } = app
  const { toolbar } = app.shell
  const focus = toolbar.contains(document.activeElement)
    ? (document.activeElement as HTMLElement).getAttribute('aria-label')
    : null
  const views: [string, string][] = [['', 'View'], ...LOOKS.map(([n, w, k]): [string, string] => [n, `${w}  ${k}`])]
  const look = (v: string) => {
    if (v) app.look(v as Standard)
    buildToolbar(app)
  }
  const perspective = () => {
    view.camera.perspective = !view.camera.perspective
    view.fit()
    buildToolbar(app)
  }
  toolbar.replaceChildren(
    app.link.still ? '' : button('add', 'Add an object (Shift+A)', () => void app.making.open()),
    button('fit', 'Fit the model (F)', () => view.fit()),
    choice('view', '', views, look),
    button(
      view.camera.perspective ? 'perspective' : 'orthographic',
      'Perspective or orthographic (O)',
      perspective,
      view.camera.perspective,
    ),
    choice(
      'style',
      view.style,
      STYLES.map(([n, w]) => [n, w]),
      (v) => setStyle(app, v as Style),
    ),
    colours(app),
    button('points', 'Points (.)', () => toggleLayer(app, 'point'), view.layers.point),
    button('curves', 'Curves (,)', () => toggleLayer(app, 'curve'), view.layers.curve),
    button('contours', 'Contours (C)', () => toggleLayer(app, 'contour'), view.layers.contour),
    button('ground', 'Grid at z = 0', () => toggleGround(app, 'grid'), view.ground.grid),
    model.floats ? button('water', 'Water plane', () => toggleGround(app, 'water'), view.ground.water) : '',
    button(
      'section',
      'Section (Shift+X, Y, Z)',
      () => section.cut(section.axis === null ? 0 : null),
      section.axis !== null,
    ),
    button('measure', 'Measure (D)', () => toggleMeasure(app), app.hands.measuring),
  )
  if (focus) toolbar.querySelector<HTMLElement>(`[aria-label="${CSS.escape(focus)}"]`)?.focus()
}
