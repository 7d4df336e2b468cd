// The camera: turntable about z, orthographic or perspective; the eye is far enough never to be inside.

import { type Box3, OrthographicCamera, PerspectiveCamera, Vector3 } from 'three'

export type Standard = 'iso' | 'profile' | 'starboard' | 'plan' | 'bottom' | 'body' | 'stern'

/** Azimuth of the eye from +x about z, and its elevation, in degrees. */
const STANDARD: Record<Standard, [number, number]> = {
  iso: [-128, 24],
  profile: [-90, 0],
  starboard: [90, 0],
  plan: [-90, 90],
  bottom: [-90, -90],
  body: [180, 0],
  stern: [0, 0],
}

const FIELD = 30

export class Camera {
  target = new Vector3()
  /** Half the height of what is seen at the target. */
  reach = 1
  azimuth = STANDARD.iso[0]
  elevation = STANDARD.iso[1]
  perspective = false
  /** The share of the picture's height, at its top, that is covered: what is looked at is in the middle of the rest. */
  inset = 0
  private readonly ortho = new OrthographicCamera()
  private readonly persp = new PerspectiveCamera(FIELD)

  get three(): OrthographicCamera | PerspectiveCamera {
    return this.perspective ? this.persp : this.ortho
  }

  look(view: Standard): void {
    ;[this.azimuth, this.elevation] = STANDARD[view]
    this.perspective = false
  }

  /** From the target to the eye. */
  get towards(): Vector3 {
    const [a, e] = [(this.azimuth * Math.PI) / 180, (this.elevation * Math.PI) / 180]
    return new Vector3(Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e))
  }

  get right(): Vector3 {
    const a = (this.azimuth * Math.PI) / 180
    return new Vector3(-Math.sin(a), Math.cos(a), 0)
  }

  get up(): Vector3 {
    return new Vector3().crossVectors(this.towards, this.right)
  }

  /** The length of a picture point at the target. */
  grain(height: number): number {
    return (2 * this.reach) / Math.max(1, height)
  }

  fit(box: Box3, aspect: number): void {
    if (box.isEmpty()) return
    box.getCenter(this.target)
    // One point has no size: it is looked at from as far as before.
    if (box.min.equals(box.max)) return
    const [right, up] = [this.right, this.up]
    const half = box.getSize(new Vector3()).multiplyScalar(0.5)
    const along = (v: Vector3) => Math.abs(v.x) * half.x + Math.abs(v.y) * half.y + Math.abs(v.z) * half.z
    this.reach = Math.max((1.12 * along(up)) / (1 - this.inset), (1.12 * along(right)) / aspect, 1e-9)
    if (this.perspective) this.reach = Math.max(this.reach, 0.6 * half.length())
  }

  orbit(dx: number, dy: number): void {
    this.azimuth = (this.azimuth - dx) % 360
    this.elevation = Math.max(-90, Math.min(90, this.elevation + dy))
  }

  pan(dx: number, dy: number, height: number): void {
    const grain = this.grain(height)
    this.target.addScaledVector(this.right, -dx * grain).addScaledVector(this.up, dy * grain)
  }

  /** Nearer by a factor; what is under (x, y), from the middle in picture points, stays there. */
  zoom(factor: number, x: number, y: number, height: number): void {
    const before = this.grain(height)
    this.reach = Math.max(1e-12, this.reach * factor)
    const moved = before - this.grain(height)
    const below = y - (this.inset * height) / 2
    this.target.addScaledVector(this.right, x * moved).addScaledVector(this.up, -below * moved)
  }

  /** The cameras of three for a picture of that shape; `box` is all that may be seen. */
  aim(aspect: number, box: Box3): void {
    const size = box.isEmpty() ? 1 : box.getSize(new Vector3()).length()
    const far = (box.isEmpty() ? 0 : box.getCenter(new Vector3()).distanceTo(this.target)) + size + this.reach
    const { towards, right, up } = this
    const distance = this.perspective ? this.reach / Math.tan((FIELD * Math.PI) / 360) : 2 * far
    for (const camera of [this.ortho, this.persp]) {
      camera.up.copy(up)
      camera.position.copy(this.target).addScaledVector(towards, distance)
      camera.matrix.makeBasis(right, up, towards)
      camera.quaternion.setFromRotationMatrix(camera.matrix)
      camera.setViewOffset(aspect, 1, 0, -this.inset / 2, aspect, 1)
    }
    Object.assign(this.ortho, {
      left: -this.reach * aspect,
      right: this.reach * aspect,
      top: this.reach,
      bottom: -this.reach,
    })
    Object.assign(this.ortho, { near: distance - 1.5 * far, far: distance + 1.5 * far })
    Object.assign(this.persp, { aspect, near: Math.max(distance - far, distance * 1e-3), far: distance + far })
    this.three.updateProjectionMatrix()
    this.three.updateMatrixWorld(true)
  }
}
