// Pen, fingers and palm on one picture: a pen uses the tool; once one was seen, one finger pans and two pinch.

type Place = [number, number]

/** Touches that begin so soon after the pen are the palm, ms; once a pen was seen, wider contacts as well, pixels. */
const [PALM, WIDE] = [500, 60]

export interface Pinch {
  factor: number
  middle: Place
  by: Place
}

type Contact = Pick<PointerEvent, 'pointerId' | 'pointerType' | 'width' | 'height'>

export class Contacts {
  /** Fingers that are down, by pointer. */
  private readonly fingers = new Map<number, Place>()
  /** The pen that is down. */
  private pen: number | null = null
  private last = Number.NEGATIVE_INFINITY

  /** True once a pen was seen. */
  private get penned(): boolean {
    return this.last > Number.NEGATIVE_INFINITY
  }

  /** True when a pen arrives while fingers are down, which from now on are the palm. */
  arrives(e: Contact, now = performance.now()): boolean {
    if (e.pointerType !== 'pen') return false
    this.last = now
    const stopped = this.fingers.size > 0
    this.fingers.clear()
    return stopped
  }

  /** The use of a contact that begins. */
  down(e: Contact, at: Place, now = performance.now()): 'tool' | 'pan' | 'pinch' | 'palm' {
    if (e.pointerType === 'pen') this.pen = e.pointerId
    if (e.pointerType !== 'touch') return 'tool'
    const beside = this.pen !== null || now - this.last < PALM || (this.penned && Math.max(e.width, e.height) > WIDE)
    if (beside || this.fingers.size === 2) return 'palm'
    this.fingers.set(e.pointerId, at)
    return this.fingers.size === 2 ? 'pinch' : this.penned ? 'pan' : 'tool'
  }

  /** The palm, or a finger that has ended. */
  ignored(e: Contact): boolean {
    return e.pointerType === 'touch' && !this.fingers.has(e.pointerId)
  }

  /** The motion of two fingers, of which one is now elsewhere; null for a single one. */
  pinch(e: Contact, now: Place): Pinch | null {
    const before = this.fingers.get(e.pointerId)
    if (!before) return null
    this.fingers.set(e.pointerId, now)
    if (this.fingers.size < 2) return null
    const [, other] = [...this.fingers].find(([id]) => id !== e.pointerId)!
    const far = (a: Place) => Math.max(10, Math.hypot(a[0] - other[0], a[1] - other[1]))
    return {
      factor: far(now) / far(before),
      middle: [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2],
      by: [(now[0] - before[0]) / 2, (now[1] - before[1]) / 2],
    }
  }

  up(e: Contact, now = performance.now()): void {
    this.fingers.delete(e.pointerId)
    if (this.pen !== e.pointerId) return
    this.pen = null
    this.last = now
  }
}
