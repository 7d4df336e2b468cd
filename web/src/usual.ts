// Numbers that are watched at first, and whether the model floats: the engine's answer decides.

import usual from '../../python/moldloft/workbench/usual.json'
import type { ValueFact } from './protocol'

/** The figure by which a model floats. */
export const IMMERSED = 'hydrostatics.volume'

/** A model that is mirrored in its middle plane and displaces water floats; of others the hydrostatics mean nothing. */
export const floats = (mirrored: string, immersed: unknown) =>
  mirrored.includes('y') && typeof immersed === 'number' && immersed > 0

/** The numbers that are watched at first. */
export const usualNumbers = (floating: boolean): string[] => (floating ? usual.floating : usual.other)

/** Of the values of all of them those for the model. */
export function usualOf(all: ValueFact[], floating: boolean): ValueFact[] {
  const wanted = usualNumbers(floating)
  return all.filter((w) => wanted.includes(w.expression))
}
