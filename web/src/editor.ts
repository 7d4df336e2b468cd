// The program: CodeMirror, with what the engine knows of the text, and changes shared with the hub.

import {
  acceptCompletion,
  autocompletion,
  type CompletionContext,
  type CompletionResult,
  closeBrackets,
  closeBracketsKeymap,
  completionKeymap,
} from '@codemirror/autocomplete'
import { collab, getSyncedVersion, receiveUpdates, sendableUpdates } from '@codemirror/collab'
import { defaultKeymap, indentLess, indentMore, toggleComment } from '@codemirror/commands'
import { bracketMatching, foldGutter, indentOnInput, StreamLanguage, syntaxHighlighting } from '@codemirror/language'
import { type Diagnostic, lintGutter, setDiagnostics } from '@codemirror/lint'
import { highlightSelectionMatches, search, searchKeymap } from '@codemirror/search'
import {
  Annotation,
  ChangeSet,
  Compartment,
  EditorState,
  StateEffect,
  StateField,
  Text,
  Transaction,
} from '@codemirror/state'
import {
  Decoration,
  type DecorationSet,
  drawSelection,
  EditorView,
  highlightActiveLine,
  highlightActiveLineGutter,
  hoverTooltip,
  keymap,
  lineNumbers,
} from '@codemirror/view'
import { classHighlighter } from '@lezer/highlight'
import { h } from './dom'
import { type Held, holding, keptSteps, Steps, stepOf } from './history'
import { programParser, sketchParser, type Words } from './language'
import type { Link } from './link'
import type { EditFact } from './protocol'
import { model } from './state'

const fromOutside = Annotation.define<boolean>()
/** A change that the host of the page made: the engine hears it, the host knows it. */
const fromHost = Annotation.define<boolean>()
const mark = StateEffect.define<{ from: number; to: number } | null>()

const marks = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(set, tr) {
    set = set.map(tr.changes)
    for (const e of tr.effects)
      if (e.is(mark))
        set =
          e.value && e.value.to > e.value.from && e.value.to <= tr.newDoc.length
            ? Decoration.set([Decoration.mark({ class: 'cm-object' }).range(e.value.from, e.value.to)])
            : Decoration.none
    return set
  },
  provide: (f) => EditorView.decorations.from(f),
})

export class Editor {
  readonly view: EditorView
  private readonly language = new Compartment()
  private readonly shared = new Compartment()
  private pushing = false
  private timer = 0
  /** Whether the hub has joined this text since the connection is there. */
  online = false
  /** What changed the text lately, by the version that it changed. */
  private past: { version: number; changes: ChangeSet }[] = []
  /** The text that the hub is known to have. */
  private base: Text = Text.empty
  /** The hub's version of the text less that of the history. */
  private ahead = 0
  /** Whether the text differs from its file. */
  dirty = false
  /** Called when what is typed is not yet with the hub, or is again. */
  onPending: (pending: boolean) => void = () => {}
  onCursor: (offset: number) => void = () => {}
  onTrouble: (words: string) => void = () => {}
  /** What a hand on the page changed: places in the text before it, and what is there now. */
  onEdit: (before: Text, changes: EditFact[]) => void = () => {}
  onShow: (place: [number, number], focus: boolean) => void = () => {}
  /** A declaration is in another file. */
  onElsewhere: (file: string, place: [number, number]) => void = () => {}

  constructor(
    host: HTMLElement,
    private readonly link: Link,
    nonce: string,
    private readonly keys: { key: string; run: () => boolean }[],
    /** What was done, to be taken back; of all texts. */
    readonly steps = new Steps(),
    /** The file beside the model whose text this is; none for the model's own. */
    readonly file = '',
  ) {
    this.view = new EditorView({ parent: host, state: this.state('', nonce) })
  }

  private state(text: string, nonce: string): EditorState {
    return EditorState.create({
      doc: text,
      extensions: [
        nonce ? EditorView.cspNonce.of(nonce) : [],
        lineNumbers(),
        highlightActiveLineGutter(),
        foldGutter(),
        keptSteps(),
        drawSelection(),
        indentOnInput(),
        bracketMatching(),
        closeBrackets(),
        autocompletion({ override: this.file ? [] : [(c) => this.complete(c)] }),
        highlightActiveLine(),
        highlightSelectionMatches(),
        search({ top: true }),
        lintGutter(),
        marks,
        syntaxHighlighting(classHighlighter),
        EditorState.tabSize.of(4),
        EditorView.lineWrapping,
        this.language.of(StreamLanguage.define(programParser({}))),
        this.shared.of([]),
        EditorState.readOnly.of(this.link.still),
        EditorView.contentAttributes.of({
          'aria-label': this.file ? `text of ${fileName(this.file)}` : 'program',
          spellcheck: 'false',
          tabindex: '0',
          autocorrect: 'off',
          autocapitalize: 'off',
        }),
        this.file ? [] : hoverTooltip((_, pos) => this.hover(pos), { hoverTime: 350 }),
        keymap.of([
          ...this.keys,
          { key: 'Tab', run: (v) => acceptCompletion(v) || indentMore(v), shift: indentLess },
          ...(this.file
            ? []
            : [
                { key: 'F12', run: () => (void this.definition(), true) },
                { key: 'F2', run: () => (void this.rename(), true) },
                { key: 'Shift-Alt-f', run: () => (void this.format(), true) },
              ]),
          { key: 'Mod-/', run: toggleComment },
          ...closeBracketsKeymap,
          ...defaultKeymap,
          ...searchKeymap,
          ...completionKeymap,
        ]),
        EditorView.updateListener.of((update) => {
          this.steps.follow(update)
          if (update.docChanged && !update.transactions.some((t) => t.annotation(fromOutside))) {
            if (!update.transactions.some((t) => t.annotation(fromHost))) {
              const made: EditFact[] = []
              update.changes.iterChanges((from, to, _a, _b, insert) =>
                made.push({ from, to, insert: insert.toString() }),
              )
              this.onEdit(update.startState.doc, made)
            }
            this.push()
          }
          if (update.selectionSet && !update.docChanged) this.onCursor(update.state.selection.main.head)
        }),
        EditorView.domEventHandlers({
          mousedown: (event, view) => {
            if (this.file || !(event.ctrlKey || event.metaKey)) return false
            const pos = view.posAtCoords({ x: event.clientX, y: event.clientY })
            if (pos !== null) void this.definition(pos)
            return true
          },
        }),
      ],
    })
  }

  get text(): string {
    return this.view.state.doc.toString()
  }

  words(words: Record<string, string[]>): void {
    const sets: Words = {}
    for (const [kind, list] of Object.entries(words)) sets[kind] = new Set(list)
    const name = this.file || model.name
    const program = !this.file || /\.sdl$/i.test(name)
    const of = program ? StreamLanguage.define(programParser(sets)) : []
    const language = isSketch(name) ? StreamLanguage.define(sketchParser) : of
    this.view.dispatch({ effects: this.language.reconfigure(language) })
  }

  // The text and the hub.

  /** The hub's text, of that version. */
  begin(text: string, version: number): void {
    this.past = []
    this.view.dispatch({ effects: this.shared.reconfigure([]) })
    this.replace(text, true)
    this.view.dispatch({ effects: this.shared.reconfigure(collab({ startVersion: version })) })
    this.base = this.view.state.doc
    this.ahead = 0
    this.online = true
    this.push()
  }

  /** The connection is back, to the same hub: what it has and this page has not is taken. */
  async resume(): Promise<void> {
    if (!(await this.catchUp())) return
    this.online = true
    this.push()
  }

  /** Another hub, or one that has forgotten the changes since: what is not in its text is put on top and sent. */
  rejoin(text: string, version: number): void {
    const theirs = Text.of(text.split('\n'))
    const mine = sendableUpdates(this.view.state)
    // What was sent last may have arrived before the connection was lost.
    let known = this.base
    let arrived = 0
    while (!known.eq(theirs) && arrived < mine.length) known = mine[arrived++].changes.apply(known)
    if (!known.eq(theirs)) [known, arrived] = [this.base, 0]
    this.confirm(mine.slice(0, arrived))
    if (!known.eq(theirs)) {
      const { from, to, insert } = difference(known.toString(), text)
      this.confirm([{ changes: ChangeSet.of({ from, to, insert }, known.length), clientID: 'hub' }])
      if (arrived < mine.length) this.onTrouble('The text was changed elsewhere, too: both are in it.')
    }
    this.past = []
    this.ahead += version - this.version
    this.online = true
    this.push()
  }

  /** Changes that the hub has. */
  private confirm(updates: readonly { changes: ChangeSet; clientID: string }[]): void {
    if (!updates.length) return
    this.base = updates.reduce((doc, u) => u.changes.apply(doc), this.base)
    this.view.dispatch(receiveUpdates(this.view.state, updates))
  }

  offline(): void {
    this.online = false
    this.pushing = false
    this.onPending(this.pending)
  }

  get pending(): boolean {
    try {
      return sendableUpdates(this.view.state).length > 0
    } catch {
      return false
    }
  }

  get version(): number {
    try {
      return getSyncedVersion(this.view.state) + this.ahead
    } catch {
      return -1
    }
  }

  /** The least change that makes the text this one: a step of that name, or none. */
  replace(text: string, silently: boolean, host = false, name = 'Your text'): void {
    if (this.text === text) return
    this.view.dispatch({
      changes: difference(this.text, text),
      annotations: host
        ? [Transaction.addToHistory.of(false), fromHost.of(true)]
        : silently
          ? [Transaction.addToHistory.of(false), fromOutside.of(true)]
          : stepOf(name),
    })
  }

  received(updates: { changes: any; clientID: string }[], from: number): void {
    const known = this.version
    if (known < 0) return
    if (from > known) return void this.catchUp()
    const news = updates.slice(known - from)
    if (news.length === 0) return
    const made = news.map((u) => ({ changes: ChangeSet.fromJSON(u.changes), clientID: u.clientID }))
    made.forEach((u, k) => this.past.push({ version: known + k, changes: u.changes }))
    if (this.past.length > 400) this.past.splice(0, this.past.length - 200)
    this.confirm(made)
    this.onPending(this.pending)
  }

  /** Whether the connection held. */
  private async catchUp(): Promise<boolean> {
    try {
      const answer = await this.link.tell({ kind: 'pull', file: this.file, version: this.version })
      if (typeof answer.text === 'string') this.rejoin(answer.text, answer.version)
      else this.received(answer.updates, answer.from)
      return true
    } catch {
      // The next message finds it again.
      return false
    }
  }

  /** Sends what was typed; one message under way, and what comes meanwhile with the next. */
  private push(): void {
    this.onPending(this.pending)
    if (!this.online || this.pushing || this.timer || this.link.still) return
    this.timer = window.setTimeout(() => {
      this.timer = 0
      void this.send()
    }, 0)
  }

  private async send(): Promise<void> {
    const updates = sendableUpdates(this.view.state)
    if (!updates.length || this.pushing) return
    this.pushing = true
    try {
      const sent = updates.map((u) => ({ changes: u.changes.toJSON(), clientID: u.clientID }))
      const answer = await this.link.tell({ kind: 'push', file: this.file, version: this.version, updates: sent })
      if (!answer.ok && typeof answer.text === 'string') this.rejoin(answer.text, answer.version)
      else if (!answer.ok && answer.version > this.version) await this.catchUp()
      if (answer.error) this.onTrouble(answer.error)
    } catch {
      // The connection is lost: what was typed is sent when it is back.
    }
    this.pushing = false
    this.onPending(this.pending)
    if (this.online && this.pending) setTimeout(() => this.push(), 20)
  }

  async synced(): Promise<void> {
    while (this.pending && this.online) await new Promise((r) => setTimeout(r, 5))
  }

  /** Edits that the engine made of a version of the text, as one step of the history, or part of the last one; true if
   * there are any. */
  apply(edits: EditFact[], version = this.version, name = 'Edit', held: Held[] = [], joined = false): boolean {
    const effects = held.map((one) => holding.of(one))
    if (!edits.length && !effects.length) return false
    const since = this.past.filter((p) => p.version >= version)
    if (this.version - version !== since.length) {
      this.onTrouble('The text has changed too much meanwhile: do it again')
      return false
    }
    // What was typed meanwhile moves the places.
    const later = [
      ...since.map((p) => p.changes),
      ...(this.pending ? sendableUpdates(this.view.state).map((u) => u.changes) : []),
    ]
    const changes = edits.map((e) => {
      const from = later.reduce((at, c) => c.mapPos(at, 1), e.from)
      return {
        from,
        to: Math.max(
          from,
          later.reduce((at, c) => c.mapPos(at, -1), e.to),
        ),
        insert: e.insert,
      }
    })
    this.view.dispatch({ changes, effects, annotations: stepOf(name, joined), userEvent: 'input.hand' })
    return true
  }

  // What is known of the text.

  diagnose(all: any[]): void {
    const size = this.view.state.doc.length
    const shown: Diagnostic[] = []
    for (const d of all) {
      const place = this.file ? d.elsewhere : d.place
      if (!place) continue
      const from = Math.min(place[0], size)
      const to = Math.min(Math.max(place[1], from), size)
      const found = d.found ? `\nfound ${d.found}` : ''
      const expected = d.expected ? `\nexpected ${d.expected}` : ''
      const help = (d.help ?? []).map((t: string) => `\n${t}`).join('')
      const actions = d.edit
        ? [
            {
              name: d.edit.title,
              apply: (v: EditorView) =>
                d.edit.place[1] <= v.state.doc.length &&
                v.dispatch({
                  changes: { from: d.edit.place[0], to: d.edit.place[1], insert: d.edit.insert },
                  annotations: stepOf(d.edit.title),
                }),
            },
          ]
        : []
      shown.push({
        from,
        to,
        severity: d.severity === 'note' ? 'info' : d.severity,
        message: d.message + expected + found + help,
        actions,
      })
    }
    shown.sort((a, b) => a.from - b.from)
    this.view.dispatch(setDiagnostics(this.view.state, shown))
  }

  show(place: [number, number] | null, focus = false): void {
    const size = this.view.state.doc.length
    if (!place || place[1] > size) {
      this.view.dispatch({ effects: mark.of(null) })
      return
    }
    this.onShow(place, focus)
    const effects = [mark.of({ from: place[0], to: place[1] }), EditorView.scrollIntoView(place[0], { y: 'center' })]
    this.view.dispatch(focus ? { effects, selection: { anchor: place[0] } } : { effects })
    if (focus) this.view.focus()
  }

  private async complete(context: CompletionContext): Promise<CompletionResult | null> {
    const word = context.matchBefore(/\w*/)
    const dotted = context.matchBefore(/\.\w*/)
    if (!context.explicit && !dotted && (!word || word.from === word.to)) return null
    try {
      await this.synced()
      const { head } = await this.link.ask('complete', { offset: context.pos })
      const types: Record<string, string> = { kind: 'class', member: 'property', object: 'constant' }
      const options = (head.completions as [string, string, string][]).map(([label, type, detail]) => ({
        label,
        type: types[type] ?? type,
        detail: detail.length > 60 ? `${detail.slice(0, 60)}…` : detail,
      }))
      return { from: word ? word.from : context.pos, options, validFor: /^\w*$/ }
    } catch {
      return null
    }
  }

  private async hover(pos: number) {
    try {
      const { head } = await this.link.ask('hover', { offset: pos })
      if (!head.markdown || !head.place) return null
      if (head.place[1] > this.view.state.doc.length) return null
      return { pos: head.place[0], end: head.place[1], create: () => ({ dom: explained(head.markdown) }) }
    } catch {
      return null
    }
  }

  async definition(at = this.view.state.selection.main.head): Promise<void> {
    try {
      const { head } = await this.link.ask('definition', { offset: at })
      if (head.place) this.show(head.place, true)
      else if (head.elsewhere) this.onElsewhere(head.elsewhere.file, head.elsewhere.place)
    } catch {
      // Nothing there.
    }
  }

  async rename(): Promise<void> {
    const word = this.view.state.wordAt(this.view.state.selection.main.head)
    if (!word) return
    const old = this.view.state.sliceDoc(word.from, word.to)
    const now = prompt(`New name of ${old}`, old)
    if (!now || now === old) return
    try {
      const { head } = await this.link.ask('rename', { offset: word.from, new: now })
      this.apply(head.edits, head.version, `Rename ${old} to ${now}`)
    } catch (error) {
      this.onTrouble((error as Error).message)
    }
  }

  async format(): Promise<void> {
    try {
      const { head } = await this.link.ask('format')
      this.apply(head.edits, head.version, 'Format')
    } catch (error) {
      this.onTrouble((error as Error).message)
    }
  }
}

/** True for the names of files of sketches. */
export const isSketch = (name: string) => /\.skt$/i.test(name)

/** The name of a file without its folders. */
export const fileName = (path: string) => path.split(/[/\\]/).pop() ?? path

/** The least replacement that makes one text of another. */
function difference(old: string, text: string): EditFact {
  let start = 0
  const most = Math.min(old.length, text.length)
  while (start < most && old.charCodeAt(start) === text.charCodeAt(start)) start++
  let end = 0
  while (end < most - start && old.charCodeAt(old.length - 1 - end) === text.charCodeAt(text.length - 1 - end)) end++
  return { from: start, to: old.length - end, insert: text.slice(start, text.length - end) }
}

/** Markdown of hovers: code blocks and plain lines, as texts. */
function explained(markdown: string): HTMLElement {
  const box = h('div', { class: 'hover-box' })
  markdown.split('```').forEach((part, k) => {
    if (k % 2) box.append(h('pre', {}, part.replace(/^\w*\n/, '').trimEnd()))
    else for (const line of part.split(/\n\n+/)) if (line.trim()) box.append(h('p', {}, line.trim().replace(/`/g, '')))
  })
  return box
}
