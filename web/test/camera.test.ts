import { Box3, Vector3 } from 'three'
import { expect, test } from 'vitest'
import { Camera, type Standard } from '../src/camera'

const BOX = new Box3(new Vector3(3, -2, 10), new Vector3(33, 5, 14))
const ASPECT = 1.4
/** The picture's height, in picture points. */
const HEIGHT = 500

function corners(): Vector3[] {
  return [0, 1, 2, 3, 4, 5, 6, 7].map(
    (k) => new Vector3(...[0, 1, 2].map((c) => ((k >> c) & 1 ? BOX.max : BOX.min).getComponent(c))),
  )
}

/** Where a place is in the picture, from its middle to the right and up, in halves of its size. */
function seen(camera: Camera, p: Vector3): [number, number] {
  camera.aim(ASPECT, BOX)
  const v = p.clone().project(camera.three)
  return [v.x, v.y]
}

const VIEWS: Standard[] = ['iso', 'profile', 'plan', 'body', 'stern', 'starboard', 'bottom']

test.each(VIEWS)('%s shows all below what is covered, and not too small', (view) => {
  for (const perspective of [false, true])
    for (const inset of [0, 0.2]) {
      const camera = new Camera()
      camera.look(view)
      Object.assign(camera, { perspective, inset })
      camera.fit(BOX, ASPECT)
      const all = corners().map((p) => seen(camera, p))
      const [top, bottom] = [Math.max(...all.map((a) => a[1])), Math.min(...all.map((a) => a[1]))]
      const wide = Math.max(...all.map((a) => Math.abs(a[0])))
      if (!perspective) {
        expect(top).toBeLessThan(1 - 2 * inset)
        expect(bottom).toBeGreaterThan(-1)
        expect(wide).toBeLessThan(1)
        // In the middle of the rest, and filling it one way or the other.
        expect(top + bottom).toBeCloseTo(-2 * inset, 6)
        expect(Math.max((top - bottom) / 2 / (1 - inset), wide)).toBeGreaterThan(0.85)
      } else expect(Math.max(top - 1 + 2 * inset, -1 - bottom, wide - 1)).toBeLessThan(0.15)
    }
})

test('a zoom keeps what is under the pointer', () => {
  for (const inset of [0, 0.15]) {
    const camera = new Camera()
    camera.inset = inset
    camera.fit(BOX, ASPECT)
    const place = new Vector3(12, 1, 12)
    const before = seen(camera, place)
    const at = [(before[0] * ASPECT * HEIGHT) / 2, (-before[1] * HEIGHT) / 2]
    camera.zoom(0.4, at[0], at[1], HEIGHT)
    const after = seen(camera, place)
    expect(after[0]).toBeCloseTo(before[0], 6)
    expect(after[1]).toBeCloseTo(before[1], 6)
  }
})
