// The water plane of a floating model and the grid of the ground, both at z = 0: for the eye only.

import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  Vector3,
} from 'three'
import { ink } from './colour'

/** How far both go beyond the model, of its larger side, and the cells of the grid along that side, at least. */
const [BEYOND, CELLS] = [0.25, 10]

/** The largest of 1, 2 and 5 times a power of ten that is at most a length. */
export function round(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length))
  return ([5, 2, 1].find((k) => k * power <= length * (1 + 1e-9)) ?? 1) * power
}

/** From and to, in x and y: the extent of a box and what is beyond it. */
export function area(box: Box3): [number, number, number, number] {
  const size = box.getSize(new Vector3())
  const more = BEYOND * Math.max(size.x, size.y, 0.2 * size.z)
  return [box.min.x - more, box.min.y - more, box.max.x + more, box.max.y + more]
}

/** Ends of the lines of a grid over an area: multiples of its cell, six numbers to a line. */
export function gridLines([x0, y0, x1, y1]: number[]): Float32Array {
  const cell = round(Math.max(x1 - x0, y1 - y0) / CELLS)
  const flat: number[] = []
  const [a0, a1] = [Math.floor(x0 / cell) * cell, Math.ceil(x1 / cell) * cell]
  const [b0, b1] = [Math.floor(y0 / cell) * cell, Math.ceil(y1 / cell) * cell]
  for (let k = 0; a0 + k * cell <= a1 + 1e-6 * cell; k++) flat.push(a0 + k * cell, b0, 0, a0 + k * cell, b1, 0)
  for (let k = 0; b0 + k * cell <= b1 + 1e-6 * cell; k++) flat.push(a0, b0 + k * cell, 0, a1, b0 + k * cell, 0)
  return new Float32Array(flat)
}

export class Ground {
  readonly group = new Group()
  /** Whether the water of a floating model, and the grid, are shown. */
  water = false
  grid = false
  private readonly plane: Mesh
  private readonly lines: LineSegments

  constructor() {
    const water = new MeshBasicMaterial({
      transparent: true,
      opacity: 0.16,
      side: DoubleSide,
      depthWrite: false,
    })
    this.plane = new Mesh(new BufferGeometry(), water)
    this.lines = new LineSegments(
      new BufferGeometry(),
      new LineBasicMaterial({ transparent: true, opacity: 0.45, depthWrite: false }),
    )
    for (const part of [this.plane, this.lines]) part.frustumCulled = false
    this.group.add(this.lines, this.plane)
  }

  /** Follows a model: its extent, whether it floats, and the theme. */
  follow(box: Box3, afloat: boolean, dark: boolean): void {
    this.plane.visible = this.water && afloat && !box.isEmpty()
    this.lines.visible = this.grid && !box.isEmpty()
    ;(this.plane.material as MeshBasicMaterial).color.set(ink(dark ? 'water-dark' : 'water'))
    ;(this.lines.material as LineBasicMaterial).color.set(ink(dark ? 'line-grid-dark' : 'line-grid'))
    if (box.isEmpty()) return
    const [x0, y0, x1, y1] = area(box)
    if (this.plane.visible)
      this.put(this.plane, new Float32Array([x0, y0, 0, x1, y0, 0, x1, y1, 0, x0, y0, 0, x1, y1, 0, x0, y1, 0]))
    if (this.lines.visible) this.put(this.lines, gridLines([x0, y0, x1, y1]))
  }

  private put(part: Mesh | LineSegments, flat: Float32Array): void {
    part.geometry.dispose()
    part.geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(flat, 3))
  }

  /** What is seen of it: the ends of lines and of the plane, for tests. */
  get shown(): { water: boolean; grid: boolean } {
    return { water: this.plane.visible, grid: this.lines.visible }
  }

  /** A box with what is shown in it, for the depth of the picture. */
  within(box: Box3): Box3 {
    const { water, grid } = this.shown
    if (!water && !grid) return box
    return box.clone().union(new Box3().setFromObject(this.group))
  }
}
