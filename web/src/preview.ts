// Bodies of sets are coarser while a hand moves, so that the picture follows it, and exact when it rests.

import type { Frame } from './frame'
import type { Given, Link, RequestOf } from './link'
import { model } from './state'

/** Time of a change beyond which the next is coarser, in ms: twenty pictures a second. */
const SLOW = 45
/** Time of a change below which the next is finer, in ms: cells of half the size take four to eight times as long. */
const QUICK = 5
/** Largest number of halvings. */
const COARSEST = 4
/** How long a hand rests before bodies are exact again, in ms. */
const REST = 150

/** Requests of a number that moves. */
export type Move = 'set' | 'solve_for' | 'drag_to'

export class Preview {
  private coarser = 0
  /** True if the last request used another number of halvings than the one before. */
  private changed = false
  private shown = false
  private timer: ReturnType<typeof setTimeout> | undefined
  private moving = 0

  constructor(private readonly link: Link) {}

  /** Asks for a change while a number moves. */
  async ask<K extends Move>(kind: K, fields: RequestOf<K>): Promise<Frame> {
    if (!model.objects.some((o) => o.kind === 'SetBody')) return this.link.ask(kind, ...([fields] as Given<K>))
    const { coarser, changed } = this
    const from = performance.now()
    this.changed = false
    this.shown ||= coarser > 0
    this.moving++
    clearTimeout(this.timer)
    try {
      return await this.link.ask(kind, ...([{ ...fields, coarser }] as Given<K>))
    } finally {
      this.moving--
      // The first change of another size runs the whole model.
      if (!changed && this.coarser === coarser) this.pace(performance.now() - from)
      this.settleLater()
    }
  }

  private pace(took: number): void {
    const step = took > SLOW ? 1 : took < QUICK ? -1 : 0
    const next = Math.min(Math.max(this.coarser + step, 0), COARSEST)
    this.changed = next !== this.coarser
    this.coarser = next
  }

  private settleLater(): void {
    clearTimeout(this.timer)
    if (!this.shown || this.moving) return
    this.timer = setTimeout(() => {
      this.shown = false
      void this.link.ask('settle').catch(() => undefined)
    }, REST)
  }
}
