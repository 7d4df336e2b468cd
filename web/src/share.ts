// A link that holds a model: its name and text, compressed, behind the # of an address, which no server is sent.

const KEY = 'm'
/** Characters of an address that every browser and most programs take. */
export const LONGEST_LINK = 30_000

interface Held {
  name: string
  text: string
}

async function through(bytes: Uint8Array<ArrayBuffer>, by: GenericTransformStream): Promise<Uint8Array<ArrayBuffer>> {
  const stream = new Blob([bytes]).stream().pipeThrough(by as ReadableWritablePair<Uint8Array, Uint8Array<ArrayBuffer>>)
  return new Uint8Array(await new Response(stream).arrayBuffer())
}

/** The fragment that holds a model. */
export async function packed(model: Held): Promise<string> {
  const bytes = new TextEncoder().encode(JSON.stringify([model.name, model.text]))
  const small = await through(bytes, new CompressionStream('deflate-raw'))
  let raw = ''
  for (let k = 0; k < small.length; k += 0x8000) raw += String.fromCharCode(...small.subarray(k, k + 0x8000))
  return `${KEY}=${btoa(raw).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '')}`
}

/** The model of a fragment; null where it holds none, an error where it is damaged. */
export async function unpacked(fragment: string): Promise<Held | null> {
  const text = new URLSearchParams(fragment.replace(/^#/, '')).get(KEY)
  if (text === null) return null
  try {
    const raw = atob(text.replaceAll('-', '+').replaceAll('_', '/'))
    const bytes = await through(
      Uint8Array.from(raw, (c) => c.charCodeAt(0)),
      new DecompressionStream('deflate-raw'),
    )
    const held = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(bytes))
    if (Array.isArray(held) && held.length === 2 && held.every((x) => typeof x === 'string'))
      return { name: held[0], text: held[1] }
  } catch {
    // Cut short or mistyped.
  }
  throw new Error('the link holds a model that is damaged or cut short')
}
