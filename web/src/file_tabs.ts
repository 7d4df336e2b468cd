// The files of one model in tabs: those that it reads are opened beside its own text, each with its own editor, and all
// with one history. What is typed in one counts for the model before it is saved.

import { h, store, stored } from './dom'
import { type Editor, fileName, isSketch } from './editor'
import type { Link } from './link'
import { changed, model, on } from './state'

/** An editor with its place. */
interface Sheet {
  editor: Editor
  place: HTMLElement
}

export interface FileTabActions {
  say(words: string): void
  /** An editor of a file beside the model. */
  make(place: HTMLElement, file: string): Editor
  /** What is saved has changed. */
  saved(): void
}

export class FileTabs {
  readonly element = h('div', { class: 'files', role: 'tablist', 'aria-label': 'files of the model', hidden: true })
  /** Those that are open, by their files; the model's own has no name. */
  private readonly sheets = new Map<string, Sheet>()
  private readonly opening = new Map<string, Promise<Sheet>>()
  private shown = ''

  constructor(
    place: HTMLElement,
    private readonly link: Link,
    main: Editor,
    private readonly act: FileTabActions,
  ) {
    place.before(this.element)
    this.sheets.set('', { editor: main, place })
    this.element.addEventListener('keydown', (e) => this.key(e))
    main.steps.onTurned = (of) => {
      for (const [file, { editor }] of this.sheets) if (editor.view === of) void this.show(file)
    }
    main.onElsewhere = (file, at) => void this.show(file, at)
    on(['files', 'faults'], () => this.build())
  }

  /** The editor that is seen. */
  get current(): Editor {
    return this.sheets.get(this.shown)!.editor
  }

  /** The editors of all open texts. */
  get all(): Editor[] {
    return [...this.sheets.values()].map((s) => s.editor)
  }

  /** That of a file, if it is open. */
  of(file = ''): Editor | undefined {
    return this.sheets.get(file)?.editor
  }

  /** The editor of a file that the model reads; none if the page cannot have its text. */
  async beside(file: string): Promise<Editor | undefined> {
    if (this.link.local) return undefined
    const editor = await this.load(file).then(
      (sheet) => sheet.editor,
      () => undefined,
    )
    await editor?.synced()
    return editor
  }

  /** The sketch that is seen, else the first one: the model itself or a file that it reads. */
  async sketch(): Promise<Editor> {
    const main = this.sheets.get('')!.editor
    if (isSketch(model.name)) return main
    const name = [this.shown, ...model.files].find(isSketch)
    return name === undefined ? main : (await this.load(name)).editor
  }

  /** Opens what was open when the page was last here and what has unsaved changes; what is open joins the server's. */
  begin(unsaved: string[]): void {
    for (const file of new Set([...this.sheets.keys(), ...stored<string[]>(this.kept, []), ...unsaved])) {
      if (!file) continue
      const editor = this.of(file)
      void (editor ? this.again(file, editor) : this.load(file)).catch(() => undefined)
    }
  }

  /** Under which the browser remembers what is open. */
  private get kept(): string {
    return `files.${model.name}`
  }

  private async again(file: string, editor: Editor): Promise<void> {
    const { text, version, dirty } = await this.link.tell({ kind: 'open_file', file })
    editor.rejoin(text, version)
    editor.dirty = dirty
    this.act.saved()
  }

  load(file: string): Promise<Sheet> {
    const sheet = this.sheets.get(file)
    if (sheet) return Promise.resolve(sheet)
    let under = this.opening.get(file)
    if (!under) {
      under = this.fetched(file).finally(() => this.opening.delete(file))
      this.opening.set(file, under)
    }
    return under
  }

  private async fetched(file: string): Promise<Sheet> {
    const { text, version, dirty, recovered } = await this.link.tell({ kind: 'open_file', file })
    const place = h('div', { class: 'editor', hidden: true })
    this.sheets.get('')!.place.after(place)
    const sheet = { editor: this.act.make(place, file), place }
    this.sheets.set(file, sheet)
    sheet.editor.begin(text, version)
    sheet.editor.dirty = dirty
    this.remember()
    this.build()
    this.act.saved()
    if (recovered) this.act.say(`Unsaved changes of ${fileName(file)} of an earlier session are back.`)
    return sheet
  }

  private remember(): void {
    store(
      this.kept,
      [...this.sheets.keys()].filter((file) => file !== ''),
    )
  }

  /** Opens a file, if it is not, and shows it; at a place of it, with the focus there. */
  async show(file: string, at?: [number, number]): Promise<void> {
    try {
      const sheet = await this.load(file)
      if (file !== this.shown) {
        this.shown = file
        for (const [name, { place }] of this.sheets) place.hidden = name !== file
        this.build()
        changed('shown')
        sheet.editor.view.requestMeasure()
      }
      if (at) sheet.editor.show(at, true)
    } catch (error) {
      this.act.say((error as Error).message)
    }
  }

  /** Shows the model's own text and no longer this one; its steps stay in the history. */
  private close(file: string): void {
    const editor = this.of(file)
    if (!editor) return
    if (editor.dirty || editor.pending) return this.act.say(`${fileName(file)} has unsaved changes: save or undo them`)
    if (editor.steps.has(editor.view)) return this.act.say(`${fileName(file)} has steps in the history: it stays open`)
    this.sheets.get(file)!.place.remove()
    this.sheets.delete(file)
    editor.view.destroy()
    void this.link.tell({ kind: 'close_file', file }).catch(() => undefined)
    this.remember()
    if (this.shown === file) void this.show('')
    else this.build()
  }

  diagnose(): void {
    for (const editor of this.all)
      editor.diagnose(editor.file ? model.faults.filter((f) => f.file === editor.file) : model.faults)
  }

  private key(e: KeyboardEvent): void {
    const tabs = [...this.element.querySelectorAll<HTMLElement>('[role=tab]')]
    const at = tabs.indexOf(e.target as HTMLElement)
    const to = { ArrowLeft: at - 1, ArrowRight: at + 1, Home: 0, End: tabs.length - 1 }[e.key]
    if (at < 0 || (to === undefined && e.key !== 'Delete')) return
    e.preventDefault()
    if (to === undefined) return this.close(tabs[at].dataset.file ?? '')
    const next = tabs[(to + tabs.length) % tabs.length]
    void this.show(next.dataset.file ?? '').then(() => this.tab(next.dataset.file ?? '')?.focus())
  }

  private tab(file: string): HTMLElement | undefined {
    return [...this.element.querySelectorAll<HTMLElement>('[role=tab]')].find((t) => t.dataset.file === file)
  }

  /** Builds the row anew: the model, the files that it reads, and what is open besides. */
  build(): void {
    const files = [...new Set(['', ...model.files, ...this.sheets.keys()])]
    const focus = this.element.contains(document.activeElement)
    this.element.hidden = this.link.local || files.length < 2
    if (this.element.hidden) return this.element.replaceChildren()
    const faulty = new Set(model.faults.filter((f) => f.severity === 'error' && f.file).map((f) => f.file))
    this.element.replaceChildren(
      ...files.map((file) => {
        const editor = this.of(file)
        const name = file ? fileName(file) : model.name
        const changes = editor?.dirty ? ', unsaved changes' : ''
        const wrong = faulty.has(file) ? ', errors' : ''
        return h(
          'button',
          {
            role: 'tab',
            'data-file': file,
            'aria-selected': file === this.shown,
            'aria-label': `${name}${changes}${wrong}`,
            tabindex: file === this.shown ? 0 : -1,
            title: file ? `${file}${changes}${wrong}${editor ? '' : '; a click opens it'}` : 'the model',
            class: [editor ? '' : 'quiet', wrong ? 'bad' : ''].join(' '),
            onclick: () => void this.show(file),
            onauxclick: () => this.close(file),
          },
          `${name}${editor?.dirty ? ' •' : ''}`,
        )
      }),
    )
    if (focus) this.tab(this.shown)?.focus()
  }
}
