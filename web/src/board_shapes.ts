// Shapes by gesture: what is chosen, and one answer, become a command.

import { fresh, labels, quoted } from './board_edit'
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
  /** The object that is shown then. */
  shows?(answer: string): string
}

/** Raises a section on a face from its body, or sinks it into the body: one solid more, and the two as one. */
function onFace(d: Drawn, words: string, key: string, verb: string, side: number): Shape {
  const { body, outward } = d.place!
  const way = side * outward
  const parts = (answer: string): [string, string] => {
    const [height, into] = answer.split(/\s+into\s+/i)
    return [height.trim(), into?.trim() || fresh(d, body.replace(/\d+$/, '') || 'PART')]
  }
  const value = (text: string) => {
    if (way > 0) return /^[\d.]+\s*[a-z]*$/i.test(text) ? text : `"${text}"`
    return /^[\d.]+\s*[a-z]*$/i.test(text) ? `-${text}` : `"-(${text})"`
  }
  return {
    words,
    key,
    asks: side > 0 ? 'height above the face' : 'depth below the face',
    command: (answer) => {
      const [height, into] = parts(answer)
      const tool = fresh(d, side > 0 ? 'PAD' : 'POCKET')
      return `EXTRUDE ${quoted(d.object!)} ${value(height)} INTO ${tool}\n${verb} ${quoted(body)} ${tool} INTO ${quoted(into)}`
    },
    last: true,
    shows: (answer) => parts(answer)[1],
  }
}

const place = (answer: string) => answer.replace(/\s*\bat\b\s*/i, ' AT ').replace(/,/g, ' ')

/** What can be made of what is chosen. */
export function shapes(d: Drawn, chosen: Set<string>): Shape[] {
  if (!d.object || !(d.lines.length || d.faces)) return []
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
    if (d.place) made.push(onFace(d, 'Raise', 'e', 'UNION', 1), onFace(d, 'Sink', 'k', 'CUT', -1))
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
    const edges = lines.length ? `LINE ${lines.join(' ')}` : 'ALL'
    for (const verb of ['Fillet', 'Chamfer'])
      made.push({
        words: verb,
        key: '',
        asks: `${verb === 'Fillet' ? 'radius' : 'distance'} at ${lines.length ? `line ${lines.join(' ')}` : 'all edges'}`,
        command: (x) => {
          const [size, into] = x.split(/\s+into\s+/i)
          return `${verb.toUpperCase()} ${d.object} ${size} EDGES ${edges}${into ? ` INTO ${into}` : ''}`
        },
        last,
      })
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
