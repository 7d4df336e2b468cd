// Changes by hand: values set during a move, and the text written when it rests.

import { shown } from './dom'
import { type Editor, fileName } from './editor'
import type { FileTabs } from './file_tabs'
import type { Hands, Written } from './hands'
import type { Held } from './history'
import type { Host } from './host'
import { type Given, type Link, Newest, Refused, type RequestKind, type RequestOf } from './link'
import type { Preview } from './preview'
import type { BesideFact } from './protocol'
import { model } from './state'

/** A hand that has not moved for this long rests, in ms. */
const REST = 600

/** The values of a step of the history, in words. */
export function valuesInWords(list: Record<string, number>): string {
  const one = ([n, x]: [string, number]) => {
    const was = model.params.find((p) => p.name === n)?.value
    return was === undefined ? `${n}: ${shown(x)}` : `${n}: ${shown(was)} → ${shown(x)}`
  }
  return Object.entries(list).map(one).join(', ')
}

export class Changes {
  editor!: Editor
  files!: FileTabs
  hands!: Hands
  /** For tests: when frames came, how long they took. */
  readonly stamps: { kind: string; from: number; to: number }[] = []
  /** Values of parameters that the text computes from others, while they are held. */
  private readonly held = new Map<string, number>()
  /** One after the other: the engine must have what the last one wrote before it writes the next. */
  private writing: Promise<void> = Promise.resolve()
  /** What waits for the hand to rest. */
  private rests: { name: string; run: () => Promise<void>; timer: ReturnType<typeof setTimeout> } | null = null
  private readonly setting: Newest<Record<string, number>>

  constructor(
    private readonly link: Link,
    preview: Preview,
    private readonly host: Host | null,
    private readonly say: (words: string) => void,
    private readonly warn: (words: string) => void,
  ) {
    this.setting = new Newest<Record<string, number>>(
      async (values) => {
        const from = performance.now()
        try {
          await preview.ask('set', { values })
          this.stamps.push({ kind: 'set', from, to: performance.now() })
        } catch (error) {
          if (error instanceof Refused && error.message !== 'superseded') say(error.message)
        }
      },
      (a, b) => ({ ...a, ...b }),
    )
  }

  /** Sets a value without writing it. */
  set(name: string, value: number): void {
    this.setting.push({ [name]: value })
  }

  /** Shows the model with these values, without writing them; with none as the text has it. */
  async preview(values: Record<string, number> | null): Promise<void> {
    if (values) this.setting.push(values)
    await this.setting.settled()
    if (!values) await this.reset()
  }

  /** Runs after all that is being written. */
  after(run: () => Promise<void>): Promise<void> {
    this.writing = this.writing.then(run).catch((error) => this.say((error as Error).message))
    return this.writing
  }

  /** Has the engine change the text: a step of the history. */
  edits<K extends RequestKind>(kind: K, fields: RequestOf<K>, name: string): Promise<void> {
    return this.after(async () => {
      await this.editor.synced()
      await this.setting.settled()
      const { head } = await this.link.ask(kind, ...([fields] as Given<K>))
      await this.written(head, name)
    })
  }

  /** Takes in what the engine wrote, as one step of the history; values that no open text states hold for this session. */
  async written(head: Written, name: string): Promise<void> {
    const stated: [Editor, BesideFact[]][] = []
    for (const file of new Set((head.beside ?? []).map((one) => one.file))) {
      const editor = await this.files.beside(file)
      const edits = head.beside!.filter(
        (one) => one.file === file && editor?.text.slice(one.from, one.to) === one.found,
      )
      if (editor && edits.length) stated.push([editor, edits])
    }
    const beside = new Set(stated.flatMap(([, edits]) => edits.map((one) => one.name)))
    const now = (head.kept ?? [])
      .filter((n) => !beside.has(n))
      .map((n) => ({
        name: n,
        from: this.held.get(n) ?? null,
        to: model.params.find((p) => p.name === n)?.value ?? null,
      }))
    const news = now.filter((one: Held) => one.from !== one.to)
    for (const one of news) if (one.to !== null) this.held.set(one.name, one.to)
    let joined = this.editor.apply(head.edits ?? [], head.version, name, news)
    for (const [editor, edits] of stated) joined = editor.apply(edits, undefined, name, [], joined) || joined
    const names = news.map((one: Held) => one.name).join(', ')
    if (names) this.say(`${names}: the value holds for this session, for no text of the model states it as a number`)
  }

  /** The last of a name runs when the hand rests. */
  rest(name: string, run: () => Promise<void>): void {
    if (this.rests && this.rests.name !== name) void this.rested()
    if (this.rests) clearTimeout(this.rests.timer)
    this.rests = { name, run, timer: setTimeout(() => void this.rested(), REST) }
  }

  /** What waits for the hand to rest runs now. */
  rested(): Promise<void> {
    const one = this.rests
    this.rests = null
    if (one) clearTimeout(one.timer)
    return one ? one.run() : Promise.resolve()
  }

  /** The values that hold without being in the text are given to an engine that has forgotten them. */
  async holdAgain(): Promise<void> {
    if (this.held.size) await this.link.ask('write', { values: this.values })
  }

  /** The values that hold without being in the text. */
  get values(): Record<string, number> {
    return Object.fromEntries(this.held)
  }

  /** Takes back what was set and not written. */
  async reset(): Promise<void> {
    await this.link.ask('reset')
    await this.holdAgain()
  }

  /** A held value goes with a step that was taken back or done again. */
  holds({ name, to }: Held): void {
    if (to === null) this.held.delete(name)
    else this.held.set(name, to)
    // The engine gives up all that the text does not state, and takes again what is still held.
    void this.after(async () => {
      await this.editor.synced()
      if (to === null) await this.link.ask('reset')
      await this.holdAgain()
    })
  }

  /** Steps of the history, back or, with a negative count, again; what is under way is a step, too. */
  turn(count: number): void {
    if (this.host) return this.host.undo(count > 0)
    if (this.link.still) return
    if (this.hands.busy) {
      this.hands.cancel()
      if (count > 0) return
    }
    void this.rested()
    // Between what was written before the key and what is written after it.
    void this.after(async () => {
      await this.hands.settled()
      const back = count > 0
      const { steps } = this.editor
      const step = (back ? steps.done : steps.undone).at(-1)
      const gone = steps.go(count)
      const words = `${back ? 'Undone' : 'Redone'}: ${gone > 1 ? `${gone} steps` : step}`
      this.say(gone ? words : `Nothing to ${back ? 'undo' : 'redo'}`)
    })
  }

  revert(): void {
    void this.rested()
    void this.after(async () => {
      await this.hands.settled()
      const { current } = this.files
      await current.synced()
      const { text } = await this.link.tell({ kind: 'revert', file: current.file })
      current.replace(
        text,
        false,
        false,
        current.file ? `Revert ${fileName(current.file)}` : 'Revert to the saved file',
      )
      this.say('Reverted to the saved file; Ctrl+Z takes it back')
      this.warn('')
    })
  }

  async settled(): Promise<void> {
    await this.rested()
    await this.hands.settled()
    await this.setting.settled()
    for (let last = null; last !== this.writing; ) await (last = this.writing)
    // What was written is a change of the text, which the server must have.
    for (const editor of this.files.all) await editor.synced()
  }
}
