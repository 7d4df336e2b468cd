// A page inside of an editor: the text is the editor's own document, and its undo takes back what a hand does here.
//
// `host -> page: text, files, cursor`   `page -> host: ready, edit, show, save, undo, redo, read, download`
//
// Places are lines and columns, so that the ends of lines in the document do not matter. An edit names the version
// of the document that it was made for; the host refuses one that is too old by sending the text again.

import type { Text } from '@codemirror/state'
import type { Editor } from './editor'
import type { Facts } from './frame'
import { LivingLink, WorkerEngine } from './living'
import type { EditFact } from './protocol'

interface Api {
  postMessage(message: unknown): void
}

/** The door to the host, where there is one. */
export function door(): Api | null {
  const acquire = (globalThis as unknown as { acquireVsCodeApi?: () => Api }).acquireVsCodeApi
  return acquire ? acquire() : null
}

export interface HostActions {
  editor: () => Editor
  say(words: string): void
  /** The cursor of the host is at a place of the text. */
  cursor(offset: number): void
}

export class Host {
  readonly link: LivingLink
  private readonly engine: WorkerEngine
  private version = 0
  private readonly files = new Map<string, Facts>()
  private act: HostActions | null = null

  constructor(
    private readonly api: Api,
    hello: Facts,
    where: { worker: string; engine: string },
  ) {
    // A webview may not start a worker of its own files, nor may a worker fetch them: the page does both.
    const make = async () => {
      const script = await fetch(where.worker)
      return new Worker(URL.createObjectURL(new Blob([await script.text()], { type: 'text/javascript' })))
    }
    const beginning = async () => {
      const reply = await fetch(where.engine)
      if (!reply.ok) throw new Error('the engine for pages is not part of this installation')
      return { packed: await reply.arrayBuffer(), name: hello.name, files: [] }
    }
    this.version = hello.document
    this.engine = new WorkerEngine(make, beginning)
    this.engine.onMissing = (files) => api.postMessage({ kind: 'read', files })
    this.link = new LivingLink(hello, null, this.engine, false)
    addEventListener('message', (event) => this.hear(event.data))
  }

  begin(act: HostActions): void {
    this.act = act
    const editor = act.editor()
    editor.onEdit = (before, changes) => this.edit(before, changes)
    editor.onShow = (place, focus) => {
      const { doc } = editor.view.state
      this.api.postMessage({ kind: 'show', from: spot(doc, place[0]), to: spot(doc, place[1]), focus })
    }
    this.api.postMessage({ kind: 'ready' })
  }

  save(): void {
    this.api.postMessage({ kind: 'save' })
  }

  undo(back: boolean): void {
    this.api.postMessage({ kind: back ? 'undo' : 'redo' })
  }

  /** A file for the person: a webview has no downloads. */
  async give(blob: Blob, name: string): Promise<void> {
    const bytes = new Uint8Array(await blob.arrayBuffer())
    let raw = ''
    for (let k = 0; k < bytes.length; k += 0x8000) raw += String.fromCharCode(...bytes.subarray(k, k + 0x8000))
    this.api.postMessage({ kind: 'download', name, data: btoa(raw) })
  }

  private edit(before: Text, changes: EditFact[]): void {
    if (!changes.length) return
    const all = changes.map(({ from, to, insert }) => ({ from: spot(before, from), to: spot(before, to), insert }))
    this.api.postMessage({ kind: 'edit', version: this.version, changes: all })
  }

  private hear(message: Facts): void {
    const act = this.act
    if (!message || typeof message !== 'object' || !act) return
    if (message.kind === 'text') {
      this.version = message.version
      act.editor().replace(String(message.text), false, true)
      if (message.refused) act.say('The text was changed meanwhile: do it again')
    } else if (message.kind === 'cursor') {
      const { doc } = act.editor().view.state
      const line = doc.line(Math.max(1, Math.min(doc.lines, message.line + 1)))
      act.cursor(Math.min(line.to, line.from + message.character))
    } else if (message.kind === 'files') {
      for (const f of message.files as Facts[]) this.files.set(JSON.stringify([f.path, f.from]), f)
      this.engine.give([...this.files.values()])
      void this.link.restart()
    }
  }
}

function spot(doc: Text, offset: number): { line: number; character: number } {
  const line = doc.lineAt(Math.max(0, Math.min(doc.length, offset)))
  return { line: line.number - 1, character: offset - line.from }
}
