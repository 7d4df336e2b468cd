import { expect, test } from 'vitest'
import { Contacts } from '../src/contacts'

const contact = (pointerType: string, pointerId: number, width = 20) => ({
  pointerType,
  pointerId,
  width,
  height: width,
})

test('before a pen was seen one finger has the tool and two pinch', () => {
  const c = new Contacts()
  expect(c.down(contact('mouse', 1), [0, 0], 0)).toBe('tool')
  expect(c.down(contact('touch', 2, 90), [0, 0], 0)).toBe('tool')
  expect(c.down(contact('touch', 3), [100, 0], 0)).toBe('pinch')
  expect(c.down(contact('touch', 4), [50, 0], 0)).toBe('palm')
  expect(c.pinch(contact('touch', 3), [200, 0])).toEqual({ factor: 2, middle: [100, 0], by: [50, 0] })
  c.up(contact('touch', 2), 0)
  expect(c.pinch(contact('touch', 3), [210, 0])).toBeNull()
  expect(c.ignored(contact('touch', 2))).toBe(true)
  expect(c.ignored(contact('touch', 3))).toBe(false)
})

test('beside a pen touches are the palm, and after it a finger pans', () => {
  const c = new Contacts()
  const pen = contact('pen', 9)
  expect(c.arrives(pen, 0)).toBe(false)
  expect(c.down(pen, [0, 0], 0)).toBe('tool')
  // However long the pen rests.
  expect(c.down(contact('touch', 2), [0, 0], 60_000)).toBe('palm')
  expect(c.ignored(contact('touch', 2))).toBe(true)
  c.up(pen, 60_000)
  expect(c.down(contact('touch', 3), [0, 0], 60_400)).toBe('palm')
  expect(c.down(contact('touch', 4, 80), [0, 0], 61_000)).toBe('palm')
  expect(c.down(contact('touch', 5), [0, 0], 61_000)).toBe('pan')
  expect(c.down(contact('touch', 6), [9, 0], 61_000)).toBe('pinch')
})

test('a finger that is down when the pen arrives is the palm', () => {
  const c = new Contacts()
  expect(c.down(contact('touch', 1), [0, 0], 0)).toBe('tool')
  // A pen that hovers has arrived.
  expect(c.arrives(contact('pen', 2), 10)).toBe(true)
  expect(c.ignored(contact('touch', 1))).toBe(true)
  expect(c.pinch(contact('touch', 1), [5, 5])).toBeNull()
  expect(c.arrives(contact('pen', 2), 20)).toBe(false)
})
