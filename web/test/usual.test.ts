import { expect, test } from 'vitest'
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
