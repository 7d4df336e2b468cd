// Shapes by gesture: what is chosen, and one answer, become a command.

import { labels } from './board_edit'
import type { Drawn } from './board_paint'

export interface Shape {
  words: string
  /** Its key; none for those that are rarely wanted. */
  key: string
  /** The request. */
  asks: string
  command(answer: string): string
  /** Whether it comes after what makes the body. */
  last: boolean
}

const place = (answer: string) => answer.replace(/\s*\bat\b\s*/i, ' AT ').replace(/,/g, ' ')

/** What can be made of what is chosen. */
export function shapes(d: Drawn, chosen: Set<string>): Shape[] {
  if (!d.object || !d.lines.length) return []
  const [points, lines] = [labels(chosen, 'p'), labels(chosen, 'l')]
  const made: Shape[] = []
  const last = d.faces > 0
  const corner =
    points.length === 1 && !lines.length && d.lines.filter((l) => l[1] === points[0] || l[2] === points[0]).length > 1
      ? `CORNER ${points[0]}`
      : points.length === 3 && !lines.length
        ? `CORNER ${points.join(' ')}`
        : lines.length === 2 && !points.length
          ? `LINES ${lines.join(' ')}`
          : ''
  if (corner) made.push({ words: 'Round', key: 'r', asks: 'radius', command: (x) => `ARC ${corner} RADIUS ${x}`, last })
  if (d.section) {
    made.push({
      words: 'Circle',
      key: '',
      asks: 'diameter, or diameter at p q',
      command: (x) => `CIRCLE DIAMETER ${place(x)}`,
      last: false,
    })
    if (lines.length === 1)
      made.push({
        words: 'Revolve',
        key: '',
        asks: 'degrees about the line',
        command: (x) => `REVOLVE ${lines[0]} ${x}`,
        last: true,
      })
    made.push({
      words: 'Offset',
      key: '',
      asks: 'distance, negative for inwards, into a name',
      command: (x) => `OFFSET ${d.object} ${x.replace(/\binto\b/i, 'INTO')}`,
      last: true,
    })
    made.push({
      words: 'Sweep',
      key: '',
      asks: 'along the path of a name',
      command: (x) => `SWEEP ${d.object} ALONG ${x}`,
      last: true,
    })
    made.push({
      words: 'Loft',
      key: '',
      asks: 'to the sections of names',
      command: (x) => `LOFT ${d.object} ${x.replace(/,/g, ' ')}`,
      last: true,
    })
    made.push({ words: 'Extrude', key: '', asks: 'depth', command: (x) => `EXTRUDE ${x}`, last: true })
  } else if (last) {
    made.push({
      words: 'Hole',
      key: '',
      asks: 'diameter at p q',
      command: (x) => `HOLE ${d.object} ${place(x)}`,
      last: true,
    })
    made.push({
      words: 'Pattern',
      key: '',
      asks: 'count and step: n dx dy dz',
      command: (x) => `PATTERN ${d.object} LINEAR ${x.replace(/,/g, ' ')}`,
      last: true,
    })
  }
  const others = d.objects.filter((name) => name !== d.object)
  if (others.length && last)
    for (const verb of ['UNION', 'CUT', 'COMMON'])
      made.push({
        words: `${verb[0]}${verb.slice(1).toLowerCase()}`,
        key: '',
        asks: `with ${others.join(', ')}`,
        command: (x) => `${verb} ${d.object} ${x}`,
        last: true,
      })
  return made
}
