// The pictures of the fairing desk: a line with its band, comb and marks; its curvature, jumps and deviation; the views of a network.

import { s, shown } from './dom'
import type { Facts } from './frame'

type Place = [number, number]

/** A curve as a picture has it: places, share of the length, curvature with its sign. */
export interface Seen {
  at: Place[]
  arc: number[]
  bend: number[]
}

/** A line in full. */
export interface Detail {
  line: number
  axes: [number, number]
  points: number[]
  data: Place[]
  faired: Place[]
  place: [number, number, number][]
  moved: number[]
  /** Null where a point is released. */
  limits: (number | null)[]
  before: Seen
  after: Seen
  last: Place[] | null
  jumps: [number[], number[]]
  knots: number[]
  fixed: number[]
  knuckles: number[]
  released: number[]
  closed: boolean
  /** True if the points are control points. */
  control: boolean
  certificate: { state: 'draft' | 'certified' | 'kept' | 'broken'; words: string }
}

export interface DeskFacts extends Facts {
  log: string[]
  kind: 'curves' | 'network' | 'surface'
  goal: string
  limit: number
  list: Facts[]
  line: number
  detail: Detail
  span: number[] | null
  shapes: { line: number; text: string; ends: [number, number] | null }[]
  views?: [number, number, number][][]
  views_before?: [number, number, number][][]
  extents?: [number[], number[]]
  /** Sections of the lines by planes that the network has no line in: diagonals by x and the length along the plane. */
  sections?: { diagonals: Place[][]; buttocks: Place[][] }
  suspects: Facts[]
  names: string[]
  compared: (number | null)[]
  cut?: Facts | null
}

/** What a hand has chosen: the point with the focus, and the other end of a span. */
export interface Chosen {
  point: number
  anchor: number
}

const join = (places: Place[]): string =>
  places.length ? `M${places.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join('L')}` : ''
const path = (d: string, attributes: Facts) => s('path', { d, ...attributes })

/** The sheet on the screen: its lower left corner and pixels of a unit. */
export class Sheet {
  corner: Place = [0, 0]
  scale = 1
  size: Place = [600, 300]

  to = ([u, v]: Place): Place => [(u - this.corner[0]) * this.scale, this.size[1] - (v - this.corner[1]) * this.scale]
  from = ([x, y]: Place): Place => [x / this.scale + this.corner[0], (this.size[1] - y) / this.scale + this.corner[1]]

  zoom(factor: number, at: Place): void {
    const [u, v] = this.from(at)
    this.scale *= factor
    const [x, y] = this.to([u, v])
    this.pan(at[0] - x, at[1] - y)
  }

  pan(dx: number, dy: number): void {
    this.corner = [this.corner[0] - dx / this.scale, this.corner[1] + dy / this.scale]
  }

  fit(places: Place[], margin = 46): void {
    if (!places.length) return
    const [us, vs] = [places.map((p) => p[0]), places.map((p) => p[1])]
    const [low, high] = [
      [Math.min(...us), Math.min(...vs)],
      [Math.max(...us), Math.max(...vs)],
    ]
    const [w, h] = [Math.max(40, this.size[0] - 2 * margin), Math.max(30, this.size[1] - 2 * margin)]
    const [du, dv] = [high[0] - low[0], high[1] - low[1]]
    this.scale = Math.min(du > 0 ? w / du : Infinity, dv > 0 ? h / dv : Infinity)
    if (!Number.isFinite(this.scale)) this.scale = 1
    this.corner = [
      (low[0] + high[0] - this.size[0] / this.scale) / 2,
      (low[1] + high[1] - this.size[1] / this.scale) / 2,
    ]
  }
}

/** The usual size of the curvature along the length, by which teeth are scaled: a nose would leave the rest without. */
function usual(seen: Seen): number {
  const sorted = seen.bend.map(Math.abs).sort((a, b) => a - b)
  const largest = sorted.at(-1) ?? 0
  const most = sorted[Math.floor(0.8 * (sorted.length - 1))] ?? 0
  return largest <= 8 * most ? largest : Math.max(3 * most, 1e-3 * largest)
}

/** Teeth of the comb: feet and tips on the screen. */
function comb(seen: Seen, sheet: Sheet, cut: number, longest: number): Place[] {
  const at = seen.at.map(sheet.to)
  return at.map(([x, y], k) => {
    const [a, b] = [at[Math.max(0, k - 1)], at[Math.min(at.length - 1, k + 1)]]
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]]
    const length = Math.hypot(dx, dy) || 1
    const tooth = (Math.max(-cut, Math.min(cut, seen.bend[k])) / (cut || 1)) * longest
    // The screen's y is down: outside of the bend.
    return [x - (dy / length) * tooth, y + (dx / length) * tooth]
  })
}

export class DeskPainter {
  private readonly ground = s('g', { 'aria-hidden': 'true' })
  private readonly dots = s('g', { class: 'desk-points', role: 'listbox', 'aria-label': 'points of the line' })
  private readonly over = s('g', { 'aria-hidden': 'true' })
  places: Place[] = []

  constructor(
    readonly svg: SVGElement,
    readonly sheet: Sheet,
  ) {
    svg.append(this.ground, this.dots, this.over)
  }

  draw(f: DeskFacts, chosen: Chosen, tool: string): void {
    const { detail: d } = f
    const { sheet } = this
    this.places = d.data.map(sheet.to)
    const band = path(join(d.before.at.map(sheet.to)), {
      class: 'band',
      'stroke-width': Math.max(1, 2 * f.limit * sheet.scale).toFixed(1),
    })
    const cut = usual(d.after)
    const longest = 0.16 * Math.min(...sheet.size)
    const feet = d.after.at.map(sheet.to)
    const tips = comb(d.after, sheet, cut, longest)
    const step = Math.max(1, Math.floor(feet.length / 400))
    const teeth = feet.map((p, k) => (k % step ? '' : `${join([p, tips[k]])}`)).join('')
    const parts: SVGElement[] = [band]
    if (f.cut)
      for (const [seen, kind] of [
        [f.cut.before, 'before'],
        [f.cut.after, 'after'],
      ] as [Seen, string][])
        if (String(f.cut.axes) === String(d.axes))
          parts.push(path(join(seen.at.map(sheet.to)), { class: `line cut ${kind}` }))
    parts.push(
      path(join(comb(d.before, sheet, cut, longest)), { class: 'comb before' }),
      path(teeth, { class: 'teeth' }),
      path(join(tips), { class: 'comb after' }),
      path(join(d.before.at.map(sheet.to)), { class: 'line before' }),
    )
    if (d.last) parts.push(path(join(d.last.map(sheet.to)), { class: 'line last' }))
    parts.push(path(join(feet), { class: 'line after' }))
    if (d.control) parts.push(path(join([...this.places, ...(d.closed ? [this.places[0]] : [])]), { class: 'polygon' }))
    for (const shape of f.shapes)
      if (shape.line === d.line && shape.ends) parts.push(...this.span(d, shape.ends, shape.text.split('=')[0]))
    if (f.span && f.span[0] === d.line) parts.push(...this.span(d, [f.span[1], f.span[2]], 'range'))
    if (chosen.anchor >= 0 && chosen.anchor !== chosen.point)
      parts.push(...this.span(d, [chosen.anchor, chosen.point], 'chosen'))
    this.ground.replaceChildren(...parts)
    const suspects = new Map((f.suspects ?? []).map((x) => [x.point, x]))
    this.dots.replaceChildren(
      ...d.points.map((point, k) => {
        const [x, y] = this.places[k]
        const limit = d.limits[k]
        const marks = [
          d.fixed.includes(point) ? 'fixed' : '',
          d.knuckles.includes(point) ? 'knuckle' : '',
          d.released.includes(point) ? 'released' : '',
          suspects.get(point)?.accepted === false ? 'suspect' : '',
          limit !== null && limit > 0 && d.moved[k] >= (1 - 1e-4) * limit ? 'reached' : '',
        ]
        const name = f.names?.[point] ?? `point ${point + 1}`
        const words = `${name}, ${limit === null ? 'released' : `moved ${shown(d.moved[k], 3)} of ${shown(limit, 3)}`}${marks
          .filter(Boolean)
          .map((m) => `, ${m}`)
          .join('')}`
        const shape = marks[1]
          ? s('rect', { x: x - 4, y: y - 4, width: 8, height: 8, transform: `rotate(45 ${x} ${y})` })
          : marks[0]
            ? s('rect', { x: x - 4, y: y - 4, width: 8, height: 8 })
            : s('circle', { cx: x.toFixed(1), cy: y.toFixed(1), r: point === chosen.point ? 5 : 3 })
        const ring =
          suspects.get(point) && !suspects.get(point)!.accepted
            ? [s('circle', { cx: x, cy: y, r: 9, class: 'ring' })]
            : []
        return s(
          'g',
          {
            class: `datum ${marks.filter(Boolean).join(' ')} ${point === chosen.point ? 'chosen' : ''}`,
            role: 'option',
            'aria-selected': point === chosen.point,
            'aria-label': words,
            'data-point': point,
          },
          ...ring,
          shape,
        )
      }),
    )
    this.svg.dataset.tool = tool
    this.bar()
  }

  /** A stretch of the faired line between two points. */
  private span(d: Detail, [a, b]: [number, number], word: string): SVGElement[] {
    const ends = [d.points.indexOf(a), d.points.indexOf(b)].sort((p, q) => p - q)
    if (ends[0] < 0) return []
    const way = d.faired.slice(ends[0], ends[1] + 1).map(this.sheet.to)
    const [x, y] = way[Math.floor(way.length / 2)]
    return [
      path(join(way), { class: `span ${word}` }),
      ...(word === 'chosen' ? [] : [s('text', { class: 'tag', x, y: y - 14 }, word)]),
    ]
  }

  /** A length that fits the picture, with its number. */
  private bar(): void {
    const wide = 0.18 * this.sheet.size[0]
    const power = 10 ** Math.floor(Math.log10(wide / this.sheet.scale))
    const length = [5, 2, 1].map((k) => k * power).find((x) => x * this.sheet.scale <= wide) ?? power
    const [x, y] = [14, this.sheet.size[1] - 12]
    this.over.replaceChildren(
      path(`M${x} ${y}h${(length * this.sheet.scale).toFixed(1)}`, { class: 'scale' }),
      s('text', { x: x + length * this.sheet.scale + 6, y: y + 4 }, shown(length)),
    )
  }

  hit([x, y]: Place, reach: number): number {
    let [best, found] = [reach, -1]
    this.places.forEach(([a, b], k) => {
      const far = Math.hypot(a - x, b - y)
      if (far <= best) [best, found] = [far, k]
    })
    return found
  }
}

const HEIGHT = 84

/** Strips below the line: curvature along the length, jumps at the knots, deviation against the limit. */
export function strips(f: DeskFacts, width: number): SVGElement[] {
  const { detail: d } = f
  const plot = (name: string, label: string, ...parts: SVGElement[]) =>
    s(
      'svg',
      {
        class: `desk-strip ${name}`,
        viewBox: `0 0 ${width} ${HEIGHT}`,
        width,
        height: HEIGHT,
        role: 'img',
        'aria-label': label,
      },
      ...parts,
      s('text', { class: 'title', x: 8, y: 13 }, label),
    )
  const x = (share: number) => 8 + share * (width - 16)
  const cut = usual(d.after) * 1.15 || 1
  const y = (k: number) => HEIGHT / 2 - (Math.max(-1, Math.min(1, k / cut)) * (HEIGHT - 30)) / 2 + 6
  const bends = (seen: Seen, kind: string) =>
    path(join(seen.arc.map((a, k) => [x(a), y(seen.bend[k])])), { class: `line ${kind}` })
  const largest = Math.max(...d.after.bend.map(Math.abs))
  const curvature = plot(
    'curvature',
    `curvature, largest ${shown(largest, 3)}`,
    path(`M${x(0)} ${y(0)}H${x(1)}`, { class: 'zero' }),
    bends(d.before, 'before'),
    bends(d.after, 'after'),
  )
  const most = Math.max(...d.jumps[1], 1e-300)
  const rough = Math.max(...d.jumps[0], 1e-300)
  // Decades below the roughest.
  const high = (j: number) =>
    Math.max(0, Math.min(1, 1 + Math.log10(Math.max(j, 1e-300) / Math.max(rough, most)) / 6)) * (HEIGHT - 24)
  const bars = (jumps: number[], kind: string, by: number) =>
    path(
      jumps.map((j, k) => `M${(x(d.knots[k] ?? 0) + by).toFixed(1)} ${HEIGHT - 4}v${-high(j).toFixed(1)}`).join(''),
      { class: `bars ${kind}` },
    )
  const jumps = plot(
    'jumps',
    `jumps of the third derivative, largest ${shown(rough, 3)} → ${shown(most, 3)}`,
    bars(d.jumps[0], 'before', -1),
    bars(d.jumps[1], 'after', 1),
  )
  const share = (k: number) => (d.limits[k] ? Math.min(1.3, d.moved[k] / d.limits[k]!) : 0)
  const top = (v: number) => HEIGHT - 4 - (v / 1.3) * (HEIGHT - 24)
  const places = d.points.map((_, k) => x(d.points.length > 1 ? k / (d.points.length - 1) : 0))
  const worst = d.moved.reduce((m, v, k) => (v > d.moved[m] ? k : m), 0)
  const deviation = plot(
    'deviation',
    `deviation against the limit, largest ${shown(d.moved[worst], 3)} at ${f.names?.[d.points[worst]] ?? `point ${d.points[worst] + 1}`}`,
    path(`M${x(0)} ${top(1)}H${x(1)}`, { class: 'limit' }),
    path(places.map((p, k) => `M${p.toFixed(1)} ${HEIGHT - 4}V${top(share(k)).toFixed(1)}`).join(''), {
      class: 'bars after',
    }),
  )
  return [curvature, jumps, deviation]
}

const VIEWS: [string, number, number][] = [
  ['Body plan', 1, 2],
  ['Waterlines', 0, 1],
  ['Profile', 0, 2],
]

/** The views of a network beside each other: stations, waterlines, buttocks and diagonals, the shown line strong. */
export function views(f: DeskFacts, wide: number, height: number): SVGElement[] {
  if (!f.views || !f.extents) return []
  const [low, high] = f.extents
  const { diagonals, buttocks } = f.sections ?? { diagonals: [], buttocks: [] }
  const width = Math.floor(wide / (diagonals.length ? 4 : 3)) - 1
  const view = (name: string, ...parts: SVGElement[]) =>
    s(
      'svg',
      {
        class: 'desk-view',
        viewBox: `0 0 ${width} ${height}`,
        width,
        height,
        role: 'img',
        'aria-label': name,
        'data-view': name,
      },
      ...parts,
      s('text', { class: 'title', x: 8, y: 15 }, name),
    )
  const cutBy = (sheet: Sheet, lines: Place[][]) =>
    lines.map((line) => path(join(line.map(sheet.to)), { class: 'line section' }))
  const all = VIEWS.map(([name, i, j]) => {
    const sheet = new Sheet()
    sheet.size = [width, height]
    sheet.fit(
      [
        [low[i], low[j]],
        [high[i], high[j]],
      ],
      18,
    )
    const flat = (line: [number, number, number][]) => join(line.map((p) => sheet.to([p[i], p[j]])))
    const lines = f.views!.map((line, k) =>
      path(flat(line), { class: `line after ${k === f.line ? 'chosen' : ''}`, 'data-line': k }),
    )
    const before = (f.views_before ?? []).map((line) => path(flat(line), { class: 'line before' }))
    const cut = f.cut ? [path(flat(f.cut.polyline), { class: 'line cut' })] : []
    const sections = name === 'Profile' ? cutBy(sheet, buttocks) : []
    return view(name, ...before, ...sections, ...lines, ...cut)
  })
  if (!diagonals.length) return all
  const sheet = new Sheet()
  sheet.size = [width, height]
  sheet.fit(diagonals.flat(), 18)
  return [...all, view('Diagonals', ...cutBy(sheet, diagonals))]
}
