// Rays against random triangles, by boxes and by brute force; and the time of a pick in a million.
//
// Arguments: the compiled `pick.js`, how many cases. Prints JSON.

import { pathToFileURL } from 'node:url'

const [, , script, cases] = process.argv
const { hit } = await import(pathToFileURL(script))

let seed = 7
const random = () => ((seed = (seed * 1103515245 + 12345) % 2147483648) / 2147483648)
const signed = () => 2 * random() - 1

/** The nearest triangle by the planes of its sides, one after the other. */
function slow(position, triangle, o, d) {
  let best = null
  const at = (k) => [0, 1, 2].map((c) => position[3 * triangle[k] + c])
  const minus = (a, b) => a.map((x, c) => x - b[c])
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
  for (let k = 0; k < triangle.length; k += 3) {
    const [a, b, c] = [at(k), at(k + 1), at(k + 2)]
    const n = cross(minus(b, a), minus(c, a))
    const t = dot(n, minus(a, o)) / dot(n, d)
    if (!(t >= 0) || (best && t >= best.t)) continue
    const p = o.map((x, c) => x + t * d[c])
    const sides = [[a, b], [b, c], [c, a]].map(([q, r]) => dot(cross(minus(r, q), minus(p, q)), n))
    // What grazes a side may be decided either way.
    const size = dot(n, n)
    if (sides.every((s) => s >= 0)) best = { t, at: k, edge: Math.min(...sides) < 1e-6 * size }
  }
  return best
}

let [wrong, met, edges] = [[], 0, 0]
for (let run = 0; run < Number(cases); run++) {
  const count = 1 + Math.floor(random() * 400)
  const position = Float32Array.from({ length: 9 * count }, signed)
  for (let k = 0; k < count; k++) {
    const [x, y, z] = [signed() * 5, signed() * 5, signed() * 5]
    // Flat runs as well: panels in a coordinate plane.
    const flat = run % 3 === 0 ? 0 : 1
    for (let v = 0; v < 3; v++) for (const [c, m] of [x, y, z].entries()) position[9 * k + 3 * v + c] = (c === 2 ? flat : 1) * (position[9 * k + 3 * v + c] * 0.7 + m)
  }
  const triangle = Uint32Array.from({ length: 3 * count }, (_, k) => k)
  for (let ray = 0; ray < 10; ray++) {
    const o = [signed() * 8, signed() * 8, 9]
    const along = ray % 2 ? [0, 0, -1] : [signed(), signed(), -1]
    const length = Math.hypot(...along)
    const d = along.map((x) => x / length)
    const [a, b] = [hit({ position, triangle }, o, d), slow(position, triangle, o, d)]
    if (b?.edge) {
      edges++
      continue
    }
    if (b) met++
    const same = a === null || b === null ? a === b : a.at === b.at && Math.abs(a.t - b.t) < 1e-5 * b.t
    if (!same) wrong.push({ run, ray, a, b })
    if (a) {
      const p = [0, 1, 2].map((c) => a.weights.reduce((s, w, k) => s + w * position[3 * triangle[a.at + k] + c], 0))
      if (p.some((x, c) => Math.abs(x - o[c] - a.t * d[c]) > 1e-4)) wrong.push({ run, ray, p })
    }
  }
}

// A wavy sheet of 708 x 708 panels: 1 002 528 triangles.
const n = 708
const sheet = new Float32Array(3 * (n + 1) ** 2)
for (let i = 0; i <= n; i++) for (let j = 0; j <= n; j++) sheet.set([i / n, j / n, 0.1 * Math.sin(9 * (i / n)) * Math.cos(7 * (j / n))], 3 * (i * (n + 1) + j))
const panels = new Uint32Array(6 * n * n)
for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) {
  const at = (a, b) => (i + a) * (n + 1) + j + b
  panels.set([at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)], 6 * (i * n + j))
}
const timed = []
for (let k = 0; k < 30; k++) {
  // Each is the first one after a change, which makes the boxes anew.
  const position = sheet.slice()
  const from = process.cpuUsage()
  const found = hit({ position, triangle: panels }, [0.2 + 0.02 * k, 0.4, 3], [0.05, 0.02, -1])
  // Of the processor, which other programs may have most of the time.
  timed.push(process.cpuUsage(from).user / 1000)
  if (!found) wrong.push({ k })
}
timed.sort((a, b) => a - b)
console.log(JSON.stringify({ wrong: wrong.slice(0, 3), met, edges, triangles: panels.length / 3, lowest: timed[0], median: timed[15] }))
