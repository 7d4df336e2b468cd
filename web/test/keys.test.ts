import { expect, test } from 'vitest'
import { nameOf } from '../src/keys'

const none = { ctrlKey: false, metaKey: false, altKey: false, shiftKey: false }

test('keys have the names of the table', () => {
  expect(nameOf({ ...none, key: 's' })).toBe('S')
  expect(nameOf({ ...none, key: 'S', shiftKey: true })).toBe('Shift+S')
  expect(nameOf({ ...none, key: 'z', metaKey: true, shiftKey: true })).toBe('Ctrl+Shift+Z')
  expect(nameOf({ ...none, key: 'F1' })).toBe('F1')
  // Shift is in the character itself.
  expect(nameOf({ ...none, key: '?', shiftKey: true })).toBe('?')
  expect(nameOf({ ...none, key: '2', altKey: true })).toBe('Alt+2')
})
