// Arrays of numbers and of vectors in the text of a program: where each number is written.

import type { EditFact } from './protocol'

export interface Place {
  from: number
  to: number
}

/** Numbers below each other: an array, or a coordinate of an array of vectors. */
export interface Column {
  name: string
  numbers: Place[]
}

/** An array that is written as numbers, or as vectors of three numbers. */
export interface WrittenArray {
  name: string
  columns: Column[]
  /** Each row as it is written: a number, or a vector with its braces. */
  rows: Place[]
  /** The number of rows, where it is declared. */
  size: Place | null
}

const NUMBER = /[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?/y
const DECLARED = /\b(farray|iarray|curve)\s+(\w+)\s*(?:\[\s*(\d+)\s*\]\s*)?=\s*\{/g
/** A further array of the same statement. */
const FURTHER = /,\s*(\w+)\s*(?:\[\s*(\d+)\s*\]\s*)?=\s*\{/y

class Reader {
  at: number

  constructor(
    readonly text: string,
    private readonly skipped: (at: number) => boolean,
    begin: number,
  ) {
    this.at = begin
  }

  space(): void {
    while (this.at < this.text.length && (/\s/.test(this.text[this.at]) || this.skipped(this.at))) this.at++
  }

  /** Items with commas between, up to the closing brace; null when they are something else. */
  list<T>(item: () => T | null): T[] | null {
    const found: T[] = []
    for (;;) {
      this.space()
      const one = item()
      if (one === null) return null
      found.push(one)
      this.space()
      const mark = this.text[this.at++]
      if (mark === '}') return found
      if (mark !== ',') return null
    }
  }

  number = (): Place | null => {
    NUMBER.lastIndex = this.at
    const number = NUMBER.exec(this.text)
    if (!number) return null
    const place = { from: this.at, to: this.at + number[0].length }
    this.at = place.to
    return place
  }

  /** Numbers in braces, and the place of all. */
  row = (): { place: Place; numbers: Place[] } | null => {
    const from = this.at
    if (this.text[this.at] !== '{') return null
    this.at++
    const numbers = this.list(this.number)
    return numbers && { place: { from, to: this.at }, numbers }
  }
}

/** The arrays that a declaration states; none for what is computed. */
function declared(reader: Reader, of: string, name: string, size: Place | null): WrittenArray[] {
  if (of !== 'curve') {
    const numbers = reader.list(reader.number)
    return numbers ? [{ name, columns: [{ name, numbers }], rows: numbers, size }] : []
  }
  const rows = reader.list(reader.row)
  if (!rows) return []
  const named = (k: number) => `${name}.${'xyz'[k]}`
  if (rows.every((r) => r.numbers.length === 3)) {
    const columns = [0, 1, 2].map((k) => ({ name: named(k), numbers: rows.map((r) => r.numbers[k]) }))
    return [{ name, columns, rows: rows.map((r) => r.place), size }]
  }
  // Three rows of another length are the coordinates.
  if (rows.length !== 3 || rows.some((r) => r.numbers.length !== rows[0].numbers.length)) return []
  return rows.map(({ numbers }, k) => ({
    name: named(k),
    columns: [{ name: named(k), numbers }],
    rows: numbers,
    size: k ? null : size,
  }))
}

/** The arrays of a text; `skipped` is true where a comment or a string is. */
export function arraysOf(text: string, skipped: (at: number) => boolean): WrittenArray[] {
  const found: WrittenArray[] = []
  for (const match of text.matchAll(DECLARED)) {
    if (skipped(match.index)) continue
    let [name, count, from, words] = [match[2], match[3], match.index, match[0]]
    for (;;) {
      const bracket = from + words.indexOf('[') + 1
      const first = count === undefined ? null : text.indexOf(count, bracket)
      const size = first === null ? null : { from: first, to: first + count.length }
      const reader = new Reader(text, skipped, from + words.length)
      found.push(...declared(reader, match[1], name, size))
      if (text[reader.at - 1] !== '}') break
      reader.space()
      FURTHER.lastIndex = reader.at
      const more = FURTHER.exec(text)
      if (!more) break
      ;[name, count, from, words] = [more[1], more[2], more.index, more[0]]
    }
  }
  return found
}

/** Neighbours of one length are the columns of one table. */
export function grouped(arrays: WrittenArray[]): WrittenArray[][] {
  const groups: WrittenArray[][] = []
  for (const array of arrays) {
    const last = groups.at(-1)
    if (last && last[0].rows.length === array.rows.length) last.push(array)
    else groups.push([array])
  }
  return groups
}

/** The edits that repeat the last row of a table, or take it away. */
export function rowEdits(group: WrittenArray[], text: string, more: boolean): EditFact[] {
  return group.flatMap(({ rows, size }) => {
    const last = rows.at(-1)!
    const count = size ? [{ ...size, insert: String(rows.length + (more ? 1 : -1)) }] : []
    if (more) return [...count, { from: last.to, to: last.to, insert: `, ${text.slice(last.from, last.to)}` }]
    return [...count, { from: rows.at(-2)!.to, to: last.to, insert: '' }]
  })
}
