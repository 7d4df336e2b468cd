// What is shown beside the picture: lines plan, hydrostatics, mesh, digraph, curvature; all follow the model.

import type { SheetName } from './commands'
import { h, s, shown } from './dom'
import { FIGURES, unitOf } from './figures'
import { type Link, Newest } from './link'
import type { Actions } from './panels'
import { model, on } from './state'

/** Widths of the lines plan, in picture points: its text is legible at the first one. */
const [LEAST_PLAN, FIRST_PLAN, MOST_PLAN] = [400, 1400, 6000]

export class Sheets {
  current: SheetName = 'model'
  private readonly requests = new Newest<void>(() => this.build())
  private readonly makers: Record<SheetName, () => (Element | string)[] | Promise<(Element | string)[]>> = {
    model: () => [],
    lines: () => this.lines(),
    hydrostatics: () => this.hydrostatics(),
    areas: () => this.areas(),
    mesh: () => this.mesh(),
    graph: () => this.graph(),
    curvature: () => this.curvature(),
    tables: () => this.tables(),
  }
  private urls: string[] = []
  private planWidth = FIRST_PLAN
  private marked: Record<string, number> | null = null
  private curve: Curve | null = null

  constructor(
    private readonly host: HTMLElement,
    private readonly link: Link,
    private readonly act: Actions & { selected: () => string },
    private readonly tables: () => HTMLElement[],
  ) {
    on(['rev'], () => this.refresh())
    on('selection', () => (this.current === 'graph' || this.current === 'curvature') && this.refresh())
  }

  show(name: SheetName): void {
    this.current = name
    this.host.hidden = name === 'model'
    this.host.replaceChildren()
    if (name !== 'model') this.refresh()
  }

  refresh(): void {
    if (this.current !== 'model') this.requests.push(undefined)
  }

  private async build(): Promise<void> {
    const name = this.current
    try {
      const made = await this.makers[name]()
      // The focus stays in the cell that it came to.
      const cell = (document.activeElement as HTMLElement | null)?.dataset.cell
      if (this.current === name && name !== 'model') this.host.replaceChildren(...made)
      if (cell) this.host.querySelector<HTMLElement>(`[data-cell="${CSS.escape(cell)}"]`)?.focus()
    } catch (error) {
      if (this.current === name && (error as Error).message !== 'superseded')
        this.host.replaceChildren(h('p', { class: 'quiet pad' }, (error as Error).message))
    }
  }

  private async lines(): Promise<HTMLElement[]> {
    const frame = await this.link.ask('lines_plan', { title: model.name })
    for (const url of this.urls) URL.revokeObjectURL(url)
    const url = URL.createObjectURL(new Blob([frame.bytes(frame.head.sheet).slice()], { type: 'image/svg+xml' }))
    this.urls = [url]
    const picture = h('img', { src: url, alt: 'lines plan of the model: profile, body plan, half-breadth plan' })
    const zoom = (factor: number) => () => {
      this.planWidth = Math.max(LEAST_PLAN, Math.min(MOST_PLAN, this.planWidth * factor))
      picture.style.width = `${this.planWidth}px`
    }
    zoom(1)()
    return [
      h(
        'figure',
        { class: 'plan' },
        h('figcaption', {}, 'Lines plan: profile, body plan, half-breadth plan'),
        h('button', { 'aria-label': 'larger', onclick: zoom(1.25) }, '+'),
        h('button', { 'aria-label': 'smaller', onclick: zoom(0.8) }, '−'),
        h('div', { class: 'scrolled', tabindex: 0, role: 'group', 'aria-label': 'lines plan' }, picture),
      ),
    ]
  }

  private async hydrostatics(): Promise<HTMLElement[]> {
    const { head } = await this.link.ask('hydrostatics')
    // No density is known to a model, so that it has a volume and no mass.
    const figures = (head.figures as [string, number | string][]).filter(([name]) => name !== 'displacement')
    const now = Object.fromEntries(figures.filter(([, x]) => typeof x === 'number')) as Record<string, number>
    this.marked ??= now
    const marked = this.marked
    const rows = figures.map(([name, x]) => {
      const d = typeof x === 'number' && name in marked ? x - marked[name] : 0
      return h(
        'tr',
        {},
        h('th', { scope: 'row', title: `hydrostatics.${name}` }, FIGURES[`hydrostatics.${name}`]?.[1] ?? name),
        h('td', { class: 'mono' }, shown(x)),
        h('td', { class: 'quiet' }, unitOf(`hydrostatics.${name}`)),
        h(
          'td',
          { class: `mono delta ${d > 0 ? 'up' : d < 0 ? 'down' : ''}` },
          d ? `${d > 0 ? '+' : '−'}${shown(Math.abs(d), 4)}` : '',
        ),
      )
    })
    const again = h('button', { onclick: () => ((this.marked = null), this.refresh()) }, 'Mark now')
    return [
      h(
        'div',
        { class: 'pad' },
        h('h2', {}, 'Hydrostatics'),
        h('p', { class: 'quiet' }, 'At the waterplane z = 0, both sides.'),
        again,
        h(
          'table',
          {},
          h(
            'thead',
            {},
            h(
              'tr',
              {},
              h('th', {}, 'figure'),
              h('th', {}, 'value'),
              h('th', {}, 'unit'),
              h('th', {}, 'since the mark'),
            ),
          ),
          h('tbody', {}, ...rows),
        ),
      ),
    ]
  }

  /** The curve of section areas, and what it was at the mark. */
  private async areas(): Promise<HTMLElement[]> {
    const frame = await this.link.ask('section_areas', { count: 101 })
    const { place, area } = frame.head.areas
    const now = { x: frame.floats(place), y: frame.floats(area) }
    if (!now.x.every(Number.isFinite))
      return [h('p', { class: 'quiet pad' }, 'The model has no surfaces whose sections have areas.')]
    this.curve ??= now
    const again = h('button', { onclick: () => ((this.curve = null), this.refresh()) }, 'Mark now')
    const label = `section areas, at most ${shown(Math.max(...now.y), 4)} ${model.unit}²`
    return [
      h(
        'div',
        { class: 'pad' },
        h('h2', {}, 'Section areas'),
        h(
          'p',
          { class: 'quiet' },
          `Below the waterplane z = 0, both sides; in ${model.unit}² over x in ${model.unit}. The pale curve is that of the mark.`,
        ),
        again,
        h('figure', { class: 'plan' }, plot(now, this.curve === now ? null : this.curve, model.unit, label)),
      ),
    ]
  }

  private async mesh(): Promise<HTMLElement[]> {
    const { head } = await this.link.ask('mesh')
    const state = head.closed
      ? 'closed'
      : head.closed_with_lids_and_mirror
        ? 'closed with its mirror image and lids'
        : 'open'
    const rows = (head.patches as any[]).map((p) =>
      h(
        'tr',
        {},
        h(
          'th',
          { scope: 'row' },
          h('button', { class: 'link', onclick: () => this.act.select(p.name, 'graph') }, p.name),
        ),
        ...[p.panels, p.aspect, p.skew, p.warp, p.jump].map((x) => h('td', { class: 'mono' }, shown(x, 3))),
      ),
    )
    const leaks = (head.leaks as any[]).map((l) =>
      h(
        'li',
        {},
        h('button', { class: 'link', onclick: () => this.act.select(l.patch, 'graph') }, l.patch),
        ` at ${l.edge}: ${l.panels} panels, ${shown(l.length, 4)} ${model.unit}`,
      ),
    )
    return [
      h(
        'div',
        { class: 'pad' },
        h('h2', {}, `${head.panels} panels, ${head.vertices} vertices, ${state}`),
        h(
          'p',
          {},
          `Area of the panels ${shown(head.area)} ${unitOf('mesh.area')}, volume ${shown(head.volume)} ${unitOf('mesh.volume')}.`,
        ),
        leaks.length ? h('h3', {}, 'Open edges that nothing closes') : '',
        leaks.length ? h('ul', {}, ...leaks) : '',
        h(
          'table',
          {},
          h(
            'thead',
            {},
            h(
              'tr',
              {},
              ...['patch', 'panels', 'aspect', 'skewness', 'warp', 'jump of area'].map((t) => h('th', {}, t)),
            ),
          ),
          h('tbody', {}, ...rows),
        ),
        h('p', { class: 'quiet' }, 'Worst value per patch.'),
      ),
    ]
  }

  private async graph(): Promise<(HTMLElement | SVGElement)[]> {
    const selected = this.act.selected()
    const known = new Map(model.objects.map((o) => [o.name, o]))
    let all = model.objects
    const most = 260
    let note = ''
    if (all.length > most) {
      const keep = new Set<string>()
      const grow = (name: string, next: (n: string) => string[]) => {
        for (const n of next(name))
          if (!keep.has(n) && keep.size < most) {
            keep.add(n)
            grow(n, next)
          }
      }
      if (known.has(selected)) {
        keep.add(selected)
        grow(selected, (n) => known.get(n)?.parents ?? [])
        grow(selected, (n) => all.filter((o) => o.parents.includes(n)).map((o) => o.name))
      }
      note = keep.size
        ? `What ${selected} depends on, and what depends on it.`
        : `${all.length} objects are too many for one picture: select one to see what it depends on.`
      all = all.filter((o) => keep.has(o.name))
    }
    const names = new Set(all.map((o) => o.name))
    const depth = new Map<string, number>()
    for (const o of all)
      depth.set(o.name, 1 + Math.max(-1, ...o.parents.filter((p) => names.has(p)).map((p) => depth.get(p) ?? -1)))
    const children = new Map<string, string[]>()
    for (const o of all)
      for (const p of o.parents) if (names.has(p)) children.set(p, [...(children.get(p) ?? []), o.name])
    for (const o of all)
      if (!o.parents.length && children.get(o.name))
        depth.set(o.name, Math.min(...children.get(o.name)!.map((c) => depth.get(c)!)) - 1)
    const rows: string[][] = []
    for (const o of all) (rows[depth.get(o.name)!] ??= []).push(o.name)
    const place = new Map<string, number>()
    const spread = () => rows.forEach((r) => r?.forEach((n, k) => place.set(n, (k + 0.5) / r.length)))
    spread()
    for (let sweep = 0; sweep < 8; sweep++) {
      const down = sweep % 2 === 0
      for (const row of down ? rows : [...rows].reverse()) {
        if (!row) continue
        const near = (n: string) => (down ? known.get(n)!.parents.filter((p) => names.has(p)) : (children.get(n) ?? []))
        const mean = new Map(
          row.map((n) => [
            n,
            near(n).length ? near(n).reduce((t, p) => t + place.get(p)!, 0) / near(n).length : place.get(n)!,
          ]),
        )
        row.sort((a, b) => mean.get(a)! - mean.get(b)!)
        row.forEach((n, k) => place.set(n, (k + 0.5) / row.length))
      }
    }
    // From left to right: names are wide and low, so that ranks are columns.
    const [high, gap, between] = [34, 8, 64]
    const widths = rows.map((row) =>
      Math.max(40, ...(row ?? []).map((n) => Math.max(n.length * 7.4, known.get(n)!.kind.length * 6.6) + 18)),
    )
    const tall = Math.max(...rows.map((row) => row?.length ?? 0)) * (high + gap)
    const at = new Map<string, [number, number]>()
    const wide = new Map<string, number>()
    let x = 12
    rows.forEach((row, k) => {
      const top = 12 + (tall - (row?.length ?? 0) * (high + gap)) / 2
      row?.forEach((n, j) => {
        at.set(n, [x, top + j * (high + gap)])
        wide.set(n, widths[k])
      })
      x += widths[k] + between
    })
    const [total, height] = [x - between + 12, tall + 16]
    const picture = s('svg', {
      width: total,
      height,
      viewBox: `0 0 ${total} ${height}`,
      class: 'digraph',
      role: 'group',
      'aria-label': 'dependencies',
    })
    // Those of the selected object on top of the others.
    for (const lit of [false, true])
      for (const o of all)
        for (const p of o.parents) {
          const [a, b] = [at.get(p), at.get(o.name)]
          if (!a || !b || lit !== (o.name === selected || p === selected)) continue
          const [from, to] = [
            [a[0] + wide.get(p)!, a[1] + high / 2],
            [b[0], b[1] + high / 2],
          ]
          const middle = (from[0] + to[0]) / 2
          picture.append(
            s('path', {
              d: `M${from[0]} ${from[1]}C${middle} ${from[1]} ${middle} ${to[1]} ${to[0]} ${to[1]}`,
              class: lit ? 'edge lit' : 'edge',
            }),
          )
        }
    for (const o of all) {
      const [x, y] = at.get(o.name)!
      const node = s(
        'g',
        {
          class: `node ${o.class} ${o.state} ${o.name === selected ? 'selected' : ''}`,
          tabindex: 0,
          role: 'button',
        },
        s('rect', { x, y, width: wide.get(o.name)!, height: high, rx: 6 }),
        s('text', { x: x + wide.get(o.name)! / 2, y: y + 14, class: 'name' }, o.name, ' '),
        s('text', { x: x + wide.get(o.name)! / 2, y: y + 28, class: 'kind' }, o.kind),
      )
      node.addEventListener('click', () => this.act.select(o.name, 'graph'))
      node.addEventListener('keydown', (e) => (e as KeyboardEvent).key === 'Enter' && this.act.select(o.name, 'graph'))
      node.addEventListener('pointerenter', () => this.act.hover(o.name))
      picture.append(node)
    }
    return [...(note ? [h('p', { class: 'quiet pad' }, note)] : []), picture]
  }

  private async curvature(): Promise<(HTMLElement | SVGElement)[]> {
    const selected = this.act.selected()
    const curves = model.objects.filter((o) => ['curve', 'snake'].includes(o.class) && o.state === 'ok')
    const parents = model.objects.find((o) => o.name === selected)?.parents ?? []
    const names = curves.some((o) => o.name === selected)
      ? [selected]
      : curves.map((o) => o.name).filter((n) => parents.includes(n))
    const wanted = names.length ? names : curves.slice(0, 6).map((o) => o.name)
    if (!wanted.length) return [h('p', { class: 'quiet pad' }, 'The model has no curves.')]
    const frame = await this.link.ask('combs', { names: wanted })
    return (frame.head.combs as any[]).map((comb) => {
      const [x, y] = [frame.floats(comb.length), frame.floats(comb.curvature)]
      return h(
        'figure',
        { class: 'plan' },
        h('figcaption', {}, `Curvature of ${comb.name} over its length`),
        plot({ x, y }, null, model.unit, `curvature from 0 to ${shown(Math.max(...y), 3)}`),
      )
    })
  }
}

interface Curve {
  x: Float32Array
  y: Float32Array
}

/** A line over axes that name their ends, with a pale one to compare. */
function plot(now: Curve, before: Curve | null, unit: string, label: string): HTMLElement {
  const [w, height, left, bottom] = [640, 220, 62, 30]
  const both = before ? [before, now] : [now]
  const most = Math.max(...both.flatMap((c) => [...c.y]), 1e-12)
  const [start, end] = [Math.min(...both.map((c) => c.x[0])), Math.max(...both.map((c) => c.x[c.x.length - 1]))]
  const X = (x: number) => left + ((w - left - 12) * (x - start)) / (end - start || 1)
  const Y = (y: number) => height - bottom - ((height - bottom - 12) * y) / most
  const path = (c: Curve) =>
    Array.from(c.x, (x, k) => `${k ? 'L' : 'M'}${X(x).toFixed(1)} ${Y(c.y[k]).toFixed(1)}`).join('')
  const picture = s(
    'svg',
    { viewBox: `0 0 ${w} ${height}`, class: 'plot', role: 'img', 'aria-label': label },
    s('path', { d: `M${left} 12V${height - bottom}H${w - 12}`, class: 'axis' }),
    ...both.map((c) => s('path', { d: path(c), class: c === now ? 'curve' : 'curve before' })),
    s('text', { x: left - 6, y: 18, class: 'end' }, shown(most, 3)),
    s('text', { x: left - 6, y: height - bottom, class: 'end' }, '0'),
    s('text', { x: w - 12, y: height - 10, class: 'end' }, `${shown(end, 4)} ${unit}`),
    s('text', { x: left, y: height - 10 }, shown(start, 4)),
  )
  return h('div', {}, picture)
}
