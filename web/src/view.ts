// The picture of the model: what the engine sends, and nothing computed from it but colours.

import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  type InterleavedBufferAttribute,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  Plane,
  Points,
  PointsMaterial,
  type Ray,
  Raycaster,
  Scene,
  ShaderMaterial,
  Vector2,
  Vector3,
  WebGLRenderer,
} from 'three'
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js'
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js'
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js'
import { Camera } from './camera'
import { Cap } from './cap'
import { coloured, HUES, hex, ink, type Line, type Scale, scale } from './colour'
import { creases, isTriangulation } from './creases'
import type { Frame, Part } from './frame'
import { Ground } from './ground'
import { type Pane, panes } from './panes'
import { type Hit, hit } from './pick'
import { DOT_FRAGMENT, DOT_VERTEX, FRAGMENT, VERTEX } from './shaders'

export type Style = 'shaded' | 'panels' | 'smooth' | 'wire' | 'xray'
export type Paint = 'patches' | 'model' | 'zebra' | 'reflection' | 'isophotes' | 'highlight' | 'field'

/** More points than these are drawn smaller: they hide less of the shape. */
const CROWD = 120
/** Edges of triangulations are looked for when nothing has come for this long, in ms. */
const CREASE_DELAY = 120

const MODES: Record<string, number> = { zebra: 1, isophotes: 2, highlight: 3, reflection: 4 }

export interface Drawn {
  key: string
  name: string
  object: string
  kind: string
  stale: string
  colour: number[]
  hue: number
  origin: Vector3
  position: Float32Array
  normal: Float32Array | null
  triangle: Uint32Array
  edge: Uint32Array
  rim: Uint32Array
  field: Float32Array | null
  components: number
  group: Group
  geometry: BufferGeometry
  mesh: Mesh | null
  lines: {
    edge: LineSegments | null
    rim: LineSegments2 | null
    crease: LineSegments2 | null
    curve: LineSegments2 | null
  }
  /** True where the sides of panels are no lines of the shape. */
  triangulated: boolean
  box: Box3
}

interface Met {
  item: Drawn
  hit: Hit
}

export interface Picked {
  object: string
  kind: string
  point: Vector3
  value?: number[]
}

export class View {
  /** The camera of the turned view, and those of the three standard views beside it. */
  private readonly cameras = [new Camera(), new Camera(), new Camera(), new Camera()]
  /** The view that the hand is in. */
  private active = 0
  private manifold = false
  readonly items = new Map<string, Drawn>()
  readonly canvas: HTMLCanvasElement
  style: Style = 'shaded'
  paint: Paint = 'patches'
  fieldScale: Scale | null = null
  /** Ends of the scale that a person has set. */
  fixed: { low: number; high: number } | null = null
  mirror = true
  layers: Record<string, boolean> = {
    patch: true,
    curve: true,
    point: true,
    wire: true,
    contour: true,
    grid: true,
    frame: true,
  }
  hidden = new Set<string>()
  selected = ''
  hovered = ''
  onFrame: () => void = () => {}
  /** Picture points at the top that are covered. */
  covered: () => number = () => 0
  /** The axes across which the model is mirrored, and whether it floats at z = 0. */
  mirrored = ''
  afloat = false
  private readonly renderer: WebGLRenderer
  private readonly scene = new Scene()
  private readonly model = new Group()
  private readonly image = new Group()
  private readonly extras = new Group()
  private readonly others = new Group()
  private readonly cut = new Group()
  /** The hatched face of a section. */
  readonly cap: Cap
  /** Water and grid: nothing of the model. */
  readonly ground = new Ground()
  private readonly cloud: Points
  private dotItems: Drawn[] = []
  private readonly resolution = new Vector2(1, 1)
  private readonly uniforms = {
    mode: { value: 0 },
    towards: { value: new Vector3() },
    upward: { value: new Vector3() },
    right: { value: new Vector3() },
    lit: { value: 1 },
    centre: { value: new Vector3() },
    size: { value: 1 },
    stripes: { value: 16 },
  }
  private readonly materials = new Map<string, ShaderMaterial>()
  private readonly lineMaterials = new Map<string, LineMaterial | LineBasicMaterial>()
  private dark = false
  private queued = false
  private bounds = new Box3()
  clip: { axis: number; value: number; flip: boolean } | null = null
  readonly silent = new URLSearchParams(location.search).has('norender')

  constructor(private readonly host: HTMLElement) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, stencil: true, preserveDrawingBuffer: true })
    this.canvas = this.renderer.domElement
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio))
    host.append(this.canvas)
    this.cap = new Cap(this.renderer.getPixelRatio())
    this.scene.add(this.model, this.image, this.extras, this.others, this.cut, this.cap.group, this.ground.group)
    const material = new ShaderMaterial({
      uniforms: { pixels: { value: 7 * this.renderer.getPixelRatio() } },
      vertexShader: DOT_VERTEX,
      fragmentShader: DOT_FRAGMENT,
    })
    this.cloud = new Points(new BufferGeometry(), material)
    this.cloud.frustumCulled = false
    this.scene.add(this.cloud)
    new ResizeObserver(() => this.resize()).observe(host)
    this.resize()
    this.canvas.addEventListener('webglcontextlost', (event) => event.preventDefault())
    this.canvas.addEventListener('webglcontextrestored', () => this.draw())
  }

  private resize(): void {
    const [w, h] = [Math.max(1, this.host.clientWidth), Math.max(1, this.host.clientHeight)]
    this.renderer.setSize(w, h, false)
    this.resolution.set(w, h)
    for (const m of this.lineMaterials.values()) if (m instanceof LineMaterial) m.resolution.copy(this.resolution)
    this.draw()
  }

  /** The camera of the view that the hand is in. */
  get camera(): Camera {
    return this.cameras[this.active]
  }

  /** Whether profile, body plan and plan are seen beside the turned view. */
  get four(): boolean {
    return this.manifold
  }

  set four(on: boolean) {
    this.manifold = on
    this.host.classList.toggle('four', on)
    this.active = 0
    this.cameras[1].look('profile')
    this.cameras[2].look('body')
    this.cameras[3].look('plan')
    this.fit()
  }

  private get panes(): Pane[] {
    return panes(this.resolution.x, this.resolution.y, this.manifold)
  }

  private get pane(): Pane {
    return this.panes[this.active]
  }

  /** The hand is in the view at a place of the picture from now on. */
  enter(x: number, y: number): void {
    const at = this.panes.findIndex((p) => x >= p.left && x < p.left + p.width && y >= p.top && y < p.top + p.height)
    if (at >= 0) this.active = at
  }

  /** The middle of the view that the hand is in. */
  get middle(): [number, number] {
    const { left, top, width, height } = this.pane
    return [left + width / 2, top + height / 2]
  }

  /** The height of the view that the hand is in, in picture points. */
  get height(): number {
    return this.pane.height
  }

  /** Takes what is new in a frame; true when there was something. */
  take(frame: Frame): boolean {
    const { head } = frame
    if (head.mirror !== undefined) this.mirrored = head.mirror
    for (const key of head.removed ?? []) this.remove(JSON.stringify(key))
    if (head.all) {
      const kept = new Set((head.items ?? []).map((item: any) => JSON.stringify(item.key)))
      for (const key of [...this.items.keys()]) if (!kept.has(key)) this.remove(key)
    }
    for (const item of head.items ?? []) this.put(frame, item)
    if (!head.items && !head.all && head.mirror === undefined) return false
    this.settle()
    this.crease()
    return true
  }

  private put(frame: Frame, head: any): void {
    const key = JSON.stringify(head.key)
    let item = this.items.get(key)
    if (!item) {
      item = {
        key,
        name: head.name,
        object: head.object,
        kind: head.kind,
        stale: '',
        colour: [],
        hue: 0,
        origin: new Vector3(),
        position: new Float32Array(),
        normal: null,
        triangle: new Uint32Array(),
        edge: new Uint32Array(),
        rim: new Uint32Array(),
        field: null,
        components: 1,
        group: new Group(),
        geometry: new BufferGeometry(),
        mesh: null,
        lines: { edge: null, rim: null, crease: null, curve: null },
        triangulated: false,
        box: new Box3(),
      }
      this.items.set(key, item)
    }
    Object.assign(item, { object: head.object, stale: head.stale, colour: head.colour, hue: head.hue })
    item.origin.fromArray(head.origin)
    const parts: Record<string, Part> = {}
    for (const part of head.parts as Part[]) parts[part.role] = part
    const moved = !!parts.position
    const turned = !!parts.triangle
    if (moved) {
      item.position = frame.floats(parts.position)
      item.normal = parts.normal ? frame.floats(parts.normal) : null
    }
    if (turned) {
      item.triangle = frame.numbers(parts.triangle)
      item.edge = frame.numbers(parts.edge)
      item.rim = frame.numbers(parts.rim)
      item.field = null
    }
    if (moved || turned) this.shape(item, turned)
  }

  private shape(item: Drawn, turned: boolean): void {
    item.group.position.copy(item.origin)
    item.box.setFromArray(item.position as unknown as number[]).translate(item.origin)
    if (item.kind === 'point') return
    const g = item.geometry
    const old = g.getAttribute('position') as BufferAttribute | undefined
    const set = (name: string, data: Float32Array) => {
      const attribute = g.getAttribute(name) as BufferAttribute | undefined
      if (attribute && attribute.count * 3 === data.length) {
        ;(attribute.array as Float32Array).set(data)
        attribute.needsUpdate = true
      } else g.setAttribute(name, new BufferAttribute(new Float32Array(data), 3))
    }
    const resized = turned || !old || old.count * 3 !== item.position.length
    if (resized) {
      g.dispose()
      g.deleteAttribute('tint')
    }
    set('position', item.position)
    if (item.normal) set('normal', item.normal)
    g.boundingSphere = null
    g.boundingBox = null
    if (item.kind === 'patch') {
      if (resized) {
        g.setIndex(new BufferAttribute(item.triangle, 1))
        for (const o of [item.mesh, item.lines.edge, item.lines.rim, item.lines.crease]) if (o) item.group.remove(o)
        item.lines.crease = null
        item.triangulated = isTriangulation(item.triangle, item.edge, item.rim)
        item.mesh = new Mesh(g, this.material('', 0, 1))
        const edges = new BufferGeometry()
        edges.setAttribute('position', g.getAttribute('position'))
        edges.setIndex(new BufferAttribute(item.edge, 1))
        item.lines.edge = new LineSegments(edges, this.line('edge') as LineBasicMaterial)
        item.lines.rim = this.fat(item.rim, item.position, 'rim')
        item.group.add(item.mesh, item.lines.edge, item.lines.rim)
      } else {
        if (item.lines.edge) item.lines.edge.geometry.boundingSphere = null
        this.refat(item.lines.rim!, item.rim, item.position)
      }
      if (item.triangulated) this.uncreased.add(item)
    } else if (resized || !item.lines.curve) {
      if (item.lines.curve) item.group.remove(item.lines.curve)
      item.lines.curve = this.fat(item.edge, item.position, item.kind)
      item.group.add(item.lines.curve)
    } else this.refat(item.lines.curve, item.edge, item.position)
    if (!item.group.parent) this.model.add(item.group)
  }

  /** Edges of triangulations wait until nothing moves: they are looked for among all sides. */
  private readonly uncreased = new Set<Drawn>()
  private creasing = 0
  private crease(): void {
    clearTimeout(this.creasing)
    if (!this.uncreased.size) return
    this.creasing = window.setTimeout(() => {
      for (const item of this.uncreased) {
        if (!this.items.has(item.key)) continue
        if (item.lines.crease) item.group.remove(item.lines.crease)
        item.lines.crease = this.fat(creases(item.position, item.triangle, item.edge), item.position, 'rim')
        item.group.add(item.lines.crease)
      }
      this.uncreased.clear()
      this.settle()
    }, CREASE_DELAY)
  }

  private segments(index: Uint32Array, position: Float32Array): Float32Array {
    const flat = new Float32Array(3 * index.length)
    for (let k = 0; k < index.length; k++) flat.set(position.subarray(3 * index[k], 3 * index[k] + 3), 3 * k)
    return flat
  }

  private fat(index: Uint32Array, position: Float32Array, kind: string): LineSegments2 {
    const geometry = new LineSegmentsGeometry()
    geometry.setPositions(this.segments(index, position))
    const lines = new LineSegments2(geometry, this.line(kind) as LineMaterial)
    lines.frustumCulled = false
    return lines
  }

  private refat(lines: LineSegments2, index: Uint32Array, position: Float32Array): void {
    const at = lines.geometry.getAttribute('instanceStart') as any
    const flat = this.segments(index, position)
    if (at && at.data.array.length === flat.length) {
      at.data.array.set(flat)
      at.data.needsUpdate = true
    } else lines.geometry.setPositions(flat)
  }

  private remove(key: string): void {
    const item = this.items.get(key)
    if (!item) return
    item.group.removeFromParent()
    item.geometry.dispose()
    this.items.delete(key)
  }

  private material(name: string, grey: number, opacity: number, tint = 0, colour = ink('neutral')): ShaderMaterial {
    const key = `${name}|${grey}|${opacity}|${tint}|${colour}`
    let found = this.materials.get(key)
    if (!found) {
      found = new ShaderMaterial({
        uniforms: {
          ...this.uniforms,
          colour: { value: new Color(...hex(colour)) },
          tinted: { value: tint },
          grey: { value: grey },
          opacity: { value: opacity },
        },
        vertexShader: VERTEX,
        fragmentShader: FRAGMENT,
        side: DoubleSide,
        clipping: true,
        transparent: opacity < 1,
        depthWrite: opacity >= 1,
        polygonOffset: true,
        polygonOffsetFactor: 1,
        polygonOffsetUnits: 1,
      })
      this.materials.set(key, found)
    }
    return found
  }

  private line(kind: string): LineMaterial | LineBasicMaterial {
    let found = this.lineMaterials.get(kind)
    if (!found) {
      const widths: Record<string, number> = {
        rim: 1.4,
        curve: 1.6,
        wire: 2.4,
        contour: 1.4,
        grid: 1,
        frame: 1.6,
        chosen: 3,
        hover: 2.6,
        extra: 1.4,
        stale: 1.2,
        foreign: 0.8,
      }
      if (kind === 'edge' || kind === 'ghost')
        found = new LineBasicMaterial({ transparent: true, opacity: kind === 'edge' ? 0.22 : 0.5 })
      else found = new LineMaterial({ linewidth: widths[kind] ?? 1.4 })
      if (found instanceof LineMaterial) found.resolution.copy(this.resolution)
      this.lineMaterials.set(kind, found)
      this.ink()
    }
    return found
  }

  /** The colour of a kind of lines in this theme. */
  private inkOf(kind: Line): number {
    return ink(`line-${kind}${this.dark ? '-dark' : ''}`)
  }

  /** Colours of lines for the theme. */
  private ink(): void {
    const inks: Record<string, number> = {
      edge: this.inkOf('edge'),
      rim: this.inkOf('rim'),
      curve: this.inkOf('spline'),
      wire: this.inkOf('wire'),
      contour: this.inkOf('contour'),
      grid: this.inkOf('grid'),
      frame: this.inkOf('box'),
      chosen: ink('chosen'),
      hover: ink('hover'),
      extra: ink('cut'),
      stale: this.inkOf('stale'),
      foreign: this.inkOf('foreign'),
      ghost: this.inkOf('ghost'),
    }
    for (const [kind, m] of this.lineMaterials) m.color.set(inks[kind] ?? this.inkOf('box'))
  }

  theme(dark: boolean): void {
    this.dark = dark
    this.cap.theme(dark)
    this.ink()
    this.settle()
  }

  /** Materials, sight and images follow from the state. */
  settle(): void {
    this.uniforms.mode.value = MODES[this.paint] ?? 0
    this.uniforms.lit.value = this.paint === 'field' ? 0.55 : this.paint in MODES ? 0.25 : 1
    this.bounds.makeEmpty()
    this.dotItems = []
    const opacity = this.style === 'xray' ? 0.18 : 1
    for (const item of this.items.values()) {
      const seen = this.seen(item)
      item.group.visible = seen
      if (seen) this.bounds.union(item.box)
      if (item.kind === 'point') {
        if (seen && this.kept(item)) this.dotItems.push(item)
        continue
      }
      const marked = item.object === this.selected ? 'chosen' : item.object === this.hovered ? 'hover' : ''
      const grey = item.stale ? 0.85 : 0
      if (item.mesh) {
        const tinted = this.paint === 'field' && item.field ? 1 : 0
        const own = (item.colour[0] << 16) | (item.colour[1] << 8) | item.colour[2]
        const colour =
          this.paint === 'field' ? ink('neutral') : this.paint === 'model' ? own : HUES[item.hue % HUES.length]
        if (!item.geometry.getAttribute('tint'))
          item.geometry.setAttribute('tint', new BufferAttribute(new Float32Array(item.position.length), 3))
        item.mesh.material = this.material('', grey, opacity, tinted, colour)
        item.mesh.visible = this.style !== 'wire'
        const panels = this.style === 'panels' || this.style === 'wire'
        item.lines.edge!.visible = panels || (this.style !== 'smooth' && !item.triangulated)
        if (item.lines.crease) {
          item.lines.crease.visible = this.style !== 'smooth' && !this.uncreased.has(item)
          item.lines.crease.material = this.line(marked || 'rim') as LineMaterial
        }
        item.lines.edge!.material = this.line('edge') as LineBasicMaterial
        item.lines.rim!.visible = this.style !== 'smooth' || !!marked
        item.lines.rim!.material = this.line(marked || 'rim') as LineMaterial
      } else if (item.lines.curve)
        item.lines.curve.material = this.line(marked || (item.stale ? 'stale' : item.kind)) as LineMaterial
    }
    ;(this.line('edge') as LineBasicMaterial).opacity = this.style === 'panels' || this.style === 'wire' ? 0.6 : 0.2
    this.placeDots()
    this.reflect()
    this.ground.follow(this.bounds, this.afloat, this.dark)
    this.draw()
  }

  seen(item: Drawn): boolean {
    return (this.layers[item.kind] ?? true) && !this.hidden.has(item.object)
  }

  /** Draws the points that a section keeps. */
  dots(): void {
    this.dotItems = [...this.items.values()].filter((i) => i.kind === 'point' && this.seen(i) && this.kept(i))
    this.placeDots()
    this.draw()
  }

  /** Whether a section keeps a point. */
  private kept(item: Drawn): boolean {
    const { clip } = this
    if (!clip) return true
    const x = item.position[clip.axis] + item.origin.getComponent(clip.axis)
    return (clip.flip ? 1 : -1) * (x - clip.value) >= 0
  }

  private placeDots(): void {
    const n = this.dotItems.length
    const usual = n > CROWD ? 0.65 : 1
    const [position, tint, big] = [new Float32Array(3 * n), new Float32Array(3 * n), new Float32Array(n)]
    this.dotItems.forEach((item, k) => {
      for (let c = 0; c < 3; c++) position[3 * k + c] = item.position[c] + item.origin.getComponent(c)
      const marked = item.object === this.selected || item.object === this.hovered
      tint.set(hex(marked ? ink('chosen') : this.inkOf(item.stale ? 'stale' : 'dot')), 3 * k)
      big[k] = marked ? 1.6 : usual
    })
    const g = this.cloud.geometry
    g.dispose()
    g.setAttribute('position', new BufferAttribute(position, 3))
    g.setAttribute('tint', new BufferAttribute(tint, 3))
    g.setAttribute('big', new BufferAttribute(big, 1))
  }

  /** The halves, or three quarters, that are not in the model. */
  private reflect(): void {
    this.image.clear()
    const planes = [0, 1, 2].filter((k) => this.mirrored.includes('xyz'[k]))
    this.image.visible = this.mirror && planes.length > 0
    if (!this.image.visible) return
    const own = this.bounds.clone()
    for (let which = 1; which < 1 << planes.length; which++) {
      const image = new Group()
      const box = own.clone()
      planes.forEach((axis, k) => {
        if (!((which >> k) & 1)) return
        image.scale.setComponent(axis, -1)
        const [low, high] = [box.min.getComponent(axis), box.max.getComponent(axis)]
        box.min.setComponent(axis, -high)
        box.max.setComponent(axis, -low)
      })
      this.twins(image)
      this.image.add(image)
      this.bounds.union(box)
    }
  }

  /** The signs of the coordinates of what is drawn: of the model itself, and of its mirror images. */
  images(): [number, number, number][] {
    const images = this.image.visible ? this.image.children : []
    return [[1, 1, 1], ...images.map((i) => i.scale.toArray())]
  }

  private twins(image: Group): void {
    for (const item of this.items.values()) {
      if (!item.group.visible || item.kind === 'point' || item.kind === 'frame') continue
      const twin = new Group()
      twin.position.copy(item.group.position)
      for (const child of item.group.children) {
        if (!child.visible || ((child as any).isLineSegments2 && item.kind === 'patch')) continue
        const copy = child.clone() as any
        twin.add(copy)
      }
      image.add(twin)
    }
  }

  /** Numbers at the vertices of patches, as colours. */
  field(frame: Frame, signed: boolean): void {
    const all: Float32Array[] = []
    for (const item of this.items.values()) item.field = null
    const sized: { item: Drawn; sizes: Float32Array }[] = []
    for (const part of (frame.head.field ?? []) as Part[]) {
      const item = this.items.get(JSON.stringify(part.key))
      if (!item) continue
      const values = frame.floats(part)
      if (values.length !== (item.position.length / 3) * part.components) continue
      item.field = new Float32Array(values)
      item.components = part.components
      const sizes = new Float32Array(values.length / part.components)
      for (let k = 0; k < sizes.length; k++) {
        if (part.components === 1) sizes[k] = values[k]
        else
          sizes[k] = Math.hypot(...Array.from({ length: part.components }, (_, c) => values[k * part.components + c]))
      }
      sized.push({ item, sizes })
      all.push(sizes)
    }
    this.fieldScale = { ...scale(all, signed), ...this.fixed }
    for (const { item, sizes } of sized) {
      const tint = new Float32Array(3 * sizes.length)
      for (let k = 0; k < sizes.length; k++) tint.set(coloured(sizes[k], this.fieldScale), 3 * k)
      item.geometry.setAttribute('tint', new BufferAttribute(tint, 3))
    }
    this.settle()
  }

  /** Arrows along a field of vectors, at some of the vertices: the longest is an eighth of the model. */
  arrows(): number[][] {
    const fielded = [...this.items.values()].filter((i) => i.field && i.components === 3 && i.group.visible)
    const total = fielded.reduce((n, i) => n + i.field!.length / 3, 0)
    const step = Math.max(1, Math.ceil(total / 600))
    let most = 0
    for (const i of fielded)
      for (let k = 0; k + 2 < i.field!.length; k += 3)
        most = Math.max(most, Math.hypot(i.field![k], i.field![k + 1], i.field![k + 2]))
    if (!(most > 0) || !Number.isFinite(most)) return []
    const factor = this.bounds.getSize(new Vector3()).length() / 8 / most
    const runs: number[][] = []
    for (const item of fielded) {
      for (let k = 0; k < item.field!.length / 3; k += step) {
        const from = new Vector3().fromArray(item.position, 3 * k).add(item.origin)
        const along = new Vector3().fromArray(item.field!, 3 * k).multiplyScalar(factor)
        const length = along.length()
        if (!(length > this.bounds.getSize(new Vector3()).length() * 2e-3)) continue
        const tip = from.clone().add(along)
        runs.push([...from.toArray(), ...tip.toArray()])
        // Two strokes of the head, across the direction of view.
        const across = along
          .clone()
          .cross(this.camera.towards)
          .normalize()
          .multiplyScalar(0.12 * length)
        const back = tip.clone().addScaledVector(along, -0.25)
        runs.push([...back.clone().add(across).toArray(), ...tip.toArray(), ...back.sub(across).toArray()])
      }
    }
    return runs
  }

  /** Meshes and points of other programs over the model, coloured by their distance from it. */
  foreign(
    all: {
      name: string
      position: Float32Array
      triangle: Uint32Array
      edge: Uint32Array
      deviation: Float32Array | null
    }[],
  ): Scale | null {
    this.others.clear()
    const known = all.map((o) => o.deviation).filter((d) => d !== null)
    const span = known.length ? scale(known, true) : null
    for (const one of all) {
      const g = new BufferGeometry()
      g.setAttribute('position', new BufferAttribute(one.position, 3))
      const tint = new Float32Array(one.position.length)
      for (let k = 0; k < tint.length / 3; k++)
        tint.set(one.deviation && span ? coloured(one.deviation[k], span) : [0.5, 0.5, 0.5], 3 * k)
      g.setAttribute('tint', new BufferAttribute(tint, 3))
      if (one.triangle.length) {
        g.setIndex(new BufferAttribute(one.triangle, 1))
        g.computeVertexNormals()
        this.others.add(new Mesh(g, this.material('', 0, 1, 1)))
      } else {
        g.setAttribute('color', new BufferAttribute(tint, 3))
        const points = new Points(
          g,
          new PointsMaterial({
            size: 7 * this.renderer.getPixelRatio(),
            sizeAttenuation: false,
            vertexColors: true,
            depthTest: false,
          }),
        )
        this.others.add(points)
      }
      if (one.edge.length) this.others.add(this.fat(one.edge, one.position, 'foreign'))
    }
    this.draw()
    return span
  }

  /** Panels that lie in the model, coloured by numbers at their corners. */
  plane(
    of: { position: Float32Array; triangle: Uint32Array; edge: Uint32Array; value: Float32Array } | null,
  ): Scale | null {
    this.cut.clear()
    let span: Scale | null = null
    if (of) {
      span = scale([of.value], false)
      const g = new BufferGeometry()
      const tint = new Float32Array(of.position.length)
      for (let k = 0; k < of.value.length; k++) tint.set(coloured(of.value[k], span), 3 * k)
      g.setAttribute('position', new BufferAttribute(of.position, 3))
      g.setAttribute('tint', new BufferAttribute(tint, 3))
      g.setIndex(new BufferAttribute(of.triangle, 1))
      g.computeVertexNormals()
      const edges = new BufferGeometry()
      edges.setAttribute('position', g.getAttribute('position'))
      edges.setIndex(new BufferAttribute(of.edge, 1))
      this.cut.add(
        new Mesh(g, this.material('plane', 0, 1, 1)),
        new LineSegments(edges, this.line('edge') as LineBasicMaterial),
      )
    }
    this.draw()
    return span
  }

  /**
   * The place under a place of the picture where nothing is: on the plane of coordinates that is seen most squarely, through
   * the middle of what is seen, or the origin while that is near.
   */
  placeAt(x: number, y: number): Vector3 {
    const { ray } = this.ray(x, y)
    const facing = this.camera.towards.toArray().map(Math.abs)
    // The ground, unless it is seen too flatly.
    const axis = facing[2] > 0.3 ? 2 : facing.indexOf(Math.max(...facing))
    const level =
      Math.abs(this.camera.target.getComponent(axis)) < this.camera.reach ? 0 : this.camera.target.getComponent(axis)
    const along = (level - ray.origin.getComponent(axis)) / ray.direction.getComponent(axis)
    const place = ray.at(along, new Vector3())
    return place.setComponent(axis, level)
  }

  /** The place of a surface under a place of the picture, but not of an object. */
  surfaceAt(x: number, y: number, but: string): Picked | null {
    const { ray } = this.ray(x, y)
    const found = this.met(ray, [1, 1, 1], null, but)
    return found && { object: found.item.object, kind: found.item.kind, point: ray.at(found.hit.t, new Vector3()) }
  }

  /** The first patch that a ray meets, of those that are drawn; those of a mirror image by its signs. */
  private met(ray: Ray, signs: number[], before: Met | null, but = ''): Met | null {
    const turned = (v: Vector3) => v.toArray().map((x, c) => signs[c] * x) as [number, number, number]
    const [o, d] = [turned(ray.origin), turned(ray.direction)]
    const { clip } = this
    const kept = clip
      ? (t: number) =>
          (clip.flip ? 1 : -1) *
            (ray.origin.getComponent(clip.axis) + t * ray.direction.getComponent(clip.axis) - clip.value) >=
          0
      : undefined
    let best = before
    for (const item of this.items.values()) {
      if (item.kind !== 'patch' || !item.group.visible || !item.mesh?.visible || item.object === but) continue
      const from = o.map((x, c) => x - item.origin.getComponent(c)) as [number, number, number]
      const found = hit(item, from, d, best?.hit.t, kept)
      if (found) best = { item, hit: found }
    }
    return best
  }

  /** Curves and rims as they are now, in grey, while the hand moves them; once until it is taken away. */
  ghost(on: boolean): void {
    const old = this.extras.children.find((c) => c.name === 'ghost') as LineSegments | undefined
    if (on === !!old) return
    if (old) {
      old.geometry.dispose()
      this.extras.remove(old)
    } else {
      const all = [...this.items.values()].filter((i) => i.group.visible && i.kind !== 'point' && i.kind !== 'contour')
      const of = (i: Drawn) => (i.kind === 'patch' ? i.rim : i.edge)
      const flat = new Float32Array(3 * all.reduce((n, i) => n + of(i).length, 0))
      let at = 0
      for (const i of all)
        for (const v of of(i)) for (let c = 0; c < 3; c++) flat[at++] = i.position[3 * v + c] + i.origin.getComponent(c)
      const geometry = new BufferGeometry()
      geometry.setAttribute('position', new BufferAttribute(flat, 3))
      const lines = new LineSegments(geometry, this.line('ghost') as LineBasicMaterial)
      lines.name = 'ghost'
      lines.frustumCulled = false
      this.extras.add(lines)
    }
    this.draw()
  }

  /** Lines that are drawn besides: combs, sections, measures, arrows. */
  overlay(name: string, runs: number[][] | null, colour = ink('cut'), width = 1.5): void {
    const old = this.extras.children.find((c) => c.name === name)
    if (old) this.extras.remove(old)
    if (runs?.length) {
      const flat: number[] = []
      for (const run of runs) for (let k = 0; k + 5 < run.length; k += 3) flat.push(...run.slice(k, k + 6))
      if (flat.length) {
        const geometry = new LineSegmentsGeometry()
        geometry.setPositions(flat)
        const material = new LineMaterial({ linewidth: width, color: colour, depthTest: false, transparent: true })
        // A section takes nothing of what is drawn over the model.
        material.clipping = false
        material.resolution.copy(this.resolution)
        const lines = new LineSegments2(geometry, material)
        lines.name = name
        lines.frustumCulled = false
        this.extras.add(lines)
      }
    }
    this.draw()
  }

  /** The places of what is drawn besides under a name: ends of segments, three numbers each; null where nothing is. */
  drawnOver(name: string): number[] | null {
    const lines = this.extras.children.find((c) => c.name === name) as LineSegments2 | LineSegments | undefined
    if (!lines) return null
    if (!(lines instanceof LineSegments2)) return Array.from(lines.geometry.getAttribute('position').array)
    const ends = lines.geometry.getAttribute('instanceStart') as InterleavedBufferAttribute
    return Array.from(ends.data.array)
  }

  get box(): Box3 {
    return this.bounds
  }

  /** Shows all in what the bars over the picture leave free. */
  fit(): void {
    // The observer hears of a new size with the next frame only.
    this.resize()
    this.panes.forEach(({ top, width, height }, k) => {
      this.cameras[k].inset = Math.max(0, this.covered() - top) / height
      this.cameras[k].fit(this.bounds, width / height)
    })
    this.draw()
  }

  draw(): void {
    if (this.queued || this.silent) return
    this.queued = true
    requestAnimationFrame(() => {
      this.queued = false
      this.render()
    })
  }

  render(): void {
    if (!this.bounds.isEmpty()) {
      this.bounds.getCenter(this.uniforms.centre.value)
      this.uniforms.size.value = 0.25 * this.bounds.getSize(new Vector3()).length()
    }
    this.renderer.clippingPlanes = []
    if (this.clip) {
      const sign = this.clip.flip ? 1 : -1
      const normal = new Vector3().setComponent(this.clip.axis, sign)
      this.renderer.clippingPlanes = [new Plane(normal, -sign * this.clip.value)]
    }
    const { panes, resolution, renderer } = this
    renderer.setScissorTest(panes.length > 1)
    panes.forEach(({ left, top, width, height }, k) => {
      const camera = this.cameras[k]
      camera.aim(width / height, this.ground.within(this.bounds))
      this.uniforms.towards.value.copy(camera.towards)
      this.uniforms.upward.value.copy(camera.up)
      this.uniforms.right.value.copy(camera.right)
      renderer.setViewport(left, resolution.y - top - height, width, height)
      renderer.setScissor(left, resolution.y - top - height, width, height)
      renderer.render(this.scene, camera.three)
    })
    this.onFrame()
  }

  /** Where a place is in the picture, in CSS pixels. */
  project(p: Vector3): [number, number] {
    this.aim()
    return this.projected(p)
  }

  private aim(): void {
    const { width, height } = this.pane
    this.camera.aim(width / height, this.ground.within(this.bounds))
  }

  /** The same while the camera stays. */
  private projected(p: Vector3): [number, number] {
    const v = p.clone().project(this.camera.three)
    const { left, top, width, height } = this.pane
    return [left + (v.x * 0.5 + 0.5) * width, top + (-v.y * 0.5 + 0.5) * height]
  }

  ray(x: number, y: number): Raycaster {
    this.aim()
    const { left, top, width, height } = this.pane
    const caster = new Raycaster()
    caster.setFromCamera(new Vector2(((x - left) / width) * 2 - 1, 1 - ((y - top) / height) * 2), this.camera.three)
    return caster
  }

  place(item: Drawn): Vector3 {
    return new Vector3(item.position[0], item.position[1], item.position[2]).add(item.origin)
  }

  /** The point item nearest to a place of the picture, within a distance. */
  near(x: number, y: number, within: number, but = ''): Drawn | null {
    let best: Drawn | null = null
    let least = within
    this.aim()
    for (const item of this.dotItems) {
      if (item.object === but) continue
      const [px, py] = this.projected(this.place(item))
      const d = Math.hypot(px - x, py - y)
      if (d < least) [best, least] = [item, d]
    }
    return best
  }

  /** What is seen at a place of the picture: points before lines before patches. */
  pick(x: number, y: number): Picked | null {
    const point = this.near(x, y, 9)
    if (point) return { object: point.object, kind: point.kind, point: this.place(point) }
    const line = this.nearLine(x, y, 6)
    const { ray } = this.ray(x, y)
    let found: Met | null = null
    if (this.style !== 'wire') {
      for (const signs of this.images()) found = this.met(ray, signs, found)
    }
    if (line && (!found || line.depth <= found.hit.t * (1 + 1e-3) + 1e-9)) return line
    if (!found) return null
    const { item } = found
    let value: number[] | undefined
    if (item.field && this.paint === 'field') {
      const { field, components, triangle } = item
      const { at, weights } = found.hit
      value = Array.from({ length: components }, (_, c) =>
        weights.reduce((sum, w, k) => sum + w * field[triangle[at + k] * components + c], 0),
      )
    }
    return { object: item.object, kind: item.kind, point: ray.at(found.hit.t, new Vector3()), value }
  }

  private nearLine(x: number, y: number, within: number): (Picked & { depth: number }) | null {
    let best: (Picked & { depth: number }) | null = null
    let least = within
    const eye = this.ray(x, y).ray
    const { projectionMatrix, matrixWorldInverse } = this.camera.three
    const m = new Matrix4().multiplyMatrices(projectionMatrix, matrixWorldInverse).elements
    const { left, top, width, height } = this.pane
    const [w, h] = [width / 2, height / 2]
    for (const item of this.items.values()) {
      if (item.kind === 'patch' || item.kind === 'point' || item.kind === 'grid' || !item.group.visible) continue
      const { origin, position, edge } = item
      const flat = new Float64Array((2 * position.length) / 3)
      for (let k = 0; 3 * k < position.length; k++) {
        const [px, py, pz] = [
          position[3 * k] + origin.x,
          position[3 * k + 1] + origin.y,
          position[3 * k + 2] + origin.z,
        ]
        const scale = 1 / (m[3] * px + m[7] * py + m[11] * pz + m[15])
        flat[2 * k] = left + w + w * scale * (m[0] * px + m[4] * py + m[8] * pz + m[12])
        flat[2 * k + 1] = top + h - h * scale * (m[1] * px + m[5] * py + m[9] * pz + m[13])
      }
      for (let k = 0; k < edge.length; k += 2) {
        const [a, b] = [2 * edge[k], 2 * edge[k + 1]]
        const [dx, dy] = [flat[b] - flat[a], flat[b + 1] - flat[a + 1]]
        const t = Math.max(0, Math.min(1, ((x - flat[a]) * dx + (y - flat[a + 1]) * dy) / (dx * dx + dy * dy || 1)))
        const d = Math.hypot(flat[a] + t * dx - x, flat[a + 1] + t * dy - y)
        if (d < least) {
          least = d
          const at = (v: number) => new Vector3().fromArray(position, 3 * v).add(origin)
          const point = at(edge[k]).lerp(at(edge[k + 1]), t)
          best = { object: item.object, kind: item.kind, point, depth: eye.origin.distanceTo(point) }
        }
      }
    }
    return best
  }

  picture(): Promise<Blob | null> {
    this.render()
    return new Promise((resolve) => this.canvas.toBlob(resolve, 'image/png'))
  }
}
