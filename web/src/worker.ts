// The engine in the page: a session in WebAssembly, see `crates/wasm`. It answers one request at a time; when it
// fails, a new instance is made of the same module by who asked.

import { XzReadableStream } from 'xz-decompress'
import { Frame } from './frame'

interface Engine {
  memory: WebAssembly.Memory
  room(bytes: number): number
  start(): number
  answer(): number
  reply(): number
  missing(): number
}

export interface Beginning {
  /** The engine: its bytes packed by XZ, in base64 or as they are. */
  packed: string | ArrayBuffer
  name: string
  text: string
  files: Carried[]
}

export interface Carried {
  path: string
  from: string | null
  name: string
  data: string
}

const scope = self as unknown as {
  postMessage(message: unknown, moved?: Transferable[]): void
  onmessage: ((e: MessageEvent) => void) | null
}

let engine: Engine | null = null
let module: WebAssembly.Module | null = null
let beginning: Beginning | null = null
let words = ''

function decoded(text: string): Uint8Array<ArrayBuffer> {
  const native = (Uint8Array as unknown as { fromBase64?: (text: string) => Uint8Array<ArrayBuffer> }).fromBase64
  if (native) return native.call(Uint8Array, text)
  const raw = atob(text)
  const bytes = new Uint8Array(raw.length)
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k)
  return bytes
}

async function compiled(packed: string | ArrayBuffer): Promise<WebAssembly.Module> {
  const bytes = typeof packed === 'string' ? decoded(packed) : packed
  const stream = new XzReadableStream(new Blob([bytes]).stream()) as ReadableStream<Uint8Array<ArrayBuffer>>
  return WebAssembly.compileStreaming(new Response(stream, { headers: { 'Content-Type': 'application/wasm' } }))
}

function put(to: Engine, ...parts: Uint8Array[]): void {
  let at = to.room(parts.reduce((n, p) => n + p.length, 0))
  for (const part of parts) {
    new Uint8Array(to.memory.buffer, at, part.length).set(part)
    at += part.length
  }
}

function begun(text: string): Engine {
  const { name, files } = beginning!
  const imports = {
    env: {
      panicked: (at: number, length: number) => {
        words = new TextDecoder().decode(new Uint8Array(made.memory.buffer, at, length))
      },
    },
  }
  const made = new WebAssembly.Instance(module!, imports).exports as unknown as Engine
  const carried = files.map((f) => ({ path: f.path, from: f.from, name: f.name, bytes: decoded(f.data) }))
  let offset = 0
  const heads = carried.map((f) => {
    const head = { path: f.path, from: f.from, name: f.name, offset, count: f.bytes.length }
    offset += f.bytes.length
    return head
  })
  const json = new TextEncoder().encode(JSON.stringify({ name, text, files: heads }))
  put(made, new Uint8Array(Uint32Array.of(json.length).buffer), json, ...carried.map((f) => f.bytes))
  if (!made.start()) throw new Error('the page is damaged: its model cannot be read')
  return made
}

function answered(by: Engine, request: string): ArrayBuffer {
  put(by, new TextEncoder().encode(request))
  const length = by.answer()
  return by.memory.buffer.slice(by.reply(), by.reply() + length) as ArrayBuffer
}

// A browser optimises a function when it has run some times: the first changes of a model would be ten times slower than
// those after them. While nobody asks, another instance of the same module goes through changes of its parameters.

/** A change that takes longer than this, in ms, is not tried in advance; nor is a model that opens more slowly. */
const QUICK = 60
/** Length of this work, and the idle time before it. */
const [LONGEST, REST] = [1500, 150]
/** How long the model took to begin. */
let begins = 0
let asked = 0
let practised = false

function practise(opening: number): void {
  if (practised || opening > 3 * QUICK) return
  practised = true
  let twin: Engine | null = null
  let requests: string[] = []
  let spent = 0
  const step = (): void => {
    if (performance.now() - asked < REST) return void setTimeout(step, REST)
    const from = performance.now()
    const said = words
    try {
      if (!twin) {
        twin = begun(beginning!.text)
        const { params } = new Frame(answered(twin, JSON.stringify({ kind: 'open', tab: 1 }))).head
        requests = changes(params ?? [])
      } else answered(twin, requests.pop()!)
    } catch {
      // The engine that counts is another one.
      requests = []
    }
    words = said
    const took = performance.now() - from
    spent += took
    if (requests.length && took < 3 * QUICK && spent < LONGEST) setTimeout(step)
  }
  setTimeout(step, REST)
}

/** Some steps of each parameter, one parameter after the other, from the last to the first. */
function changes(params: { name: string; value: number; range: [number, number] | null; whole: boolean }[]): string[] {
  const all: string[] = []
  for (let k = 0; k < 10; k++)
    for (const { name, value, range, whole } of params) {
      if (whole) continue
      const [low, high] = range ?? [value - 1, value + 1]
      const x = value + (k % 2 ? 1e-4 : 2e-4) * (k + 1) * (high - low)
      if (x >= low && x <= high) all.push(JSON.stringify({ kind: 'set', tab: 1, values: { [name]: x } }))
    }
  return all
}

/** The files that the model asked for and the page does not carry. */
function missing(): [string, string | null][] {
  const length = engine!.missing()
  return JSON.parse(new TextDecoder().decode(new Uint8Array(engine!.memory.buffer, engine!.reply(), length)))
}

/** Why it failed, in words for a person. */
function reason(error: unknown): string {
  if (error instanceof RangeError) return 'the text nests deeper than a page has room for'
  return words ? `the engine failed: ${words}` : `the engine failed: ${(error as Error).message}`
}

scope.onmessage = async ({ data }: MessageEvent) => {
  words = ''
  try {
    if (data.begin) {
      beginning = data.begin as Beginning
      module = await compiled(beginning.packed)
      beginning.packed = ''
      const from = performance.now()
      engine = begun(beginning.text)
      begins = performance.now() - from
      scope.postMessage({ ready: true })
      return
    }
    if (data.files) beginning!.files = data.files
    if (typeof data.again === 'string') engine = begun(data.again)
    const from = performance.now()
    const frame = answered(engine!, data.ask)
    asked = performance.now()
    scope.postMessage({ frame, missing: missing() }, [frame])
    if (data.ask.startsWith('{"kind":"open"')) practise(begins + asked - from)
  } catch (error) {
    engine = null
    scope.postMessage({ lost: reason(error) })
  }
}
