import { describe, expect, it } from 'vitest'
import { inputsOf, left } from '../src/studies'

describe('time left', () => {
  it('is in seconds, minutes and hours', () => {
    expect([0.2, 1, 89.4, 90, 3599, 5400, 86_400].map(left)).toEqual([
      '1 s',
      '1 s',
      '89 s',
      '2 min',
      '60 min',
      '2 h',
      '24 h',
    ])
  })
})

describe('the inputs of a row', () => {
  const page = { inputs: ['beam', 'P.y'], outputs: ['area'], objectives: {}, count: 1, first: 0, rows: [], points: [] }

  it('are its first numbers, by name', () => {
    const row = { row: 3, numbers: [2, 0.5, 7], state: 'done', message: '', front: false }
    expect(inputsOf(page, row)).toEqual({ beam: 2, 'P.y': 0.5 })
  })

  it('are known of a case without outputs', () => {
    const row = { row: 3, numbers: [2, 0.5, null], state: 'refused', message: 'x', front: false }
    expect(inputsOf(page, row)).toEqual({ beam: 2, 'P.y': 0.5 })
  })
})
