// Arrays of numbers in the text of a program: where each number is written.

export interface Place {
  from: number
  to: number
}

/** An array that is written as numbers; `place` is that of all between its braces. */
export interface WrittenArray {
  name: string
  place: Place
  numbers: Place[]
}

const NUMBER = /[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?/y
const NAMED = /\b(farray|iarray)\s+(\w+)\s*=\s*\{/g

/** The arrays of a text; `skipped` is true where a comment or a string is. */
export function arraysOf(text: string, skipped: (at: number) => boolean): WrittenArray[] {
  const found: WrittenArray[] = []
  for (const match of text.matchAll(NAMED)) {
    if (skipped(match.index)) continue
    const begin = match.index + match[0].length
    const numbers: Place[] = []
    let at = begin
    const space = () => {
      while (at < text.length && (/\s/.test(text[at]) || skipped(at))) at++
    }
    for (;;) {
      space()
      NUMBER.lastIndex = at
      const number = NUMBER.exec(text)
      if (!number) break
      numbers.push({ from: at, to: at + number[0].length })
      at = NUMBER.lastIndex
      space()
      if (text[at] !== ',') break
      at++
    }
    // What is computed, or stacked in rows, is no column of numbers.
    if (text[at] === '}' && numbers.length) found.push({ name: match[2], place: { from: begin, to: at }, numbers })
  }
  return found
}

/** Neighbours of one length are the columns of one table. */
export function grouped(arrays: WrittenArray[]): WrittenArray[][] {
  const groups: WrittenArray[][] = []
  for (const array of arrays) {
    const last = groups.at(-1)
    if (last && last[0].numbers.length === array.numbers.length) last.push(array)
    else groups.push([array])
  }
  return groups
}

interface Edit {
  from: number
  to: number
  insert: string
}

/** The edits that repeat the last row of a table, or take it away. */
export function rowEdits(group: WrittenArray[], text: string, more: boolean): Edit[] {
  return group.map(({ numbers }) => {
    const last = numbers.at(-1)!
    if (more) return { from: last.to, to: last.to, insert: `, ${text.slice(last.from, last.to)}` }
    return { from: numbers.at(-2)!.to, to: last.to, insert: '' }
  })
}
