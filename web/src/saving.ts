// Whether the text is saved, saving it, and a file that another program has changed.

import type { Changes } from './changes'
import { h, store, stored } from './dom'
import { type Editor, fileName } from './editor'
import type { FileTabs } from './file_tabs'
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
  files!: FileTabs

  constructor(
    private readonly link: Link,
    private readonly host: Host | null,
    private readonly shell: Shell,
    private readonly changes: Changes,
    private readonly give: (blob: Blob, name: string) => void,
  ) {}

  /** Whether a text differs from its file. */
  is(file: string | undefined, dirty: boolean): void {
    const editor = this.files.of(file)
    if (editor) editor.dirty = dirty
    if (file !== undefined) this.files.build()
    this.show()
  }

  private get dirty(): boolean {
    return this.files.all.some((editor) => editor.dirty)
  }

  /** Whether the program is joined with the server's: a connection alone is not enough. */
  private get online(): boolean {
    return !!this.files.of()?.online
  }

  private get pending(): boolean {
    return this.files.all.some((editor) => editor.pending)
  }

  private words(): string {
    const ready = document.body.dataset.engine === 'ready'
    if (this.host) return ready ? '' : 'the engine starts…'
    if (this.link.still) return 'as it was'
    if (this.link.local) {
      if (!ready) return 'the engine starts…'
      return !this.dirty ? 'as it was' : keeps() ? 'changed, kept in this browser' : 'changed, not saved'
    }
    const waits = this.pending
    if (!this.online) return waits ? 'not connected: what you type is kept in this page' : 'not connected'
    return waits ? 'sending…' : this.dirty ? 'unsaved changes (draft kept)' : 'saved'
  }

  show(): void {
    const { saved } = this.shell
    saved.textContent = this.words()
    const away = !this.link.local && !this.host && !this.online
    const changed = this.dirty || (!this.link.local && this.pending)
    saved.dataset.state = away ? 'off' : changed ? 'dirty' : 'saved'
  }

  /** Writes all texts that differ from their files. */
  async save(): Promise<void> {
    if (this.host) return this.host.save()
    await this.changes.settled()
    const texts = this.files.all.filter((editor) => !editor.file || editor.dirty)
    let saved = 0
    for (const editor of texts) if (await this.write(editor)) saved++
    if (!this.link.local && saved === texts.length) this.shell.say('Saved')
    this.show()
  }

  private async write(editor: Editor, force = false): Promise<boolean> {
    try {
      editor.view.dispatch({ annotations: stepEnds })
      const answer = await this.link.tell({ kind: 'save', file: editor.file, force })
      if (this.link.local) this.give(new Blob([answer.text], { type: 'text/plain' }), model.name)
      else if (answer.kind === 'conflict') this.conflict(answer.theirs, editor.file)
      else {
        this.is(editor.file, false)
        return true
      }
    } catch (error) {
      this.shell.say((error as Error).message)
    }
    return false
  }

  conflict(theirs: string, file = ''): void {
    const editor = this.files.of(file)
    if (!editor) return
    const lines = (t: string) => t.split('\n').length
    const [there, here] = [lines(theirs), lines(editor.text)]
    const mine = () => void this.write(editor, true).then((done) => done && this.shell.warn(''))
    const take = () => void this.files.show(file).then(() => this.changes.revert())
    this.shell.warn(
      `${file ? fileName(file) : 'The file'} was changed by another program (${there} lines there, ${here} here), and there are changes here, too. `,
      h('button', { onclick: mine }, 'Keep mine, write the file'),
      h('button', { onclick: take }, 'Take theirs'),
      h('button', { onclick: () => this.compare(theirs, editor.text) }, 'Show both'),
    )
  }

  private compare(theirs: string, mine: string): void {
    const dialog = h(
      'dialog',
      { class: 'compare', 'aria-label': 'both texts' },
      h('h3', {}, 'The file'),
      h('pre', {}, theirs),
      h('h3', {}, 'Here'),
      h('pre', {}, mine),
      h('button', { onclick: () => dialog.close() }, 'Close'),
    )
    document.body.append(dialog)
    dialog.addEventListener('close', () => dialog.remove())
    dialog.showModal()
  }
}
