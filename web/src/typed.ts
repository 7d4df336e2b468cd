// Numbers as they are typed: plain, as expressions of the model, with units.

import type { Link } from './link'
import { model } from './state'

/** Metres of units of length. */
const METRES: Record<string, number> = {
  mm: 1e-3,
  cm: 1e-2,
  dm: 0.1,
  m: 1,
  km: 1e3,
  in: 0.0254,
  '"': 0.0254,
  ft: 0.3048,
  "'": 0.3048,
  yd: 0.9144,
}
const RADIANS: Record<string, number> = { rad: 1, deg: Math.PI / 180, '°': Math.PI / 180 }

/** Parts of a text: what is in front of a unit, and the unit's factor. */
export function parted(text: string, unit: string): { words: string; factor: number } {
  const words = text.trim().replace(/−/g, '-')
  // A unit comes after a digit, a parenthesis or a space: `beam` does not end in metres.
  const found = /^(.*?[\d.)\s])\s*(mm|cm|dm|km|m|in|ft|yd|"|'|rad|deg|°)$/.exec(words)
  if (!found) return { words, factor: 1 }
  const [, front, name] = found
  if (name in RADIANS) return { words: front.trim(), factor: RADIANS[name] }
  if (!(unit in METRES)) throw new Error(`The model states no unit, so ${name} cannot be converted`)
  // Whole powers of ten stay exact.
  const factor = METRES[name] / METRES[unit]
  return {
    words: front.trim(),
    factor:
      Math.abs(factor - Number(factor.toPrecision(12))) < 1e-15 * factor ? Number(factor.toPrecision(12)) : factor,
  }
}

/** The number that a text means; an error says why it is none. */
export async function typed(text: string, link: Link): Promise<number> {
  const { words, factor } = parted(text, model.unit)
  const plain = Number(/^[-+]?\d+,\d+$/.test(words) ? words.replace(',', '.') : words)
  if (words && Number.isFinite(plain)) return plain * factor
  const { head } = await link.ask('evaluate', { expressions: [words] })
  const [{ value, error }] = head.values
  if (typeof value !== 'number') throw new Error(error ? `“${text}”: ${error}` : `“${text}” is no number`)
  return value * factor
}
