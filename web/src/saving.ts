// Whether the text is saved, saving it, and a file that another program has changed.

import type { Changes } from './changes'
import { h, store, stored } from './dom'
import type { Editor } from './editor'
import { stepEnds } from './history'
import type { Host } from './host'
import type { Link } from './link'
import type { Shell } from './shell'
import { model } from './state'

/** Whether this browser keeps what is stored: one without storage forgets. */
function keeps(): boolean {
  store('keeps', true)
  return stored('keeps', false)
}

export class Saving {
  editor!: Editor
  dirty = false
  online = false
  private theirs = ''

  constructor(
    private readonly link: Link,
    private readonly host: Host | null,
    private readonly shell: Shell,
    private readonly changes: Changes,
    private readonly give: (blob: Blob, name: string) => void,
  ) {}

  private words(): string {
    const ready = document.body.dataset.engine === 'ready'
    if (this.host) return ready ? '' : 'the engine starts…'
    if (this.link.still) return 'as it was'
    if (this.link.local) {
      if (!ready) return 'the engine starts…'
      return !this.dirty ? 'as it was' : keeps() ? 'changed, kept in this browser' : 'changed, not saved'
    }
    const waits = this.editor.pending
    if (!this.online) return waits ? 'not connected: what you type is kept in this page' : 'not connected'
    return waits ? 'sending…' : this.dirty ? 'unsaved changes (draft kept)' : 'saved'
  }

  show(): void {
    const { saved } = this.shell
    saved.textContent = this.words()
    const away = !this.link.local && !this.host && !this.online
    const changed = this.dirty || (!this.link.local && this.editor.pending)
    saved.dataset.state = away ? 'off' : changed ? 'dirty' : 'saved'
  }

  async save(force = false): Promise<void> {
    if (this.host) return this.host.save()
    try {
      await this.changes.settled()
      this.editor.view.dispatch({ annotations: stepEnds })
      const answer = await this.link.tell({ kind: 'save', force })
      if (this.link.local) return this.give(new Blob([answer.text], { type: 'text/plain' }), model.name)
      if (answer.kind === 'conflict') this.conflict(answer.theirs)
      else {
        this.dirty = false
        this.shell.say('Saved')
      }
    } catch (error) {
      this.shell.say((error as Error).message)
    }
    this.show()
  }

  conflict(text: string): void {
    this.theirs = text
    const lines = (t: string) => t.split('\n').length
    const [there, here] = [lines(text), lines(this.editor.text)]
    this.shell.warn(
      `The file was changed by another program (${there} lines there, ${here} here), and there are changes here, too. `,
      h('button', { onclick: () => void this.save(true).then(() => this.shell.warn('')) }, 'Keep mine, write the file'),
      h('button', { onclick: () => this.changes.revert() }, 'Take theirs'),
      h('button', { onclick: () => this.compare() }, 'Show both'),
    )
  }

  private compare(): void {
    const dialog = h(
      'dialog',
      { class: 'compare', 'aria-label': 'both texts' },
      h('h3', {}, 'The file'),
      h('pre', {}, this.theirs),
      h('h3', {}, 'Here'),
      h('pre', {}, this.editor.text),
      h('button', { onclick: () => dialog.close() }, 'Close'),
    )
    document.body.append(dialog)
    dialog.addEventListener('close', () => dialog.remove())
    dialog.showModal()
  }
}
