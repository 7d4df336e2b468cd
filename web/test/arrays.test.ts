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
  expect(found.map((a) => [a.name, ...a.numbers.map(words)])).toEqual([
    ['a', '0', '.5', '-1e-3', '2.'],
    ['n', '1', '2', '3', '4'],
    ['c', '1', '2'],
  ])
  expect(grouped(found).map((g) => g.map((a) => a.name))).toEqual([['a', 'n'], ['c']])
})

test('a row is added to all columns, and taken away again', () => {
  const [group] = grouped(arraysOf(TEXT, skipped))
  const put = (text: string, edits: { from: number; to: number; insert: string }[]) =>
    [...edits].reverse().reduce((t, e) => t.slice(0, e.from) + e.insert + t.slice(e.to), text)
  const more = put(TEXT, rowEdits(group, TEXT, true))
  expect(more).toContain('2., 2.};')
  expect(more).toContain('{1, 2, 3, 4, 4};')
  const less = put(TEXT, rowEdits(group, TEXT, false))
  expect(less).toContain('{0, .5, -1e-3};')
  expect(less).toContain('iarray n = {1, 2, 3};')
})
