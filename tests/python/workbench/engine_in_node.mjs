// The engine for pages outside of one: answers requests, and prints a hash of each reply.
//
// Standard input is JSON: the engine in base64, what it begins with, the requests.

import { createHash } from 'node:crypto'
import { readFileSync } from 'node:fs'

const { engine: packed, name, text, files, requests } = JSON.parse(readFileSync(0, 'utf8'))
const module = await WebAssembly.compile(Buffer.from(packed, 'base64'))
const bytesAt = (at, length) => new Uint8Array(engine.memory.buffer, at, length)
const panicked = (at, length) => console.error(new TextDecoder().decode(bytesAt(at, length)))
const engine = new WebAssembly.Instance(module, { env: { panicked } }).exports

function put(...parts) {
  let at = engine.room(parts.reduce((n, p) => n + p.length, 0))
  for (const part of parts) {
    bytesAt(at, part.length).set(part)
    at += part.length
  }
}

const carried = files.map((f) => Buffer.from(f.data, 'base64'))
let offset = 0
const heads = files.map(({ path, from, name }, k) => {
  const head = { path, from, name, offset, count: carried[k].length }
  offset += carried[k].length
  return head
})
const json = new TextEncoder().encode(JSON.stringify({ name, text, files: heads }))
put(new Uint8Array(Uint32Array.of(json.length).buffer), json, ...carried)
if (!engine.start()) throw new Error('it does not start')
for (const request of requests) {
  put(new TextEncoder().encode(request))
  const length = engine.answer()
  const reply = bytesAt(engine.reply(), length)
  console.log(`${createHash('sha256').update(reply).digest('hex')} ${length}`)
}
