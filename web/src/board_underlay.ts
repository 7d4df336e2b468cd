// A picture underneath the drawing, to trace over: it stays with the page, and is no part of the sketch.

import type { Page } from './board_paint'
import { h, s } from './dom'

/** Share of the paper that a picture takes at first. */
const FILL = 0.8

export class Underlay {
  private readonly image = s('image', { class: 'underlay', opacity: 0.45 })
  /** Below all that is drawn. */
  readonly element = s('svg', { class: 'paper-under', 'aria-hidden': 'true' }, this.image)
  private place: { corner: [number, number]; size: [number, number] } | null = null

  constructor(
    private readonly page: Page,
    private readonly changed: () => void,
  ) {
    this.image.style.display = 'none'
  }

  /** Lays a picture into the middle of what is seen. */
  async lay(file: File): Promise<void> {
    const picture = await createImageBitmap(file).catch(() => {
      throw new Error(`${file.name} is no picture that a browser reads: expected PNG, JPEG, WebP or SVG`)
    })
    const { width, height } = picture
    picture.close()
    const data = await new Promise<string>((resolve, reject) => {
      const reader = new FileReader()
      reader.onload = () => resolve(String(reader.result))
      reader.onerror = () => reject(new Error(`${file.name} cannot be read`))
      reader.readAsDataURL(file)
    })
    const { page } = this
    const scale = (FILL * Math.min(page.size[0] / width, page.size[1] / height)) / page.scale
    const middle = page.from([page.size[0] / 2, page.size[1] / 2])
    const size: [number, number] = [width * scale, height * scale]
    this.place = { size, corner: [middle[0] - size[0] / 2, middle[1] + size[1] / 2] }
    this.image.setAttribute('href', data)
    this.image.style.display = ''
    this.changed()
  }

  private remove(): void {
    this.place = null
    this.image.removeAttribute('href')
    this.image.style.display = 'none'
    this.changed()
  }

  /** Follows the page. */
  draw(): void {
    if (!this.place) return
    const { corner, size } = this.place
    const [x, y] = this.page.to(corner)
    const [width, height] = size.map((v) => v * this.page.scale)
    for (const [name, value] of Object.entries({ x, y, width, height })) this.image.setAttribute(name, String(value))
  }

  /** The button that chooses a picture; how strongly it shows, and its removal. */
  controls(say: (words: string) => void): HTMLElement[] {
    const file = h('input', { type: 'file', accept: 'image/*', 'aria-label': 'picture underneath', hidden: true })
    file.addEventListener('change', () => {
      const [chosen] = file.files ?? []
      if (chosen) void this.lay(chosen).catch((error) => say((error as Error).message))
    })
    const button = h('button', { title: 'A picture to trace over', onclick: () => file.click() }, 'Picture…')
    if (!this.place) return [button, file]
    const strength = h('input', {
      type: 'range',
      min: 0.1,
      max: 1,
      step: 0.05,
      'aria-label': 'strength of the picture',
    })
    strength.value = this.image.getAttribute('opacity')!
    strength.addEventListener('input', () => this.image.setAttribute('opacity', strength.value))
    const away = h('button', { class: 'icon', 'aria-label': 'remove the picture', onclick: () => this.remove() }, '×')
    return [button, file, strength, away]
  }
}
