// Commands for what is chosen on the drawing board.

import { type Drawn, letter, type Mark } from './board_paint'
import type { Facts } from './frame'

/** A number, with or without a unit; the rest is an expression, in quotes. */
const PLAIN = /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?\s*[a-z]*$/i

/** Marks of what is chosen: `p3` is point 3, `l7` line 7. */
export const labels = (chosen: Iterable<string>, kind: 'p' | 'l'): number[] =>
  [...chosen].filter((c) => c[0] === kind).map((c) => Number(c.slice(1)))

/** The name of an object as commands have it. */
export const quoted = (name: string): string => (/^[A-Za-z_]\w*$/.test(name) ? name : `"${name}"`)

/** A name with a number that no object has. */
export function fresh(drawn: Drawn, name: string): string {
  const used = new Set(drawn.objects.map((o) => o.toUpperCase()))
  let k = 1
  while (used.has(`${name}${k}`.toUpperCase())) k++
  return `${name}${k}`
}

const written = (x: number) => Number(x.toPrecision(12))

/** The command for a missing dimension, under a name that is free. */
export function dimensioned(drawn: Drawn, mark: Mark, value: string): string {
  let k = 1
  const used = new Set(Object.keys(drawn.numbers).map((n) => n.toUpperCase()))
  while (used.has(`D${k}`)) k++
  const given = PLAIN.test(value) ? value : `"${value}"`
  return `DIMENSION D${k} ${mark.axis} ${mark.p} TO ${mark.q} = ${given}`
}

/**
 * Commands that draw the chosen lines and points again, moved on the page, and the marks of the copies.
 *
 * Types that were given go with their lines; guesses are made anew. Lines with a common end keep it.
 */
export function duplicated(
  drawn: Drawn,
  chosen: Iterable<string>,
  [du, dv]: [number, number],
): { commands: string[]; chosen: string[] } {
  const all = [...chosen]
  const lines = drawn.lines.filter((l) => labels(all, 'l').includes(l[0]))
  const ends = new Set([...labels(all, 'p'), ...lines.flatMap((l) => [l[1], l[2]])])
  let point = Math.max(0, ...drawn.points.map((p) => p[0]))
  let line = Math.max(0, ...drawn.lines.map((l) => l[0]))
  const copies = new Map<number, number>()
  const commands: string[] = []
  for (const [label, u, v] of drawn.points) {
    if (!ends.has(label)) continue
    copies.set(label, ++point)
    commands.push(`POINT ${point} AT ${written(u + du)} ${written(v + dv)}`)
  }
  const made: string[] = [...copies.values()].map((p) => `p${p}`)
  for (const [, p, q, type, by] of lines) {
    const given = by === 'user' && type ? ` TYPE ${letter(type, drawn.section)}` : ''
    commands.push(`LINE ${++line} FROM ${copies.get(p)} TO ${copies.get(q)}${given}`)
    made.push(`l${line}`)
  }
  return { commands, chosen: made }
}

/** What a step of the history is called: the command, or what is changed where it is written. */
export function named(changes: Facts[]): string {
  const [first] = changes
  const more = changes.length > 1 ? ` and ${changes.length - 1} more` : ''
  const words: Record<string, () => string> = {
    run: () => String(first.command).split('\n')[0],
    move: () => `Move point ${first.point}`,
    type: () => `Type of line ${first.lines}: ${first.type}`,
    value: () => `${first.name} = ${first.value}`,
    axes: () => `Axes ${first.axes}`,
    place: () => `Point ${first.point} at ${first.at.join(' ')}`,
  }
  const name = words[first.do]?.() ?? 'Edit'
  return `${name.length > 60 ? `${name.slice(0, 59)}…` : name}${more}`
}
