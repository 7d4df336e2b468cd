// The engine in the page: a session in WebAssembly, see `crates/wasm`. It answers one request at a time; when it
// fails, a new instance is made of the same module by who asked.

interface Engine {
  memory: WebAssembly.Memory
  room(bytes: number): number
  start(): number
  answer(): number
  reply(): number
  missing(): number
}

export interface Beginning {
  /** The engine: its bytes packed by gzip, in base64 or as they are. */
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

const scope = self as unknown as { postMessage(message: unknown, moved?: Transferable[]): void; onmessage: ((e: MessageEvent) => void) | null }

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
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))
  return WebAssembly.compileStreaming(new Response(stream, { headers: { 'Content-Type': 'application/wasm' } }))
}

function put(to: Engine, ...parts: Uint8Array[]): void {
  let at = to.room(parts.reduce((n, p) => n + p.length, 0))
  for (const part of parts) {
    new Uint8Array(to.memory.buffer, at, part.length).set(part)
    at += part.length
  }
}

function begin(text: string): void {
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
  engine = made
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
      begin(beginning.text)
      scope.postMessage({ ready: true })
      return
    }
    if (data.files) beginning!.files = data.files
    if (typeof data.again === 'string') begin(data.again)
    const request = new TextEncoder().encode(data.ask)
    put(engine!, request)
    const length = engine!.answer()
    const frame = engine!.memory.buffer.slice(engine!.reply(), engine!.reply() + length) as ArrayBuffer
    scope.postMessage({ frame, missing: missing() }, [frame])
  } catch (error) {
    engine = null
    scope.postMessage({ lost: reason(error) })
  }
}
