// The solid beside the drawing: the picture's wireframe at first, the body once it is known.

import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  OrthographicCamera,
  Scene,
  ShapeUtils,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three'
import { candidates, type Shape } from './board_candidates'
import type { Drawn } from './board_paint'
import { ink } from './colour'
import { h, shown } from './dom'

export interface SolidFacts {
  exact: boolean
  made: boolean
  volume?: number | null
  area?: number | null
  vertices?: number[]
  quads?: number[]
  why?: { text: string } | null
  /** Closed plane outlines, by their points, while there is no body. */
  outlines?: number[][]
  /** The solids that fit the wireframe, if several do. */
  candidates?: Shape[]
}

/** A plane outline as triangles. */
function flat(corners: (number[] | null | undefined)[]): BufferGeometry | null {
  if (!corners.every(Boolean)) return null
  const at = corners.map((c) => new Vector3(...(c as [number, number, number])))
  const normal = new Vector3()
  at.forEach((a, k) => normal.add(a.clone().cross(at[(k + 1) % at.length])))
  const u = at[1].clone().sub(at[0]).normalize()
  const v = normal.clone().cross(u).normalize()
  const triangles = ShapeUtils.triangulateShape(
    at.map((a) => new Vector2(a.dot(u), a.dot(v))),
    [],
  )
  const geometry = new BufferGeometry()
  geometry.setAttribute(
    'position',
    new BufferAttribute(new Float32Array(triangles.flat().flatMap((k) => at[k].toArray())), 3),
  )
  geometry.computeVertexNormals()
  return geometry
}

export class BoardSolid {
  readonly element = h('div', { class: 'board-solid', role: 'img', 'aria-label': 'no solid yet' })
  private readonly caption = h('div', { class: 'caption' })
  private readonly fits = h('div', { class: 'fits', role: 'group', 'aria-label': 'solids that fit' })
  private readonly renderer: WebGLRenderer
  private readonly scene = new Scene()
  private readonly camera = new OrthographicCamera(-1, 1, 1, -1, -100, 100)
  private readonly parts = new Group()
  private readonly light = new DirectionalLight(0xffffff, 2)
  private direction = new Vector3(1, -1.6, 1)
  private turned = false
  private reach = 1
  private readonly centre = new Vector3()

  constructor(private readonly choose: (n: number) => void) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true })
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio))
    this.element.append(this.renderer.domElement, this.fits, this.caption)
    this.scene.add(new AmbientLight(0xffffff, 1.3), this.light, this.parts)
    new ResizeObserver(() => this.draw()).observe(this.element)
  }

  /** True for a place on the screen that is on the picture. */
  has({ clientX, clientY }: { clientX: number; clientY: number }): boolean {
    const box = this.element.getBoundingClientRect()
    const within = clientX > box.left && clientX < box.right && clientY > box.top && clientY < box.bottom
    return within && this.caption.textContent !== ''
  }

  /** Turned by a hand that moves so many pixels. */
  turn(dx: number, dy: number): void {
    this.turned = true
    const azimuth = Math.atan2(this.direction.y, this.direction.x) - dx * 0.01
    const flat = Math.hypot(this.direction.x, this.direction.y)
    const elevation = Math.max(-1.5, Math.min(1.5, Math.atan2(this.direction.z, flat) + dy * 0.01))
    this.direction.set(
      Math.cos(azimuth) * Math.cos(elevation),
      Math.sin(azimuth) * Math.cos(elevation),
      Math.sin(elevation),
    )
    this.draw()
  }

  /** Seen as the picture is drawn, until a hand turns it. */
  private sight(d: Drawn): void {
    if (this.turned) return
    const [a, b, c] = d.angles.map((x) => (x * Math.PI) / 180)
    if (d.section || c === undefined) {
      this.direction.set(0.45, -1, 0.4)
      return
    }
    const n = new Vector3(Math.sin(c - b), Math.sin(a - c), Math.sin(b - a))
    if (n.length() > 1e-6) this.direction.copy(n.z < 0 ? n.negate() : n)
  }

  show(d: Drawn, solid: SolidFacts | null): void {
    for (const part of this.parts.children) (part as Mesh).geometry.dispose()
    this.parts.clear()
    this.sight(d)
    this.fits.replaceChildren(...(solid ? candidates(solid, this.direction, this.choose) : []))
    const dark = document.documentElement.dataset.theme === 'dark'
    const edges = new LineBasicMaterial({ color: ink(dark ? 'line-rim-dark' : 'line-rim') })
    if (solid?.vertices?.length && solid.quads?.length) {
      const { vertices, quads } = solid
      const corners: number[] = []
      for (let k = 0; k < quads.length; k += 4) {
        const [a, b, c, e] = quads.slice(k, k + 4)
        for (const t of c === e
          ? [[a, b, c]]
          : [
              [a, b, c],
              [a, c, e],
            ])
          for (const i of t) corners.push(...vertices.slice(3 * i, 3 * i + 3))
      }
      const geometry = new BufferGeometry()
      geometry.setAttribute('position', new BufferAttribute(new Float32Array(corners), 3))
      geometry.computeVertexNormals()
      const colour = new Color(ink(solid.exact ? 'body' : 'estimate'))
      this.parts.add(
        new Mesh(
          geometry,
          new MeshLambertMaterial({
            color: colour,
            flatShading: true,
            side: DoubleSide,
            transparent: !solid.exact,
            opacity: solid.exact ? 1 : 0.72,
            polygonOffset: true,
            polygonOffsetFactor: 1,
            polygonOffsetUnits: 1,
          }),
        ),
      )
      this.parts.add(new LineSegments(new EdgesGeometry(geometry, 12), edges))
    } else {
      const places = new Map(d.points?.map((p) => [p[0], p[3]?.map((x) => x ?? 0) ?? null]))
      const ends = (d.lines ?? []).flatMap(([, p, q]) =>
        places.get(p) && places.get(q) ? [...places.get(p)!, ...places.get(q)!] : [],
      )
      const geometry = new BufferGeometry()
      geometry.setAttribute('position', new BufferAttribute(new Float32Array(ends), 3))
      if (ends.length) this.parts.add(new LineSegments(geometry, edges))
      for (const way of solid?.outlines ?? []) {
        const face = flat(way.map((p) => places.get(p)))
        if (face)
          this.parts.add(
            new Mesh(
              face,
              new MeshLambertMaterial({
                color: ink('estimate'),
                side: DoubleSide,
                transparent: true,
                opacity: 0.4,
                depthWrite: false,
              }),
            ),
          )
      }
    }
    const box = new Vector3()
    const low = new Vector3(Infinity, Infinity, Infinity)
    const high = low.clone().negate()
    for (const part of this.parts.children) {
      const { geometry } = part as Mesh
      geometry.computeBoundingBox()
      low.min(geometry.boundingBox!.min)
      high.max(geometry.boundingBox!.max)
    }
    if (this.parts.children.length) {
      this.centre.copy(low).add(high).multiplyScalar(0.5)
      this.reach = Math.max(1e-9, box.copy(high).sub(low).length() / 2)
    }
    const number = solid?.volume ?? solid?.area
    const what = solid?.volume != null ? 'volume' : 'area'
    const words =
      number == null
        ? d.lines?.length
          ? 'wireframe as the picture suggests it'
          : ''
        : solid!.exact
          ? `${what} ${shown(number, 10)}`
          : `estimate: ${what} ≈ ${shown(number, 3)}`
    this.caption.textContent = words
    this.caption.className = `caption ${solid?.exact && number != null ? 'exact' : 'estimate'}`
    this.element.dataset.volume = number == null ? '' : String(number)
    this.element.dataset.exact = String(!!solid?.exact && number != null)
    this.element.setAttribute('aria-label', words || 'no solid yet')
    this.draw()
  }

  draw(): void {
    const { clientWidth: w, clientHeight: t } = this.element
    if (!w || !t) return
    this.renderer.setSize(w, t)
    const half = this.reach * 1.15
    const wide = w / t
    Object.assign(this.camera, {
      left: -half * Math.max(1, wide),
      right: half * Math.max(1, wide),
      top: half * Math.max(1, 1 / wide),
      bottom: -half * Math.max(1, 1 / wide),
      near: -10 * half,
      far: 10 * half,
    })
    const d = this.direction.clone().normalize()
    this.camera.up.set(0, 0, 1)
    this.camera.position.copy(this.centre).addScaledVector(d, half)
    this.camera.lookAt(this.centre)
    this.camera.updateProjectionMatrix()
    this.light.position.copy(d).add(new Vector3(0.3, -0.2, 0.9))
    this.renderer.render(this.scene, this.camera)
  }
}
