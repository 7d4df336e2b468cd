import { expect, test } from 'vitest'
import { figure, unitOf } from '../src/figures'
import type { ObjectFact } from '../src/protocol'
import { model } from '../src/state'
import { floats, usualNumbers, usualOf } from '../src/usual'

test('the engine decides whether a model floats', () => {
  expect(floats('y', 129.8)).toBe(true)
  expect(floats('xy', 1e-9)).toBe(true)
  for (const immersed of [0, undefined, null, 'NaN', -1]) expect(floats('y', immersed)).toBe(false)
  expect(floats('', 129.8)).toBe(false)
})

test('numbers of others are left out', () => {
  const all = [...new Set([...usualNumbers(true), ...usualNumbers(false)])].map((expression) => ({ expression }))
  expect(usualOf(all, true).map((w) => w.expression)).toEqual(usualNumbers(true))
  expect(
    usualOf(all, false)
      .map((w) => w.expression)
      .sort(),
  ).toEqual([...usualNumbers(false)].sort())
})

const object = (name: string, kind: string, cls: string, parents: string[] = []): ObjectFact => ({
  name,
  kind,
  class: cls,
  state: 'ok',
  shown: true,
  parents,
})

const part = [object('a', 'Set', 'set'), object('part', 'SetBody', 'mesh', ['a'])]
const weight = object('w', 'Weight', 'record')

test('a single body has its volume, centre and inertia, and stated weights their mass', () => {
  expect(usualNumbers(false, [...part, weight])).toEqual([
    'mesh.area',
    'part.volume',
    'part.centroid',
    'inertia(a)[1].x',
    'inertia(a)[2].y',
    'inertia(a)[3].z',
    'w.mass',
    'w.centre',
  ])
  // A set without a name has no inertia here; several bodies have the sums of the panels.
  expect(usualNumbers(false, [object('part', 'SetBody', 'mesh')])).toEqual([
    'mesh.area',
    'part.volume',
    'part.centroid',
  ])
  expect(usualNumbers(false, [...part, object('s', 'RuledSurf', 'surface')])).toEqual(usualNumbers(false))
  expect(usualNumbers(true, [...part, object('all', 'WeightSum', 'record')]).slice(-2)).toEqual([
    'all.mass',
    'all.centre',
  ])
})

test('every usual number has a name and the unit of its power', () => {
  model.unit = 'm'
  for (const expression of [...usualNumbers(false, [...part, weight]), ...usualNumbers(true)])
    expect(figure(expression)?.[1], expression).toBeTruthy()
  expect(unitOf('part.volume')).toBe('m³')
  expect(unitOf('inertia(a)[2].y')).toBe('m⁵')
  expect(unitOf('part.centroid')).toBe('m')
  expect(unitOf('beam * 2')).toBe('')
  expect(unitOf('w.mass')).toBe('')
  model.mirror = 'y'
  expect(figure('mesh.volume')?.[1]).toBe('volume that the panels enclose, one half')
  expect(figure('hydrostatics.volume')?.[1]).not.toContain('half')
  model.mirror = ''
})
