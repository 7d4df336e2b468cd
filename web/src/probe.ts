// Numbers of the picture for tests.

import { Vector3 } from 'three'
import type { View } from './view'

export interface SeenTriangle {
  object: string
  normal: number[]
  corners: [number, number][]
}

/** The triangles of patches whose middles nothing covers, by their places in the picture. */
export function triangles(view: View): SeenTriangle[] {
  const found: SeenTriangle[] = []
  for (const item of view.items.values()) {
    if (item.kind !== 'patch' || !item.group.visible) continue
    const at = (k: number) => new Vector3().fromArray(item.position, 3 * item.triangle[k]).add(item.origin)
    for (let k = 0; k < item.triangle.length; k += 3) {
      const [a, b, c] = [at(k), at(k + 1), at(k + 2)]
      const middle = a.clone().add(b).add(c).divideScalar(3)
      const met = view.pick(...view.project(middle))
      if (met?.object !== item.object || met.point.distanceTo(middle) > 1e-3 * view.camera.reach) continue
      const normal = b.clone().sub(a).cross(c.clone().sub(a)).normalize().toArray()
      found.push({ object: item.object, normal, corners: [a, b, c].map((p) => view.project(p)) })
    }
  }
  return found
}
