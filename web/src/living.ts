// A page that carries its engine: the text is here, and a worker or a parent answers.
//
// The engine is asked one thing at a time; of sliders, drags and questions only the newest of a kind waits. When it
// fails or takes too long a new one begins with the text as it is: nothing that was typed is lost.

import { ChangeSet, Text } from '@codemirror/state'
import { store, stored } from './dom'
import { type Facts, Frame } from './frame'
import { type Link, Refused } from './link'

/** What computes: an engine that can be asked, and begun again. */
export interface Engine {
  /** Begins, or begins again, with a text. */
  begin(text: string): Promise<void>
  ask(request: string): Promise<ArrayBuffer>
  end(): void
}

export class EngineLost extends Error {}

interface Job {
  kind: string
  request: Facts
  resolve: (frame: Frame) => void
  reject: (error: Error) => void
}

/** As in the hub: requests of which only the newest counts. */
const NEWEST = new Set([
  'set',
  'solve_for',
  'drag_to',
  'settle',
  'sync',
  'hover',
  'complete',
  'inspect',
  'field',
  'combs',
  'deviation',
  'measure',
  'blocks',
])

/** Requests that a new engine gets before all others. */
const STATE = ['show', 'watch']

export class LivingLink implements Link {
  readonly still = false
  readonly local = true
  onFrame: (frame: Frame) => void = () => {}
  onMessage: (message: Facts) => void = () => {}
  onState: (state: 'up' | 'down') => void = () => {}
  /** Called when the engine answers for the first time. */
  onReady: () => void = () => {}
  private text: Text
  private version = 0
  private readonly original: string
  private readonly jobs: Job[] = []
  private busy = true
  private running = false
  private readonly state = new Map<string, Facts>()
  private failed = { version: -1, times: 0 }
  private opened = false
  private recovered = false

  /** `drafts`: whether what is typed is kept in this browser. */
  constructor(
    private readonly hello: Facts,
    private readonly first: ArrayBuffer | null,
    private readonly engine: Engine,
    private readonly drafts = true,
  ) {
    this.original = hello.text
    const kept = !drafts ? null : stored<{ from: string; text: string } | null>(this.key, null)
    if (kept && kept.from === digest(this.original) && kept.text !== this.original) {
      this.recovered = true
      hello = { ...hello, text: kept.text }
    }
    this.text = Text.of(String(hello.text).split('\n'))
  }

  private get key(): string {
    return `draft.${this.hello.name}`
  }

  private get dirty(): boolean {
    return this.text.toString() !== this.original
  }

  async start(): Promise<void> {
    this.onState('up')
    this.onMessage({
      ...this.hello,
      text: this.text.toString(),
      version: 0,
      dirty: this.dirty,
      recovered: this.recovered,
    })
    try {
      await this.engine.begin(this.text.toString())
      this.running = true
      this.busy = false
      // What was shown up to now came with the page.
      if (this.opened) this.jobs.unshift(this.silent('open'))
      this.onReady()
      void this.pump()
    } catch (error) {
      this.onMessage({ kind: 'engine', state: 'lost', reason: (error as Error).message })
      for (const job of this.jobs.splice(0)) job.reject(new Refused('the engine is not running'))
    }
  }

  private silent(kind: string, fields: Facts = {}): Job {
    return { kind, request: { kind, ...fields }, resolve: () => {}, reject: () => {} }
  }

  ask(kind: string, fields: Facts = {}): Promise<Frame> {
    if (STATE.includes(kind)) this.state.set(kind, { ...this.state.get(kind), ...fields })
    if (kind === 'open' && !this.running && this.first && !this.recovered) {
      // The scene that the page carries is there at once; the engine's own follows.
      this.opened = true
      const frame = new Frame(this.first.slice(0))
      this.onFrame(frame)
      return Promise.resolve(frame)
    }
    return new Promise((resolve, reject) => {
      const job: Job = { kind, request: { kind, ...fields }, resolve, reject }
      const waiting = NEWEST.has(kind) ? this.jobs.findIndex((j) => j.kind === kind) : -1
      if (waiting >= 0) {
        const old = this.jobs[waiting]
        if (kind === 'set') job.request.values = { ...old.request.values, ...fields.values }
        old.reject(new Refused('superseded'))
        this.jobs[waiting] = job
      } else this.jobs.push(job)
      void this.pump()
    })
  }

  private async pump(): Promise<void> {
    if (this.busy || !this.running) return
    this.busy = true
    for (let job = this.jobs.shift(); job; job = this.jobs.shift()) await this.carryOut(job)
    this.busy = false
  }

  private async carryOut(job: Job): Promise<void> {
    try {
      const data = await this.engine.ask(JSON.stringify({ ...job.request, id: 0, tab: 1 }))
      const frame = new Frame(data)
      if (this.failed.times && !frame.head.error) {
        this.failed = { version: -1, times: 0 }
        this.onMessage({ kind: 'engine', state: 'back' })
      }
      this.onFrame(frame)
      if (frame.head.error) job.reject(new Refused(frame.head.error, frame.head))
      else job.resolve(frame)
    } catch (error) {
      job.reject(error as Error)
      await this.lost((error as Error).message)
    }
  }

  /** A new engine takes the text; a text that fails twice waits to be changed. */
  private async lost(why: string): Promise<void> {
    const times = this.failed.version === this.version ? this.failed.times + 1 : 1
    this.failed = { version: this.version, times }
    this.onMessage({ kind: 'engine', state: 'lost', reason: times < 2 ? why : `${why}; change the text to continue` })
    this.running = false
    for (const job of this.jobs.splice(0)) job.reject(new Refused('the engine was stopped'))
    if (times >= 2) return
    await this.again()
  }

  /** Begins again with the text as it is: the files beside it have changed. */
  async restart(): Promise<void> {
    if (!this.running) return
    await this.again()
    void this.pump()
  }

  private async again(): Promise<void> {
    try {
      await this.engine.begin(this.text.toString())
      this.running = true
      this.jobs.unshift(
        ...STATE.filter((k) => this.state.has(k)).map((k) => this.silent(k, this.state.get(k))),
        this.silent('open'),
      )
    } catch (error) {
      this.onMessage({ kind: 'engine', state: 'lost', reason: (error as Error).message })
    }
  }

  async tell(message: Facts): Promise<Facts> {
    switch (message.kind) {
      case 'push':
        return this.push(message)
      case 'pull':
        return { kind: 'pulled', version: this.version, text: this.text.toString() }
      case 'save':
        return { kind: 'saved', version: this.version, text: this.text.toString() }
      case 'revert':
        return { kind: 'reverted', text: this.original }
      default:
        throw new Refused('no such request')
    }
  }

  private push(message: Facts): Facts {
    if (message.version !== this.version)
      return { kind: 'pushed', ok: false, version: this.version, text: this.text.toString() }
    this.accept(message.updates)
    return { kind: 'pushed', ok: true, version: this.version }
  }

  private accept(updates: { changes: unknown; clientID: string }[]): void {
    for (const u of updates) this.text = ChangeSet.fromJSON(u.changes).apply(this.text)
    const from = this.version
    this.version += updates.length
    if (this.drafts) store(this.key, this.dirty ? { from: digest(this.original), text: this.text.toString() } : null)
    this.onMessage({ kind: 'updates', from, updates, dirty: this.dirty })
    const changes = updates.map((u) => u.changes)
    if (this.running) {
      // The text precedes all waiting requests: their places refer to it.
      const waiting = this.jobs.find((j) => j.kind === 'splice')
      if (waiting) {
        waiting.request.changes.push(...changes)
        waiting.request.version = this.version
      } else this.jobs.unshift(this.silent('splice', { changes, version: this.version }))
      void this.pump()
    } else if (this.failed.times >= 2) {
      this.failed = { version: this.version, times: 1 }
      void this.again().then(() => this.pump())
    }
  }
}

/** A short hash of a text, to know it again. */
function digest(text: string): string {
  let hash = 0xcbf29ce484222325n
  for (let k = 0; k < text.length; k++)
    hash = ((hash ^ BigInt(text.charCodeAt(k))) * 0x100000001b3n) & 0xffffffffffffffffn
  return `${text.length}-${hash.toString(36)}`
}

/** How long one request may take; then the worker is ended. */
const BUDGET = 20_000

/** An engine in a worker. */
export class WorkerEngine implements Engine {
  private worker: Worker | null = null
  private waiting: { resolve: (data: any) => void; reject: (error: Error) => void; timer: number } | null = null
  private again: string | null = null
  private files: unknown[] | null = null
  private asked = ''
  /** Called when the model asks for files that are not here; those that `give` gets are there for the next beginning. */
  onMissing: (files: [string, string | null][]) => void = () => {}

  constructor(
    private readonly make: () => Worker | Promise<Worker>,
    private readonly beginning: () => Promise<Facts>,
  ) {}

  /** All files that the model may read from now on. */
  give(files: unknown[]): void {
    this.files = files
  }

  async begin(text: string): Promise<void> {
    if (this.worker) {
      // The module is compiled: a new instance begins with the next request.
      this.again = text
      return
    }
    const worker = await this.make()
    this.worker = worker
    worker.onmessage = ({ data }) => {
      const waiting = this.waiting
      this.waiting = null
      if (!waiting) return
      clearTimeout(waiting.timer)
      if (data.lost) waiting.reject(new EngineLost(data.lost))
      else waiting.resolve(data)
    }
    worker.onerror = (event) => this.fail(event.message || 'the worker cannot be started')
    const beginning = await this.beginning()
    await this.send({ begin: { ...beginning, files: this.files ?? beginning.files ?? [], text } }, 4 * BUDGET)
    this.again = null
  }

  async ask(request: string): Promise<ArrayBuffer> {
    const message: Facts = this.again === null ? { ask: request } : { ask: request, again: this.again }
    if (this.again !== null && this.files) message.files = this.files
    this.again = null
    const data = await this.send(message, BUDGET)
    const asked = JSON.stringify(data.missing ?? [])
    if (asked !== this.asked && data.missing?.length) this.onMissing(data.missing)
    this.asked = asked
    return data.frame
  }

  private send(message: Facts, budget: number): Promise<any> {
    return new Promise((resolve, reject) => {
      const timer = window.setTimeout(() => this.fail(`no answer within ${budget / 1000} s`), budget)
      this.waiting = { resolve, reject, timer }
      this.worker!.postMessage(message)
    })
  }

  private fail(why: string): void {
    this.end()
    const waiting = this.waiting
    this.waiting = null
    if (!waiting) return
    clearTimeout(waiting.timer)
    waiting.reject(new EngineLost(why))
  }

  end(): void {
    this.worker?.terminate()
    this.worker = null
  }
}
