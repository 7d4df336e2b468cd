// Colours of the words of a text: a program's, and a sketch's. What they mean is the engine's matter.

import type { StreamParser } from '@codemirror/language'

export type Words = Record<string, Set<string>>

/** The language's words come from the engine's own tables. */
export function programParser(words: Words): StreamParser<{ text: boolean }> {
  return {
    startState: () => ({ text: false }),
    token(stream, state) {
      if (state.text) {
        while (!stream.eol()) {
          const c = stream.next()
          if (c === '\\') stream.next()
          else if (c === '"') {
            state.text = false
            break
          }
        }
        return 'string'
      }
      if (stream.eatSpace()) return null
      if (stream.match('#')) {
        stream.skipToEnd()
        return 'comment'
      }
      if (stream.match('"')) {
        state.text = true
        return 'string'
      }
      if (stream.match(/^(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?/)) return 'number'
      const word = stream.match(/^[A-Za-z_]\w*/) as RegExpMatchArray | null
      if (word) {
        const name = word[0]
        if (words.keyword?.has(name)) return 'keyword'
        if (words.kind?.has(name)) return 'typeName'
        if (words.function?.has(name)) return stream.match(/^\s*\(/, false) ? 'macroName' : 'variableName'
        return 'variableName'
      }
      stream.next()
      return null
    },
    languageData: { commentTokens: { line: '#' }, closeBrackets: { brackets: ['(', '[', '{', '"'] } },
  }
}

/** The language of sketches: commands begin lines, or follow a semicolon. */
export const sketchParser: StreamParser<{ begin: boolean; continued: boolean }> = {
  startState: () => ({ begin: true, continued: false }),
  token(stream, state) {
    if (stream.sol()) {
      if (!state.continued) state.begin = true
      state.continued = false
    }
    if (stream.eatSpace()) return null
    if (stream.match(/^[!#].*/)) return 'comment'
    if (stream.match(/^"[^"]*"?|^'[^']*'?/)) return 'string'
    if (stream.match(';')) {
      state.begin = true
      return null
    }
    if (stream.match(/^&\s*$/)) {
      state.continued = true
      return null
    }
    const { begin } = state
    state.begin = false
    if (stream.match(/^[-+]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?(?![A-Za-z_])/)) return 'number'
    if (stream.match(/^[A-Za-z_][\w.]*/)) return begin ? 'keyword' : 'variableName'
    stream.next()
    return null
  },
  languageData: { commentTokens: { line: '!' }, closeBrackets: { brackets: ['(', '"'] } },
}
