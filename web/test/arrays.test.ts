import { expect, test } from 'vitest'
import { arraysOf, grouped, rowEdits } from '../src/arrays'

const TEXT = `# farray no = {9, 9};
farray a = {0, .5, -1e-3,
            2.};   # farray b = {1};
iarray n = {1, 2, 3, 4};
farray computed = {1, 2*k}; farray rows = {{1, 2}, {3, 4}}; farray none = {};
farray c = {1, # the first
  2};
print("farray d = {1, 2};");
`
/** True in comments, which end with the line, and in strings. */
function skipped(at: number): boolean {
  const before = TEXT.slice(TEXT.lastIndexOf('\n', at - 1) + 1, at + 1)
  return before.includes('#') || (before.split('"').length - 1) % 2 === 1
}
const words = (p: { from: number; to: number }) => TEXT.slice(p.from, p.to)

test('numbers are found where they are written', () => {
  const found = arraysOf(TEXT, skipped)
  expect(found.map((a) => [a.name, ...a.columns[0].numbers.map(words)])).toEqual([
    ['a', '0', '.5', '-1e-3', '2.'],
    ['n', '1', '2', '3', '4'],
    ['c', '1', '2'],
  ])
  expect(grouped(found).map((g) => g.map((a) => a.name))).toEqual([['a', 'n'], ['c']])
})

const put = (text: string, edits: { from: number; to: number; insert: string }[]) =>
  [...edits].sort((a, b) => b.from - a.from).reduce((t, e) => t.slice(0, e.from) + e.insert + t.slice(e.to), text)

test('a row is added to all columns, and taken away again', () => {
  const [group] = grouped(arraysOf(TEXT, skipped))
  const more = put(TEXT, rowEdits(group, TEXT, true))
  expect(more).toContain('2., 2.};')
  expect(more).toContain('{1, 2, 3, 4, 4};')
  const less = put(TEXT, rowEdits(group, TEXT, false))
  expect(less).toContain('{0, .5, -1e-3};')
  expect(less).toContain('iarray n = {1, 2, 3};')
})

const POINTS = `farray w[2] = {1, 2}, v = {3, 4};
curve c[ 2 ] = {{0, 0, 0}, {1, .5, # the tip
  -2}};
curve rows = {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}};
curve mixed = {{0, 1}, {2, 3}, {4, 5, 6}}; curve computed = {{0, 0, 2*k}, {1, 0, 0}}; curve x = {w, 0, 0};
`
const inComment = (at: number) => POINTS.slice(POINTS.lastIndexOf('\n', at - 1) + 1, at + 1).includes('#')

test('points are rows beside numbers', () => {
  const found = arraysOf(POINTS, inComment)
  const of = (p: { from: number; to: number }) => POINTS.slice(p.from, p.to)
  const columns = found.flatMap((a) => a.columns.map((c) => [c.name, ...c.numbers.map(of)]))
  expect(columns).toEqual([
    ['w', '1', '2'],
    ['v', '3', '4'],
    ['c.x', '0', '1'],
    ['c.y', '0', '.5'],
    ['c.z', '0', '-2'],
    ['rows.x', '0', '1', '2', '3'],
    ['rows.y', '4', '5', '6', '7'],
    ['rows.z', '8', '9', '10', '11'],
  ])
  const [first, second] = grouped(found)
  expect(first.map((a) => a.name)).toEqual(['w', 'v', 'c'])
  const more = put(POINTS, rowEdits(first, POINTS, true))
  expect(more).toContain('farray w[3] = {1, 2, 2}, v = {3, 4, 4};')
  expect(more).toContain('curve c[ 3 ] = {{0, 0, 0}, {1, .5, # the tip\n  -2}, {1, .5, # the tip\n  -2}};')
  expect(put(POINTS, rowEdits(first, POINTS, false))).toContain('curve c[ 1 ] = {{0, 0, 0}};')
  expect(put(POINTS, rowEdits(second, POINTS, true))).toContain(
    '{{0, 1, 2, 3, 3}, {4, 5, 6, 7, 7}, {8, 9, 10, 11, 11}}',
  )
})
