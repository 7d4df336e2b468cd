// Elements made of names and texts: what comes from a model is only ever a text.

type Child = Node | string | number | null | undefined | false
type Attributes = Record<string, unknown>

export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag)
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || (value === false && !name.startsWith('aria-'))) continue
    if (name.startsWith('on') && typeof value === 'function')
      element.addEventListener(name.slice(2).toLowerCase(), value as EventListener)
    else if (name === 'class') element.className = String(value)
    else if (value === true && !name.startsWith('aria-')) element.setAttribute(name, '')
    else element.setAttribute(name, String(value))
  }
  element.append(
    ...(children.filter((c) => c !== null && c !== undefined && c !== false) as (Node | string)[]).map((c) =>
      typeof c === 'number' ? String(c) : c,
    ),
  )
  return element
}

const SVG = 'http://www.w3.org/2000/svg'

export function s(tag: string, attributes: Attributes = {}, ...children: (Node | string)[]): SVGElement {
  const element = document.createElementNS(SVG, tag)
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value))
  element.append(...children)
  return element
}

/** A number as a person reads it: six significant digits. */
export function shown(x: unknown, digits = 6): string {
  if (Array.isArray(x)) return `(${x.map((v) => shown(v, digits)).join(', ')})`
  if (typeof x !== 'number')
    return x === null || x === undefined ? '' : typeof x === 'object' ? listed(x as any, digits) : String(x)
  if (!Number.isFinite(x)) return String(x)
  if (x !== 0 && (Math.abs(x) >= 1e7 || Math.abs(x) < 1e-5)) return x.toExponential(digits - 2).replace(/\.?0+e/, 'e')
  return String(Number(x.toPrecision(digits))).replace('-', '−')
}

function listed(x: { shape?: string; first?: unknown[] }, digits: number): string {
  if (!x.first) return JSON.stringify(x)
  return `${x.shape ?? ''} ${x.first.map((v) => shown(v, digits)).join(', ')}…`
}

export function stored<T>(key: string, usual: T): T {
  try {
    const text = localStorage.getItem(`moldloft.${key}`)
    return text === null ? usual : (JSON.parse(text) as T)
  } catch {
    return usual
  }
}

export function store(key: string, value: unknown): void {
  try {
    localStorage.setItem(`moldloft.${key}`, JSON.stringify(value))
  } catch {
    // A page without storage forgets.
  }
}
