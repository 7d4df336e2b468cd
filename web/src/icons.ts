// Icons: strokes on a grid of 16, in the colour of the text around them.

import { h, s } from './dom'

const PATHS = {
  undo: 'M6 3 2.5 6.5 6 10M2.5 6.5H10a3.5 3.5 0 0 1 0 7H7',
  redo: 'M10 3l3.5 3.5L10 10M13.5 6.5H6a3.5 3.5 0 0 0 0 7h3',
  add: 'M8 3v10M3 8h10',
  fit: 'M2.5 6V2.5H6M10 2.5h3.5V6M13.5 10v3.5H10M6 13.5H2.5V10',
  orthographic: 'M2 11 5 4h9l-3 7zM2 11v0M8 4v0',
  perspective: 'M2 12.5 5.5 4h5l3.5 8.5zM4 8h8M8 4v8.5',
  points: 'M4 11.5a1 1 0 1 0 .01 0M12 11.5a1 1 0 1 0 .01 0M8 3.5a1 1 0 1 0 .01 0',
  curves: 'M2 12C4 2 6 2 8 8s4 6 6-4',
  contours: 'M2 4.5c4-3 8 3 12 0M2 8.5c4-3 8 3 12 0M2 12.5c4-3 8 3 12 0',
  measure: 'M2 10.5 10.5 2 14 5.5 5.5 14zM5 8.5l1.5 1.5M7.5 6 9 7.5M10 3.5 11.5 5',
  section: 'M8 1.5v13M8 4 3 6v5l5 2M10.5 5l2.5 1v5l-2.5 1',
  ground: 'M1.5 13h13M3.5 9.5h9M5 6.5h6M1.5 13 5.5 5M14.5 13l-4-8M8 5v8',
  water: 'M1.5 6c2-2 4 2 6.5 0s4.5-2 6.5 0M1.5 10.5c2-2 4 2 6.5 0s4.5-2 6.5 0',
  theme: 'M8 2.5a5.5 5.5 0 1 0 0 11zM8 2.5a5.5 5.5 0 0 1 0 11M8 5v6M6.5 4v8M5 5v6',
  help: 'M5.8 6a2.2 2.2 0 1 1 3.2 2c-.8.4-1 .8-1 1.6M8 12.4v.1',
} as const

export type IconName = keyof typeof PATHS

export function icon(name: IconName): HTMLElement {
  const svg = s('svg', { viewBox: '0 0 16 16' }, s('path', { d: PATHS[name] }))
  return h('span', { class: 'sign', 'aria-hidden': 'true' }, svg)
}
