// The drawing board's picture: lines with their types, points, dimensions, the triad, what the pointer means.

import { type Hit, hit } from './board_hit'
import { s, shown } from './dom'
import type { Facts } from './frame'

/** A sketch as the server states it. */
export interface Drawn {
  object: string | null
  objects: string[]
  faults: { line: number; text: string; next: string | null }[]
  section: string | null
  axes: Record<string, [number, number]>
  angles: number[]
  /** Label, place on the page, place in space as the picture suggests it, and which coordinates are known. */
  points: [number, number, number, (number | null)[] | null, boolean[]][]
  /** Label, ends, type, who typed it, how sure it is. */
  lines: [number, number, number, string, string, number][]
  /** Axis, points, coordinate. */
  planes: [string, number[], number | null][]
  marks: Mark[]
  /** What is missing, where it would stand. */
  next: Mark[]
  missing: Record<string, number>
  faces: number
  /** The loops of the face about which the text asks, the outer one first. */
  asked: number[][] | null
  numbers: Record<string, number | null>
  /** The face on which a section is drawn: its body, the images of the unit vectors and of the origin, and its border on the page. */
  place: {
    body: string
    face: string
    columns: [number, number, number][]
    /** 1 if a positive extrusion is outside the body, else -1. */
    outward: number
    vertices: number[]
    quads: number[]
    border: [Place, Place][]
  } | null
}

export interface Mark {
  name: string
  text: string
  value: number | null
  reference: boolean
  axis: string | null
  at: [number, number]
  line: [[number, number], [number, number]] | null
  witnesses: [[number, number], [number, number]][]
  p?: number
  q?: number
}

export interface Check {
  text: string
  next: string | null
  fixes: string[]
  about: { kind: string; points: number[]; lines: number[] }
}

export interface Aim extends Facts {
  at: [number, number]
  why: string | null
  point?: number
  line?: number
  part?: number
  axes?: string[]
  of?: number[]
  type?: string
  certainty?: number
}

export type Place = [number, number]

/** The page on the screen: its lower left corner, which stays where it is when the toolbar grows, and pixels of a unit. */
export class Page {
  corner: Place = [-130, -150]
  scale = 1
  size: Place = [600, 400]

  to([u, v]: Place): Place {
    return [(u - this.corner[0]) * this.scale, this.size[1] - (v - this.corner[1]) * this.scale]
  }

  from([x, y]: Place): Place {
    return [x / this.scale + this.corner[0], (this.size[1] - y) / this.scale + this.corner[1]]
  }

  zoom(factor: number, at: Place): void {
    const [u, v] = this.from(at)
    this.scale = Math.max(0.02, Math.min(50, this.scale * factor))
    const [x, y] = this.to([u, v])
    this.pan(at[0] - x, at[1] - y)
  }

  pan(dx: number, dy: number): void {
    this.corner = [this.corner[0] - dx / this.scale, this.corner[1] + dy / this.scale]
  }

  fit(places: Place[], right: number): void {
    if (places.length < 2) return
    const [us, vs] = [places.map((p) => p[0]), places.map((p) => p[1])]
    const [low, high] = [
      [Math.min(...us), Math.min(...vs)],
      [Math.max(...us), Math.max(...vs)],
    ]
    const [w, h] = [this.size[0] - right - 140, this.size[1] - 150]
    this.scale = Math.max(0.02, Math.min(4, w / Math.max(1, high[0] - low[0]), h / Math.max(1, high[1] - low[1])))
    this.corner = [
      (low[0] + high[0] + right / this.scale - this.size[0] / this.scale) / 2,
      (low[1] + high[1] - this.size[1] / this.scale) / 2,
    ]
  }
}

/** The letter of a type: H, P and F for the planes of axes with z up, as the commands name them. */
export function letter(type: string, section: string | null): string {
  return section && type === section ? 'F' : ({ XY: 'H', YZ: 'P', XZ: 'F' }[type] ?? type)
}

const words: Record<string, string> = {
  X: 'along x',
  Y: 'along y',
  Z: 'along z',
  XY: 'horizontal',
  XZ: 'frontal',
  YZ: 'profile',
  O: 'oblique',
  '': 'untyped',
}
const middle = (a: Place, b: Place): Place => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]
const segment = (a: Place, b: Place, attributes: Facts) =>
  s('line', { x1: a[0].toFixed(1), y1: a[1].toFixed(1), x2: b[0].toFixed(1), y2: b[1].toFixed(1), ...attributes })

export class Painter {
  private readonly dimensions = s('g', { class: 'dimensions' })
  private readonly faces = s('g', { class: 'outlines', 'aria-hidden': 'true' })
  private readonly lines = s('g', { class: 'lines', role: 'list', 'aria-label': 'lines' })
  private readonly points = s('g', { class: 'points', role: 'list', 'aria-label': 'points' })
  private readonly triad = s('g', { class: 'triad' })
  private readonly over = s('g', { class: 'over', 'aria-hidden': 'true' })
  readonly places = new Map<number, Place>()

  constructor(
    readonly svg: SVGElement,
    readonly page: Page,
  ) {
    svg.append(this.faces, this.lines, this.dimensions, this.over, this.points, this.triad)
  }

  draw(
    d: Drawn,
    state: {
      chosen: Set<string>
      checks: Check[]
      proposed: Map<number, string>
      open: string
      planes: Mark | null
      outlines: number[][]
    },
  ): void {
    const { page } = this
    this.places.clear()
    for (const [id, u, v] of d.points ?? []) this.places.set(id, page.to([u, v]))
    const doubted = new Set(state.checks.flatMap((c) => c.about.lines))
    const wrong = new Set(
      state.checks
        .filter((c) => !/doubtful|oblique|untyped|gap|loose/.test(c.about.kind))
        .flatMap((c) => c.about.lines),
    )
    const loose = new Set(state.checks.flatMap((c) => c.about.points))
    const lit = new Map<number, string>()
    if (state.planes?.axis) {
      const { axis, p, q } = state.planes
      for (const [a, members] of d.planes)
        if (a === axis)
          for (const [end, kind] of [
            [p, 'from'],
            [q, 'to'],
          ] as const)
            if (end && members.includes(end)) members.forEach((m) => lit.set(m, kind))
    }
    this.faces.replaceChildren(
      ...(d.place?.border ?? []).map(([a, b]) => segment(page.to(a), page.to(b), { class: 'ground' })),
      ...state.outlines.flatMap((way) => {
        const corners = way.map((p) => this.places.get(p))
        return corners.every(Boolean)
          ? [s('polygon', { points: corners.map((c) => `${c![0].toFixed(1)},${c![1].toFixed(1)}`).join(' ') })]
          : []
      }),
    )
    if (d.asked) this.faces.append(...this.traced(d.asked))
    this.lines.replaceChildren(
      ...(d.lines ?? []).flatMap(([id, p, q, type, source]) => {
        const [a, b] = [this.places.get(p), this.places.get(q)]
        if (!a || !b) return []
        const proposal = state.proposed.get(id)
        const sure = type === '' ? 'unknown' : doubted.has(id) && source !== 'user' ? 'guessed' : 'sure'
        const kind = type || 'none'
        // A line is in a plane with both its ends.
        const plane = lit.get(p) === lit.get(q) ? (lit.get(p) ?? '') : ''
        const name = `line ${id}, ${p} to ${q}, ${words[type] ?? type}${source === 'user' ? ', locked' : sure === 'guessed' ? ', to confirm' : ''}${proposal && !type ? `, proposed ${letter(proposal, d.section)}` : ''}`
        const m = middle(a, b)
        const label = type ? letter(type, d.section) : proposal ? `${letter(proposal, d.section)}?` : '?'
        return [
          s(
            'g',
            {
              class: `stroke ${sure} type-${kind} ${wrong.has(id) ? 'wrong' : ''} ${state.chosen.has(`l${id}`) ? 'chosen' : ''} ${plane}`,
              role: 'listitem',
              'aria-label': name,
              'data-line': id,
            },
            ...(plane ? [segment(a, b, { class: `halo ${plane}` })] : []),
            ...(wrong.has(id) ? [segment(a, b, { class: 'halo' })] : []),
            segment(a, b, { class: 'ink' }),
            s('rect', {
              class: 'tag',
              x: m[0] - 4.5 * label.length - 3,
              y: m[1] - 8,
              width: 9 * label.length + 6,
              height: 16,
              rx: 4,
            }),
            s('text', { class: 'letter', x: m[0], y: m[1] + 4 }, label),
          ),
        ]
      }),
    )
    this.points.replaceChildren(
      ...[...this.places].map(([id, [x, y]]) =>
        s(
          'g',
          {
            class: `dot ${lit.get(id) ?? ''} ${loose.has(id) ? 'loose' : ''} ${state.chosen.has(`p${id}`) ? 'chosen' : ''}`,
            role: 'listitem',
            'aria-label': `point ${id}`,
            'data-point': id,
          },
          s('circle', { cx: x.toFixed(1), cy: y.toFixed(1), r: 4 }),
          s('text', { x: x + 7, y: y - 6 }, String(id)),
        ),
      ),
    )
    this.dimensions.replaceChildren(
      ...[
        ...(d.marks ?? []).map((m) => this.mark(m, m.reference ? 'reference' : 'given', state.open)),
        ...(d.next ?? []).map((m, k) => this.mark(m, k === 0 ? 'missing first' : 'missing', state.open)),
      ],
    )
    this.axes(d)
  }

  /** A face that is traced: its area, and the direction in which its loops are run through. */
  private traced(loops: number[][]): SVGElement[] {
    const ways = loops.map((loop) => loop.map((p) => this.places.get(p)))
    if (!ways.flat().every(Boolean)) return []
    const word = (p: Place) => p.map((x) => x.toFixed(1)).join(' ')
    const area = ways.map((way) => `M${(way as Place[]).map(word).join('L')}Z`).join('')
    const arrows = (ways as Place[][]).flatMap((way) =>
      way.map((a, k) => {
        const b = way[(k + 1) % way.length]
        const degrees = (Math.atan2(b[1] - a[1], b[0] - a[0]) * 180) / Math.PI
        return s('path', {
          class: 'run',
          d: 'M-6 -5L6 0L-6 5Z',
          transform: `translate(${word(middle(a, middle(a, b)))}) rotate(${degrees.toFixed(1)})`,
        })
      }),
    )
    return [s('path', { class: 'asked', d: area, 'fill-rule': 'evenodd' }), ...arrows]
  }

  private mark(m: Mark, kind: string, open: string): SVGElement {
    const text = kind.startsWith('missing') ? `${m.axis} ≈ ${shown(m.value, 3)}` : m.text
    const [x, y] = this.page.to(m.at)
    const parts: SVGElement[] = m.witnesses.map(([a, b]) =>
      segment(this.page.to(a), this.page.to(b), { class: 'witness' }),
    )
    if (m.line) parts.push(segment(this.page.to(m.line[0]), this.page.to(m.line[1]), { class: 'measure' }))
    const wide = 7 * text.length + 8
    parts.push(
      s('rect', { x: x - wide / 2, y: y - 9, width: wide, height: 18, rx: 4 }),
      s('text', { x, y: y + 4 }, text),
    )
    const name = kind.startsWith('missing')
      ? `missing: ${m.axis} from ${m.p} to ${m.q}, about ${shown(m.value, 3)}`
      : `dimension ${m.text}`
    return s(
      'g',
      {
        class: `mark ${kind} ${open === m.name ? 'open' : ''}`,
        'data-mark': m.name,
        'aria-label': name,
        role: 'button',
      },
      ...parts,
    )
  }

  private axes(d: Drawn): void {
    const origin: Place = [64, this.page.size[1] - 64]
    this.triad.replaceChildren(
      ...Object.entries(d.axes ?? {}).flatMap(([name, unit]) => {
        const [c, w] = unit.map((x) => x / (Math.hypot(...unit) || 1))
        const tip: Place = [origin[0] + 42 * c, origin[1] - 42 * w]
        return [
          segment(origin, tip, { class: `axis type-${name}` }),
          s('circle', { class: `tip type-${name}`, cx: tip[0], cy: tip[1], r: 7, 'data-axis': name }),
          s('text', { class: 'axis', x: tip[0] + 13 * c, y: tip[1] - 13 * w + 4 }, name.toLowerCase()),
        ]
      }),
    )
    this.triad.dataset.origin = origin.join()
  }

  /** What the pointer means, and the line that would be drawn, or the `trail` of a stroke that is more than a line. */
  aim(aim: Aim | null, start: Place | null, section: string | null, lock: string, trail: Place[]): void {
    const parts: SVGElement[] = []
    if (trail.length) {
      const points = trail.map((p) => this.page.to(p).join()).join(' ')
      parts.push(s('polyline', { class: 'trail', points }))
    } else if (aim) {
      const at = this.page.to(aim.at)
      for (const of of aim.of ?? []) {
        const p = this.places.get(of)
        if (p) parts.push(segment(p, at, { class: 'trace' }))
      }
      if (start) {
        const type = lock || aim.type || ''
        const kind = type ? ((aim.certainty ?? 0) >= 0.6 || lock ? 'sure' : 'guessed') : 'unknown'
        parts.push(segment(this.page.to(start), at, { class: `rubber ${kind} type-${type || 'none'}` }))
        const words = lock
          ? `${letter(lock, section)} locked`
          : type
            ? `${letter(type, section)}${kind === 'guessed' ? '?' : ''}`
            : '?'
        parts.push(s('text', { class: `guess type-${type || 'none'}`, x: at[0] + 14, y: at[1] + 22 }, words))
      }
      const named: Record<string, string> = {
        point: 'point',
        cross: 'crossing',
        mid: 'middle',
        line: 'on the line',
        axis: `along ${(aim.axes ?? []).join().toLowerCase()}`,
        extension: `extension of ${(aim.axes ?? []).join()}`,
        parallel: `parallel to ${(aim.axes ?? []).join()}`,
      }
      parts.push(s('circle', { class: `snap ${aim.why ?? 'free'}`, cx: at[0], cy: at[1], r: aim.why ? 6 : 3 }))
      if (aim.why && aim.why !== 'point')
        parts.push(s('text', { class: 'why', x: at[0] + 14, y: at[1] - 8 }, named[aim.why]))
    }
    this.over.replaceChildren(...parts)
  }

  /** The point or line near a place on the screen. */
  hit(at: Place, d: Drawn, reach: number): Hit {
    return hit(at, this.places, d.lines, reach)
  }
}
