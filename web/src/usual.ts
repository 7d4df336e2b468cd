// Numbers that are watched at first, by the kind of model, and whether it floats: the engine's answer decides.

import usual from '../../python/moldloft/workbench/usual.json'
import type { ObjectFact, ValueFact } from './protocol'

/** The figure by which a model floats. */
export const IMMERSED = 'hydrostatics.volume'

/** A model that is mirrored in its middle plane and displaces water floats; of others the hydrostatics mean nothing. */
export const floats = (mirrored: string, immersed: unknown) =>
  mirrored.includes('y') && typeof immersed === 'number' && immersed > 0

/** Mass and centre of the weights that a model states: those of its sum, or of a single one. */
function masses(objects: ObjectFact[]): string[] {
  const of = (kind: string) => objects.filter((o) => o.kind === kind && o.state === 'ok')
  const [sums, single] = [of('WeightSum'), of('Weight')]
  const weight = sums.at(-1) ?? (single.length === 1 ? single[0] : undefined)
  return weight ? [`${weight.name}.mass`, `${weight.name}.centre`] : []
}

/** The numbers that are watched at first; a single body has its own volume and centre, and inertia if its set has a name. */
export function usualNumbers(floating: boolean, objects: ObjectFact[] = []): string[] {
  if (floating) return [...usual.floating, ...masses(objects)]
  const good = objects.filter((o) => o.state === 'ok')
  const bodies = good.filter((o) => o.shown && ['mesh', 'surface', 'solid'].includes(o.class))
  if (bodies.length !== 1 || bodies[0].class !== 'mesh') return [...usual.other, ...masses(objects)]
  const [{ name, parents }] = bodies
  const set = good.find((o) => o.class === 'set' && parents.includes(o.name))
  const inertia = set ? ['[1].x', '[2].y', '[3].z'].map((part) => `inertia(${set.name})${part}`) : []
  return ['mesh.area', `${name}.volume`, `${name}.centroid`, ...inertia, ...masses(objects)]
}

/** Of the values of all of them those for the model. */
export function usualOf(all: ValueFact[], floating: boolean): ValueFact[] {
  const wanted = usualNumbers(floating)
  return all.filter((w) => wanted.includes(w.expression))
}
