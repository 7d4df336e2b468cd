// What answers the page: the server's engine through a socket, or the last scene of a file.

import { type Facts, Frame } from './frame'
import type { Requests } from './protocol'

export class Refused extends Error {
  constructor(
    message: string,
    readonly facts: Facts = {},
  ) {
    super(message)
  }
}

/** What the server answers in frames besides its engine, and what it has to know of a request besides, as the engine of
 * a change of a number that moves. */
interface ServerRequests {
  /** A CAD file as a program. */
  import: { name: string; data: string; units: string }
  /** The functions of the language. */
  functions: Record<never, never>
  /** A file of the model with values that are not in its text. */
  export: Requests['export'] & { values: Record<string, number> }
  set: Requests['set'] & Coarser
  solve_for: Requests['solve_for'] & Coarser
  drag_to: Requests['drag_to'] & Coarser
}

/** Number of halvings by which the cells of bodies of sets are larger than stated. */
type Coarser = { coarser?: number }

type All = Omit<Requests, keyof ServerRequests> & ServerRequests

export type RequestKind = keyof All

/** The fields of a request. */
export type RequestOf<K extends RequestKind> = All[K]

/** The fields as an argument, which may be left out where none is needed. */
export type Given<K extends RequestKind> = Partial<All[K]> extends All[K] ? [fields?: All[K]] : [fields: All[K]]

export interface Link {
  /** True when nothing can be changed. */
  readonly still: boolean
  /** True when the text is in this page alone. */
  readonly local: boolean
  ask<K extends RequestKind>(kind: K, ...fields: Given<K>): Promise<Frame>
  tell(message: Facts): Promise<Facts>
  onFrame: (frame: Frame) => void
  onMessage: (message: Facts) => void
  onState: (state: 'up' | 'down') => void
}

type Waiting = { resolve: (answer: any) => void; reject: (error: Error) => void }

export class SocketLink implements Link {
  readonly still = false
  readonly local = false
  onFrame: (frame: Frame) => void = () => {}
  onMessage: (message: Facts) => void = () => {}
  onState: (state: 'up' | 'down') => void = () => {}
  private socket: WebSocket | null = null
  private waiting = new Map<number, Waiting>()
  private count = 0
  private retry = 250
  /** The number of the last connection, by which the server knows a page that it has dropped. */
  private tab = 0
  /** By which the next server knows a page of this one. */
  private secret = ''

  async start(): Promise<void> {
    const token = new URLSearchParams(location.hash.slice(1)).get('t')
    if (token) {
      history.replaceState(null, '', location.pathname)
      const reply = await fetch('/token', { method: 'POST', body: token, credentials: 'same-origin' })
      if (!reply.ok) throw new Refused('this address has been used: `moldloft view` prints the next one')
    }
    this.connect()
  }

  /** Proves to a server that was started meanwhile that this page was with the last one. */
  private async again(): Promise<void> {
    try {
      const challenge = await (await fetch('/challenge', { credentials: 'same-origin' })).text()
      if (challenge) {
        const body = await proof(this.secret, location.port, challenge)
        await fetch('/token', { method: 'POST', body, credentials: 'same-origin' })
      }
    } catch {
      // No server yet: the connection fails, and is tried again.
    }
    this.connect()
  }

  private connect(): void {
    const socket = new WebSocket(`ws://${location.host}/ws?before=${this.tab}`)
    socket.binaryType = 'arraybuffer'
    this.socket = socket
    socket.onopen = () => {
      this.retry = 250
      this.onState('up')
    }
    socket.onmessage = (event) => this.receive(event.data)
    socket.onclose = () => {
      for (const w of this.waiting.values()) w.reject(new Refused('the connection is lost'))
      this.waiting.clear()
      this.onState('down')
      setTimeout(() => void this.again(), this.retry)
      this.retry = Math.min(4000, this.retry * 1.7)
    }
  }

  private receive(data: string | ArrayBuffer): void {
    if (typeof data === 'string') {
      const message = JSON.parse(data)
      if (message.kind === 'hello') [this.tab, this.secret] = [message.tab, message.secret]
      const waiting = this.waiting.get(message.id)
      if (waiting) {
        this.waiting.delete(message.id)
        if (message.kind === 'refused' || message.kind === 'superseded')
          waiting.reject(new Refused(message.error ?? 'superseded', message))
        else waiting.resolve(message)
        if (message.kind === 'superseded' || message.kind === 'refused' || message.kind === 'pushed') return
      }
      this.onMessage(message)
      return
    }
    const frame = new Frame(data)
    this.onFrame(frame)
    const waiting = this.waiting.get(frame.head.id)
    if (!waiting) return
    this.waiting.delete(frame.head.id)
    if (frame.head.error) waiting.reject(new Refused(frame.head.error, frame.head))
    else waiting.resolve(frame)
  }

  private send(message: Facts): Promise<any> {
    const id = ++this.count
    return new Promise((resolve, reject) => {
      if (this.socket?.readyState !== WebSocket.OPEN) return reject(new Refused('the connection is lost'))
      this.waiting.set(id, { resolve, reject })
      this.socket.send(JSON.stringify({ ...message, id }))
    })
  }

  ask(kind: string, fields: Facts = {}): Promise<Frame> {
    return this.send({ kind, ...fields })
  }

  tell(message: Facts): Promise<Facts> {
    return this.send(message)
  }
}

/** The answer of a page with a secret to the challenge of the server at a port. */
export async function proof(secret: string, port: string, challenge: string): Promise<string> {
  const bytes = (text: string) => new TextEncoder().encode(text)
  const key = await crypto.subtle.importKey('raw', bytes(secret), { name: 'HMAC', hash: 'SHA-256' }, false, ['sign'])
  const signed = await crypto.subtle.sign('HMAC', key, bytes(`${port} ${challenge}`))
  return Array.from(new Uint8Array(signed), (b) => b.toString(16).padStart(2, '0')).join('')
}

/** The scene that a file carries. */
export class StillLink implements Link {
  readonly still = true
  readonly local = true
  onFrame: (frame: Frame) => void = () => {}
  onMessage: (message: Facts) => void = () => {}
  onState: (state: 'up' | 'down') => void = () => {}

  constructor(
    private readonly hello: Facts,
    private readonly frames: Record<string, ArrayBuffer>,
  ) {}

  async start(): Promise<void> {
    this.onState('up')
    this.onMessage(this.hello)
  }

  async ask(kind: string, ..._: unknown[]): Promise<Frame> {
    const data = this.frames[kind]
    if (!data) throw new Refused('this page shows the model as it was: open it with `moldloft view` to change it')
    const frame = new Frame(data.slice(0))
    this.onFrame(frame)
    return frame
  }

  async tell(): Promise<Facts> {
    throw new Refused('this page shows the model as it was')
  }
}

/** Keeps one request under way; of those that wait only the newest counts. */
export class Newest<A> {
  private waiting: A | null = null
  private busy = false

  constructor(
    private readonly carryOut: (a: A) => Promise<unknown>,
    private readonly merge = (_: A, b: A) => b,
  ) {}

  push(a: A): void {
    this.waiting = this.waiting === null ? a : this.merge(this.waiting, a)
    void this.pump()
  }

  get idle(): boolean {
    return !this.busy && this.waiting === null
  }

  async settled(): Promise<void> {
    while (!this.idle) await new Promise((r) => setTimeout(r, 4))
  }

  private async pump(): Promise<void> {
    if (this.busy) return
    while (this.waiting !== null) {
      const next = this.waiting
      this.waiting = null
      this.busy = true
      try {
        await this.carryOut(next)
      } catch {
        // Who asked has been told, or did not want to know: what waits is carried out all the same.
      } finally {
        this.busy = false
      }
    }
  }
}
