// Volume grids: a plane of a block in the picture, coloured by the quality of its cells, and the cells that are folded.

import { ink, type Scale } from './colour'
import { h, shown } from './dom'
import { type Link, Newest } from './link'
import type { View } from './view'

interface Block {
  name: string
  divisions: [number, number, number]
  cells: number
  volume: number | string
  folded: number
  worst: number | string
  cell: [number, number, number]
  at: (number | string)[]
  mean: number | string
  aspect: number | string
}

const AXES = ['i', 'j', 'k']

export class BlockPlanes {
  /** The colours of the plane that is shown. */
  scale: Scale | null = null
  private blocks: Block[] = []
  private block = ''
  private axis = 2
  private index = 0
  private failed = false
  private readonly requests = new Newest<void>(() => this.build())
  private bar: {
    block: HTMLSelectElement
    axis: HTMLSelectElement
    slider: HTMLInputElement
    out: HTMLElement
    words: HTMLElement
  } | null = null

  constructor(
    private readonly host: HTMLElement,
    private readonly view: View,
    private readonly link: Link,
    private readonly act: { say(words: string): void; legend(): void },
  ) {}

  get shown(): boolean {
    return !this.host.hidden
  }

  toggle(): void {
    if (this.shown) return this.close()
    this.host.hidden = false
    this.refresh()
  }

  close(): void {
    this.host.hidden = true
    this.bar = null
    this.scale = null
    this.host.replaceChildren()
    this.view.plane(null)
    this.view.overlay('folded', null)
    this.act.legend()
  }

  refresh(): void {
    if (this.shown) this.requests.push(undefined)
  }

  private async build(): Promise<void> {
    try {
      if (!this.block) this.blocks = (await this.link.ask('blocks')).head.blocks
      if (!this.blocks.length) {
        this.act.say('The model has no volume blocks: declare a solid or a block')
        return this.close()
      }
      const now = this.blocks.find((b) => b.name === this.block) ?? this.blocks[0]
      this.block = now.name
      this.index = Math.max(0, Math.min(now.divisions[this.axis], this.index))
      const frame = await this.link.ask('blocks', { block: this.block, axis: this.axis, index: this.index })
      if (!this.shown) return
      this.failed = false
      this.blocks = frame.head.blocks
      const { plane, folded } = frame.head
      this.scale = this.view.plane({
        position: frame.floats(plane.position),
        triangle: frame.numbers(plane.triangle),
        edge: frame.numbers(plane.edge),
        value: frame.floats(plane.value),
      })
      const ends = frame.floats(folded)
      this.view.overlay(
        'folded',
        Array.from({ length: ends.length / 6 }, (_, k) => Array.from(ends.subarray(6 * k, 6 * k + 6))),
        ink('cut'),
      )
      this.say()
      this.act.legend()
    } catch (error) {
      if ((error as Error).message === 'superseded') return
      this.act.say((error as Error).message)
      if (this.failed) return this.close()
      // The block has gone with a change of the text: another one is looked for.
      this.failed = true
      this.block = ''
      this.refresh()
    }
  }

  private say(): void {
    const now = this.blocks.find((b) => b.name === this.block)
    if (!now) return
    const bar = (this.bar ??= this.made())
    const names = this.blocks.map((b) => b.name)
    if ([...bar.block.options].map((o) => o.value).join('\n') !== names.join('\n'))
      bar.block.replaceChildren(...names.map((n) => h('option', { value: n }, n)))
    bar.block.value = this.block
    bar.axis.value = String(this.axis)
    bar.slider.max = String(now.divisions[this.axis])
    bar.slider.value = String(this.index)
    bar.slider.setAttribute(
      'aria-valuetext',
      `${AXES[this.axis]} = ${this.index + 1} of ${now.divisions[this.axis] + 1}`,
    )
    bar.out.textContent = `${this.index + 1} of ${now.divisions[this.axis] + 1}`
    const bad = this.blocks.reduce((n, b) => n + b.folded, 0)
    bar.words.textContent = bad ? `${bad} folded cells` : `no folded cell, worst ${shown(now.worst, 3)}`
    bar.words.className = bad ? 'bad' : 'quiet'
    bar.words.title = `scaled Jacobian of the worst cell (${now.cell.map((n) => n + 1).join(', ')}) of ${now.name}; mean ${shown(now.mean, 3)}, largest aspect ${shown(now.aspect, 3)}`
  }

  private made() {
    const block = h('select', { 'aria-label': 'block' })
    const axis = h('select', { 'aria-label': 'axis of the plane' }, ...AXES.map((a, k) => h('option', { value: k }, a)))
    const slider = h('input', { type: 'range', min: 0, step: 1, 'aria-label': 'plane of the block' })
    const out = h('span', { class: 'mono' })
    const words = h('span', { class: 'quiet', role: 'status' })
    block.addEventListener('change', () => ((this.block = block.value), this.refresh()))
    axis.addEventListener('change', () => ((this.axis = Number(axis.value)), this.refresh()))
    slider.addEventListener('input', () => ((this.index = slider.valueAsNumber), this.refresh()))
    this.host.replaceChildren(
      'block',
      block,
      axis,
      '=',
      slider,
      out,
      words,
      h('button', { class: 'icon', 'aria-label': 'no plane of a block', onclick: () => this.close() }, '×'),
    )
    return { block, axis, slider, out, words }
  }
}
