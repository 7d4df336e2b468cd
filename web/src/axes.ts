// The three directions in a corner of the picture.

import type { Camera } from './camera'

export function drawAxes(canvas: HTMLCanvasElement, camera: Camera): void {
  const c = canvas.getContext('2d')
  if (!c) return
  const { right: r, up: u } = camera
  c.clearRect(0, 0, 144, 144)
  c.lineWidth = 3.5
  c.font = '600 21px system-ui'
  c.textAlign = 'center'
  c.textBaseline = 'middle'
  const inks = ['#c0443c', '#35905a', '#4478c8']
  const order = [0, 1, 2].sort((a, b) => camera.towards.getComponent(a) - camera.towards.getComponent(b))
  for (const k of order) {
    const [x, y] = [72 + 46 * r.getComponent(k), 72 - 46 * u.getComponent(k)]
    c.strokeStyle = c.fillStyle = inks[k]
    c.beginPath()
    c.moveTo(72, 72)
    c.lineTo(x, y)
    c.stroke()
    const reach = Math.hypot(x - 72, y - 72)
    if (reach > 9) c.fillText('xyz'[k], 72 + ((x - 72) * (reach + 15)) / reach, 72 + ((y - 72) * (reach + 15)) / reach)
  }
}
