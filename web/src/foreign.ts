// Meshes and offsets of other programs over the model, coloured by their deviation.

import type { Scale } from './colour'
import { shown } from './dom'
import type { Frame } from './frame'
import { type Link, Newest } from './link'
import { model } from './state'
import type { Drawn, View } from './view'

interface ForeignMesh {
  name: string
  position: Float32Array
  triangle: Uint32Array
  edge: Uint32Array
  deviation: Float32Array | null
}

/** The largest file: in base64 it is one message. */
const LARGEST = 11 << 20

/** Bytes as a text; an error when they are more than a message holds. */
export function inBase64(name: string, bytes: Uint8Array): string {
  if (bytes.length > LARGEST) throw new Error(`${name} is larger than ${LARGEST >> 20} MiB`)
  let raw = ''
  for (let k = 0; k < bytes.length; k += 0x8000) raw += String.fromCharCode(...bytes.subarray(k, k + 0x8000))
  return btoa(raw)
}

/** Triangles as a binary STL file; null for none. */
export function asStl(all: Pick<Drawn, 'position' | 'triangle' | 'origin'>[]): Uint8Array | null {
  const count = all.reduce((n, i) => n + i.triangle.length / 3, 0)
  if (!count) return null
  const data = new DataView(new ArrayBuffer(84 + 50 * count))
  data.setUint32(80, count, true)
  let at = 84
  for (const { position, triangle, origin } of all)
    for (let k = 0; k < triangle.length; k += 3) {
      // The normal is left as zero: readers find it from the corners.
      at += 12
      for (let c = 0; c < 3; c++)
        for (let axis = 0; axis < 3; axis++, at += 4)
          data.setFloat32(at, position[3 * triangle[k + c] + axis] + origin.getComponent(axis), true)
      at += 2
    }
  return new Uint8Array(data.buffer)
}

export class Foreign {
  /** The colours of the deviation, when something is shown. */
  scale: Scale | null = null
  private meshes: ForeignMesh[] = []
  private readonly files = new Map<string, string>()
  private readonly deviating = new Newest<void>(async () => {
    if (this.meshes.length)
      await this.link.ask('deviation').then(
        (f) => this.laid(f),
        () => undefined,
      )
  })

  constructor(
    private readonly view: View,
    private readonly link: Link,
    private readonly act: { say(words: string): void; legend(): void },
  ) {}

  /** The model has changed. */
  refresh(): void {
    if (this.meshes.length) this.deviating.push(undefined)
  }

  private laid(frame: Frame): void {
    const overlays = frame.head.overlays as any[]
    this.meshes = overlays.map((o) => {
      const old = this.meshes.find((f) => f.name === o.name)
      return {
        name: o.name,
        position: o.position ? frame.floats(o.position) : old!.position,
        triangle: o.triangle ? frame.numbers(o.triangle) : old!.triangle,
        edge: o.edge ? frame.numbers(o.edge) : old!.edge,
        deviation: o.deviation ? frame.floats(o.deviation) : null,
      }
    })
    this.scale = this.view.foreign(this.meshes)
    this.act.legend()
    const words = overlays.map((o) =>
      o.rms === undefined
        ? `${o.name}: the model has no surface to compare with`
        : `${o.name}: rms ${shown(o.rms, 4)}, largest ${shown(o.largest, 4)} ${model.unit}`,
    )
    if (words.length) this.act.say(words.join(' · '))
  }

  /** Lays a file over the model. */
  async lay(name: string, bytes: Uint8Array): Promise<void> {
    const data = inBase64(name, bytes)
    this.laid(await this.link.ask('overlay', { name, data }))
    this.files.set(name, data)
  }

  /** Lays the shape as it is now over what it becomes: colours show how far the two are apart. */
  async keepShape(): Promise<void> {
    const bytes = asStl([...this.view.items.values()].filter((i) => i.kind === 'patch' && this.view.seen(i)))
    if (!bytes) return this.act.say('There is no surface to keep')
    await this.lay('shape before.stl', bytes).catch((error: Error) => this.act.say(error.message))
  }

  async remove(): Promise<void> {
    this.files.clear()
    this.laid(await this.link.ask('remove_overlay'))
  }

  /** A new engine is given them again. */
  async again(): Promise<void> {
    for (const [name, data] of this.files)
      await this.link.ask('overlay', { name, data }).then(
        (f) => this.laid(f),
        (error) => this.act.say(error.message),
      )
  }
}
