// The hatched face where a plane cuts material: closed lines are filled by the even-odd rule in the stencil.

import {
  AlwaysStencilFunc,
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  InvertStencilOp,
  KeepStencilOp,
  Mesh,
  NotEqualStencilFunc,
  ShaderMaterial,
  Vector3,
  ZeroStencilOp,
} from 'three'
import type { Cut } from './cut'

const VERTEX = 'void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }'
const HATCH = `
uniform vec3 paper; uniform vec3 ink; uniform float pixels;
void main() {
  float x = mod(gl_FragCoord.x + gl_FragCoord.y, 9.0 * pixels) / pixels;
  gl_FragColor = vec4(mix(ink, paper, smoothstep(0.5, 1.5, abs(x - 2.0))), 1.0);
}`

export class Cap {
  readonly group = new Group()
  private readonly fan: Mesh
  private readonly face: Mesh
  private readonly paint: ShaderMaterial

  constructor(pixels: number) {
    const parity = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: 'void main() { gl_FragColor = vec4(0.0); }',
      side: DoubleSide,
      colorWrite: false,
      depthWrite: false,
      depthTest: false,
      stencilWrite: true,
      stencilFunc: AlwaysStencilFunc,
      stencilZPass: InvertStencilOp,
      stencilWriteMask: 1,
    })
    this.paint = new ShaderMaterial({
      uniforms: { paper: { value: new Color() }, ink: { value: new Color() }, pixels: { value: pixels } },
      vertexShader: VERTEX,
      fragmentShader: HATCH,
      side: DoubleSide,
      stencilWrite: true,
      stencilRef: 0,
      stencilFunc: NotEqualStencilFunc,
      stencilFuncMask: 1,
      stencilFail: KeepStencilOp,
      stencilZFail: ZeroStencilOp,
      stencilZPass: ZeroStencilOp,
    })
    this.fan = new Mesh(new BufferGeometry(), parity)
    this.face = new Mesh(new BufferGeometry(), this.paint)
    // After everything that is opaque, so that what is before the face stays before it.
    this.fan.renderOrder = 1
    this.face.renderOrder = 2
    this.fan.frustumCulled = this.face.frustumCulled = false
    this.group.add(this.fan, this.face)
    this.group.visible = false
  }

  theme(dark: boolean): void {
    this.paint.uniforms.paper.value.setRGB(...(dark ? ([0.3, 0.27, 0.2] as const) : ([0.97, 0.93, 0.82] as const)))
    this.paint.uniforms.ink.value.setRGB(...(dark ? ([0.66, 0.6, 0.46] as const) : ([0.52, 0.4, 0.2] as const)))
  }

  /** Fills what closed lines enclose; `lift` moves the face out of the plane, into what is kept. */
  fill(of: Cut | null, axis = 0, lift = 0): void {
    const fan: number[] = []
    const low = new Vector3().setScalar(Infinity)
    const high = low.clone().negate()
    of?.closed.forEach((on, k) => {
      if (!on) return
      const [p, q] = [new Vector3().fromArray(of.segments, 6 * k), new Vector3().fromArray(of.segments, 6 * k + 3)]
      for (const x of [p, q]) {
        x.setComponent(axis, x.getComponent(axis) + lift)
        low.min(x)
        high.max(x)
      }
      fan.push(...(fan.length ? fan.slice(0, 3) : p.toArray()), ...p.toArray(), ...q.toArray())
    })
    this.group.visible = fan.length > 0
    if (!fan.length) return
    const put = (mesh: Mesh, flat: number[]) => {
      mesh.geometry.dispose()
      mesh.geometry.setAttribute('position', new BufferAttribute(new Float32Array(flat), 3))
    }
    put(this.fan, fan)
    const corners = [
      [0, 0],
      [1, 0],
      [1, 1],
      [0, 0],
      [1, 1],
      [0, 1],
    ].flatMap(([u, v]) => {
      const p = low.clone()
      if (u) p.setComponent((axis + 1) % 3, high.getComponent((axis + 1) % 3))
      if (v) p.setComponent((axis + 2) % 3, high.getComponent((axis + 2) % 3))
      return p.toArray()
    })
    put(this.face, corners)
  }
}
