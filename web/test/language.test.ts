import { StringStream } from '@codemirror/language'
import { expect, test } from 'vitest'
import { programParser, sketchParser } from '../src/language'

/** The words of a text that have a colour, with it. */
function coloured(parser: typeof sketchParser, text: string): string[] {
  const state = parser.startState!(4)
  return text.split('\n').flatMap((line) => {
    const stream = new StringStream(line, 4, 4)
    const found: string[] = []
    while (!stream.eol()) {
      const colour = parser.token(stream, state)
      if (colour && colour !== 'variableName') found.push(`${stream.current()}:${colour}`)
      stream.start = stream.pos
    }
    return found
  })
}

test('a comment of a sketch is no program', () => {
  const text = '! not in scale, "only"\nPOINT 1 AT -2 1; LINE 1 2 # in\nDIM X 1 2 = &\nWIDTH "W in"'
  expect(coloured(sketchParser, text)).toEqual([
    '! not in scale, "only":comment',
    'POINT:keyword',
    '1:number',
    '-2:number',
    '1:number',
    'LINE:keyword',
    '1:number',
    '2:number',
    '# in:comment',
    'DIM:keyword',
    '1:number',
    '2:number',
    '"W in":string',
  ])
})

test('words of a program have the colours of the tables', () => {
  const parser = programParser({ keyword: new Set(['param']), kind: new Set(['Line']), function: new Set(['sin']) })
  const found = coloured(parser as unknown as typeof sketchParser, 'param sin x = sin(1.5e3); Line "a # b" # end')
  expect(found).toEqual([
    'param:keyword',
    'sin:macroName',
    '1.5e3:number',
    'Line:typeName',
    '":string',
    'a # b":string',
    '# end:comment',
  ])
})
