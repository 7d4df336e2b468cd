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
  MeshBasicMaterial,
  MeshLambertMaterial,
  OrthographicCamera,
  Raycaster,
  Scene,
  ShapeUtils,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three'
import { candidates, type Shape } from './board_candidates'
import type { Drawn, Place } from './board_paint'
import { ink } from './colour'
import { h, shown } from './dom'

/** A number of the object as an arrow in space. */
export interface Handle {
  kind: 'next' | 'value' | 'place'
  name: string
  value: number
  at: [number, number, number]
  /** How its place moves with its value. */
  along: [number, number, number]
  axis?: string
  p?: number
  q?: number
  point?: number
  now?: number[]
}

/** A plane face of a body: its name in commands, and the plane of a section on it. */
export interface PlaneFace {
  name: string
  plane: string
}

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
  /** The face of each facet, and of each face its name and plane. */
  of?: number[]
  names?: ([string, string] | null)[]
  handles?: Handle[]
}

/** The triangles of facets of four corners, of which the last is there twice in a triangle. */
function triangles({ vertices, quads }: Shape): { corners: number[]; facets: number[] } {
  const corners: number[] = []
  const facets: number[] = []
  for (let k = 0; k < quads.length; k += 4) {
    const [a, b, c, e] = quads.slice(k, k + 4)
    for (const t of c === e
      ? [[a, b, c]]
      : [
          [a, b, c],
          [a, c, e],
        ]) {
      for (const i of t) corners.push(...vertices.slice(3 * i, 3 * i + 3))
      facets.push(k / 4)
    }
  }
  return { corners, facets }
}

function geometryOf(corners: number[]): BufferGeometry {
  const geometry = new BufferGeometry()
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(corners), 3))
  geometry.computeVertexNormals()
  return geometry
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
  /** The facet of each triangle of the body, and its facts. */
  private body: { mesh: Mesh; facets: number[]; corners: number[]; facts: SolidFacts } | null = null
  private readonly ground = new Group()
  private readonly marks = new Group()
  private lit = -1
  private chosen = -1
  /** True while a handle is held: the picture keeps its frame. */
  frozen = false

  constructor(
    private readonly choose: (n: number) => void,
    private readonly drew: () => void,
  ) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true })
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio))
    this.element.append(this.renderer.domElement, this.fits, this.caption)
    this.parts.matrixAutoUpdate = false
    this.scene.add(new AmbientLight(0xffffff, 1.3), this.light, this.ground, this.parts, this.marks)
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
    if (d.place) {
      const across = d.place.columns['XYZ'.indexOf('XYZ'.replace(new RegExp(`[${d.section}]`, 'g'), ''))]
      this.direction.set(...across).multiplyScalar(d.place.outward * 1.4)
      this.direction.add(new Vector3(0.5, -0.8, 0.5))
      return
    }
    if (d.section || c === undefined) {
      this.direction.set(0.45, -1, 0.4)
      return
    }
    const n = new Vector3(Math.sin(c - b), Math.sin(a - c), Math.sin(b - a))
    if (n.length() > 1e-6) this.direction.copy(n.z < 0 ? n.negate() : n)
  }

  show(d: Drawn, solid: SolidFacts | null): void {
    for (const group of [this.parts, this.ground]) {
      for (const part of group.children) (part as Mesh).geometry.dispose()
      group.clear()
    }
    this.body = null
    this.sight(d)
    this.fits.replaceChildren(...(solid ? candidates(solid, this.direction, this.choose) : []))
    const dark = document.documentElement.dataset.theme === 'dark'
    const edges = new LineBasicMaterial({ color: ink(dark ? 'line-rim-dark' : 'line-rim') })
    if (solid?.vertices?.length && solid.quads?.length) {
      const { vertices, quads } = solid
      const { corners, facets } = triangles({ vertices, quads })
      const geometry = geometryOf(corners)
      const colour = new Color(ink(solid.exact ? 'body' : 'estimate'))
      const mesh = new Mesh(
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
      )
      this.parts.add(mesh, new LineSegments(new EdgesGeometry(geometry, 12), edges))
      if (solid.names?.length) this.body = { mesh, facets, corners, facts: solid }
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
    this.parts.matrix.identity()
    if (d.place) this.based(d.place)
    if (this.chosen >= (this.body?.facts.names?.length ?? 0)) this.chosen = -1
    this.mark()
    if (!this.frozen) this.frame()
    const number = solid?.volume ?? solid?.area
    const what = solid?.volume != null ? 'volume' : 'area'
    const words =
      number == null
        ? d.lines?.length
          ? 'wireframe as the picture suggests it'
          : d.place
            ? `on face ${d.place.face} of ${d.place.body}`
            : ''
        : solid!.exact
          ? `${what} ${shown(number, 10)}`
          : `estimate: ${what} ≈ ${shown(number, 3)}`
    this.caption.textContent = words
    this.caption.className = `caption ${solid?.exact && number != null ? 'exact' : 'estimate'}`
    this.element.dataset.volume = number == null ? '' : String(number)
    // A body that is not drawn has the paper.
    this.element.classList.toggle('alone', !d.lines?.length && !!solid?.vertices?.length)
    this.element.dataset.exact = String(!!solid?.exact && number != null)
    this.element.setAttribute('aria-label', words || 'no solid yet')
    this.draw()
  }

  /** The body on whose face the section is drawn, and the section there. */
  private based({ columns: [a, b, c, o], vertices, quads }: NonNullable<Drawn['place']>): void {
    this.parts.matrix.set(a[0], b[0], c[0], o[0], a[1], b[1], c[1], o[1], a[2], b[2], c[2], o[2], 0, 0, 0, 1)
    const geometry = geometryOf(triangles({ vertices, quads }).corners)
    const colour = { color: ink('body'), side: DoubleSide, transparent: true, opacity: 0.55, depthWrite: false }
    this.ground.add(
      new Mesh(geometry, new MeshLambertMaterial({ ...colour, flatShading: true })),
      new LineSegments(new EdgesGeometry(geometry, 12), new LineBasicMaterial({ color: ink('line-ghost') })),
    )
  }

  /** All is in the picture. */
  private frame(): void {
    const low = new Vector3(Infinity, Infinity, Infinity)
    const high = low.clone().negate()
    for (const group of [this.parts, this.ground])
      for (const part of group.children) {
        const { geometry } = part as Mesh
        geometry.computeBoundingBox()
        const box = geometry.boundingBox!.clone()
        if (group === this.parts) box.applyMatrix4(this.parts.matrix)
        low.min(box.min)
        high.max(box.max)
      }
    if (low.x > high.x) return
    this.centre.copy(low).add(high).multiplyScalar(0.5)
    this.reach = Math.max(1e-9, high.sub(low).length() / 2)
  }

  // Faces, and places on the paper.

  /** The plane face under a place on the screen: its index, or -1. */
  faceAt({ clientX, clientY }: { clientX: number; clientY: number }): number {
    if (!this.body) return -1
    const box = this.element.getBoundingClientRect()
    const at = new Vector2(
      (2 * (clientX - box.left - this.element.clientLeft)) / this.element.clientWidth - 1,
      1 - (2 * (clientY - box.top - this.element.clientTop)) / this.element.clientHeight,
    )
    const ray = new Raycaster()
    ray.setFromCamera(at, this.camera)
    const [hit] = ray.intersectObject(this.body.mesh)
    const face = hit?.faceIndex == null ? -1 : this.body.facts.of![this.body.facets[hit.faceIndex]]
    return this.body.facts.names![face] ? face : -1
  }

  /** The face under the pointer is lit. */
  lightFace(face: number): void {
    if (face === this.lit) return
    this.lit = face
    this.mark()
    this.draw()
  }

  /** The face that is chosen; null when none is. */
  get face(): PlaneFace | null {
    const found = this.body?.facts.names?.[this.chosen]
    return found ? { name: found[0], plane: found[1] } : null
  }

  /** The largest extent of the chosen face. */
  get size(): number {
    const at = this.own(this.chosen)
    const span = (k: number) => {
      const all = at.filter((_, i) => i % 3 === k)
      return all.length ? Math.max(...all) - Math.min(...all) : 0
    }
    return Math.max(span(0), span(1), span(2))
  }

  pick(face: number): void {
    this.chosen = face === this.chosen ? -1 : face
    this.mark()
    this.draw()
  }

  /** The next plane face, for keys. */
  walk(step: number): void {
    const names = this.body?.facts.names ?? []
    const all = names.flatMap((n, k) => (n ? [k] : []))
    const now = all.indexOf(this.chosen)
    this.chosen = all.length ? all[(now + (now < 0 && step < 0 ? 0 : step) + all.length) % all.length] : -1
    this.mark()
    this.draw()
  }

  /** The corners of the triangles of a face. */
  private own(face: number): number[] {
    const { body } = this
    if (!body) return []
    return body.facets.flatMap((facet, k) =>
      body.facts.of![facet] === face ? body.corners.slice(9 * k, 9 * k + 9) : [],
    )
  }

  private mark(): void {
    for (const part of this.marks.children) (part as Mesh).geometry.dispose()
    this.marks.clear()
    const { theme } = document.documentElement.dataset
    for (const [face, opacity] of [
      [this.lit, 0.3],
      [this.chosen, 0.75],
    ]) {
      const corners = this.own(face)
      if (!corners.length) continue
      const material = new MeshBasicMaterial({
        color: ink(theme === 'dark' ? 'accent-dark' : 'accent'),
        side: DoubleSide,
        transparent: true,
        opacity,
      })
      this.marks.add(new Mesh(geometryOf(corners), material))
    }
  }

  /** A place of the object on the paper. */
  place(at: [number, number, number]): Place {
    const p = new Vector3(...at).applyMatrix4(this.parts.matrix).project(this.camera)
    const { offsetLeft, offsetTop, clientLeft, clientTop, clientWidth, clientHeight } = this.element
    return [
      offsetLeft + clientLeft + ((p.x + 1) / 2) * clientWidth,
      offsetTop + clientTop + ((1 - p.y) / 2) * clientHeight,
    ]
  }

  /** Picture points of a unit across the sight. */
  get scale(): number {
    return this.element.clientWidth / (this.camera.right - this.camera.left)
  }

  /** Half of what is shown. */
  get extent(): number {
    return this.reach
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
    this.camera.updateMatrixWorld()
    this.parts.matrixWorldNeedsUpdate = true
    this.renderer.render(this.scene, this.camera)
    this.drew()
  }
}
