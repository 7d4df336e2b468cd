import { expect, test } from 'vitest'
import { commonPrefix, rangeOf, stepped } from '../src/panels'
import type { ParamFact } from '../src/protocol'

const param = (value: number, range: [number, number] | null = null) =>
  ({ name: 'p', value, default: value, range, whole: false, written: true, place: null }) as ParamFact

test('a slider has the declared range, or one around the value', () => {
  expect(rangeOf(param(3, [1, 9]))).toEqual({ low: 1, high: 9, stated: true })
  expect(rangeOf(param(3))).toEqual({ low: 1.5, high: 6, stated: false })
  expect(rangeOf(param(-3))).toEqual({ low: -6, high: -1.5, stated: false })
  expect(rangeOf(param(0))).toEqual({ low: -1, high: 1, stated: false })
})

test('a step has the digits that it is worth', () => {
  expect(stepped(1.23456, 0, 10, false)).toBe(1.23)
  expect(stepped(1.23456, 0, 0.01, false)).toBe(1.23456)
  expect(stepped(1234.56, 0, 1e4, false)).toBe(1235)
  expect(stepped(2.6, 0, 10, true)).toBe(3)
})

test('names of one part are shown without it', () => {
  expect(commonPrefix(['a.x', 'a.y'])).toBe('a.')
  expect(commonPrefix(['a.b.x', 'a.b.y'])).toBe('a.b.')
  expect(commonPrefix(['a.x', 'b'])).toBe('')
  expect(commonPrefix(['alone'])).toBe('')
  expect(commonPrefix([])).toBe('')
})
