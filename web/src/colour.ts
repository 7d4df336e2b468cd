// Colours that everyone can tell apart, and scales for numbers.

import colours from '../../python/moldloft/colours.json'

/** Patches have them in turn; neighbours never have the same. */
export const HUES = colours.turn.map((k) => Number.parseInt(colours.model[k].slice(1), 16))

type Names = { [K in keyof typeof colours]: (typeof colours)[K] extends string ? K : never }[keyof typeof colours]

/** Kinds of lines and points that have a colour for each theme. */
export type Line = Names extends infer N ? (N extends `line-${infer K}-dark` ? K : never) : never

/** A colour of the file as a number. */
export const ink = (name: Names): number => Number.parseInt(colours[name].slice(1), 16)

/** The axes x, y and z. */
export const AXIS_INKS = [colours.x, colours.y, colours.z]

export const hex = (n: number): [number, number, number] => [
  ((n >> 16) & 255) / 255,
  ((n >> 8) & 255) / 255,
  (n & 255) / 255,
]

const stops = (text: string) => text.split(' ').map((word) => hex(parseInt(word, 16)))

const BATLOW = stops('011959 114360 226061 4d734d 828231 c09036 f29d6d fdb4b6 faccfa')
const VIK = stops('001261 034481 307da6 94bed2 ece5e0 dbaa8d c27041 912d06 590008')

export interface Scale {
  low: number
  high: number
  signed: boolean
}

/** The range of nearly all values: 2 and 98 percent, about 0 for signed ones. */
export function scale(values: Float32Array[], signed: boolean): Scale {
  const all: number[] = []
  const total = values.reduce((n, v) => n + v.length, 0)
  const step = Math.max(1, Math.floor(total / 20000))
  for (const v of values) for (let k = 0; k < v.length; k += step) if (Number.isFinite(v[k])) all.push(v[k])
  all.sort((a, b) => a - b)
  if (all.length === 0) return { low: 0, high: 1, signed }
  const at = (share: number) => all[Math.min(all.length - 1, Math.floor(share * all.length))]
  let [low, high] = [at(0.02), at(0.98)]
  if (signed) {
    const most = Math.max(Math.abs(low), Math.abs(high))
    ;[low, high] = [-most, most]
  }
  if (high - low < 1e-12 * Math.max(1e-300, Math.abs(high)))
    [low, high] = [low - 0.5e-9 - Math.abs(low) * 1e-6, high + 0.5e-9 + Math.abs(high) * 1e-6]
  return { low, high, signed }
}

export function coloured(x: number, { low, high, signed }: Scale): [number, number, number] {
  if (!Number.isFinite(x)) return [0.5, 0.5, 0.5]
  const map = signed ? VIK : BATLOW
  const at = Math.max(0, Math.min(1, (x - low) / (high - low))) * (map.length - 1)
  const k = Math.min(map.length - 2, Math.floor(at))
  const [a, b, t] = [map[k], map[k + 1], at - k]
  return [0, 1, 2].map((c) => a[c] + t * (b[c] - a[c])) as [number, number, number]
}

export function ramp(signed: boolean): string {
  const map = signed ? VIK : BATLOW
  const css = map.map((c) => `rgb(${c.map((x) => Math.round(255 * x)).join(' ')})`)
  return `linear-gradient(to right, ${css.join(', ')})`
}
