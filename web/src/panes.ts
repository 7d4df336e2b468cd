// The parts of the picture: one view, or the turned one with three standard views beside it.

export interface Pane {
  left: number
  top: number
  width: number
  height: number
}

/**
 * Where each view is, in picture points: the turned one first, at the lower right among four; then profile, body plan and
 * plan, the plan below the profile, so that stations stand over each other.
 */
export function panes(width: number, height: number, four: boolean): Pane[] {
  if (!four) return [{ left: 0, top: 0, width, height }]
  const [w, h] = [Math.floor(width / 2), Math.floor(height / 2)]
  const [right, below] = [width - w, height - h]
  return [
    { left: w, top: h, width: right, height: below },
    { left: 0, top: 0, width: w, height: h },
    { left: w, top: 0, width: right, height: h },
    { left: 0, top: h, width: w, height: below },
  ]
}
