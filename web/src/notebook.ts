// A page inside of a notebook's cell: the cell hears each change of the text, and may give another one.
//
// `cell -> page: text`   `page -> cell: ready, text`

import type { Editor } from './editor'

export class Cell {
  private known: string
  private timer = 0

  constructor(private readonly editor: Editor) {
    this.known = editor.text
    addEventListener('message', ({ source, data }) => {
      if (source !== parent || data?.moldloft !== 'text') return
      this.known = String(data.text)
      editor.replace(this.known, false)
    })
    this.send({ moldloft: 'ready' })
  }

  /** The text may have changed. */
  changed(): void {
    clearTimeout(this.timer)
    this.timer = window.setTimeout(() => {
      const { text } = this.editor
      if (text === this.known) return
      this.known = text
      this.send({ moldloft: 'text', text })
    }, 50)
  }

  private send(message: unknown): void {
    // The page is in a frame without an origin: who shows it is the only one that can listen.
    parent.postMessage(message, '*')
  }
}
