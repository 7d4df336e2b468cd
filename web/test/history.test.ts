import { redo, undo, undoDepth } from '@codemirror/commands'
import { EditorState } from '@codemirror/state'
import { expect, test } from 'vitest'
import { keptSteps, stepEnds } from '../src/history'

test('typing and its deletion are two steps, which are taken back and done again', () => {
  let state = EditorState.create({ doc: 'ab\n', extensions: keptSteps() })
  const dispatch = (tr: { state: EditorState }) => (state = tr.state)
  const change = (from: number, to: number, insert: string, userEvent: string) =>
    dispatch(state.update({ changes: { from, to, insert }, selection: { anchor: from + insert.length }, userEvent }))
  change(3, 3, '1', 'input.type')
  change(4, 4, 'e', 'input.type')
  for (const end of [5, 4, 3]) change(end - 1, end, '', 'delete.backward')
  expect([state.doc.toString(), undoDepth(state)]).toEqual(['ab', 2])
  const texts = ['ab\n1e', 'ab\n']
  for (const text of texts) {
    undo({ state, dispatch })
    expect(state.doc.toString()).toBe(text)
  }
  for (const text of ['ab\n1e', 'ab']) {
    redo({ state, dispatch })
    expect(state.doc.toString()).toBe(text)
  }
})

test('what is typed after saving is a step of its own, however soon', () => {
  let state = EditorState.create({ extensions: keptSteps() })
  const dispatch = (tr: { state: EditorState }) => (state = tr.state)
  const type = (insert: string) =>
    dispatch(state.update({ changes: { from: state.doc.length, insert }, userEvent: 'input.type' }))
  type('a')
  type('b')
  dispatch(state.update({ annotations: stepEnds }))
  type('c')
  undo({ state, dispatch })
  expect(state.doc.toString()).toBe('ab')
  undo({ state, dispatch })
  expect(state.doc.toString()).toBe('')
})
