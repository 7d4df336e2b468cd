import { expect, test } from 'vitest'
import { Changes } from '../src/changes'

/** An editor whose server takes a while to have each change. */
function slowEditor(log: string[]) {
  let pending = false
  return {
    file: '',
    synced: async () => {
      while (pending) await new Promise((r) => setTimeout(r, 1))
    },
    apply: () => {
      pending = true
      setTimeout(() => {
        log.push('stored')
        pending = false
      }, 20)
    },
  }
}

test('settled means that the server has the text of the last change', async () => {
  const log: string[] = []
  const later = (ms: number) => new Promise((r) => setTimeout(r, ms))
  const link = {
    ask: async () => (await later(10), { head: { edits: [{ from: 0, to: 0, insert: 'x' }], version: 0 } }),
  }
  const changes = new Changes(link as any, null, log.push.bind(log), () => {})
  const editor = slowEditor(log)
  changes.editor = editor as any
  changes.files = { all: [editor] } as any
  changes.hands = { settled: async () => {} } as any
  changes.rest('width', async () => changes.edits('write', { values: { width: 2 } }, 'width'))
  void changes.rested()
  await changes.settled()
  expect(log).toEqual(['stored'])
})
