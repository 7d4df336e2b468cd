// Replies of the engine: a head of facts and arrays of numbers, see `crates/session/src/frame.rs`.

export type Facts = Record<string, any>

export interface Part {
  role: string
  type: 'f32' | 'u32' | 'u8'
  offset: number
  count: number
  [more: string]: any
}

const MAGIC = 0x54464c4d
const VERSION = 1
const LIMIT = 1 << 30

export class Frame {
  readonly head: Facts
  private readonly start: number

  constructor(private readonly buffer: ArrayBuffer) {
    const view = new DataView(buffer)
    if (buffer.byteLength < 16 || view.getUint32(0, true) !== MAGIC || view.getUint32(4, true) !== VERSION)
      throw new Error('the engine speaks another version: reload the page')
    const length = view.getUint32(8, true)
    if (length > LIMIT || 16 + length > buffer.byteLength) throw new Error('a frame is cut short')
    this.head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 16, length)))
    this.start = Math.ceil((16 + length) / 8) * 8
  }

  floats(part: Part): Float32Array {
    return new Float32Array(this.buffer, this.checked(part, 4), part.count)
  }

  numbers(part: Part): Uint32Array {
    return new Uint32Array(this.buffer, this.checked(part, 4), part.count)
  }

  bytes(part: Part): Uint8Array {
    return new Uint8Array(this.buffer, this.checked(part, 1), part.count)
  }

  private checked(part: Part, size: number): number {
    const at = this.start + part.offset
    const whole = Number.isInteger(part.offset) && Number.isInteger(part.count) && part.offset >= 0 && part.count >= 0
    if (!whole || at + size * part.count > this.buffer.byteLength) throw new Error('an array lies outside of its frame')
    return at
  }
}
