// How the page is reached by an engine: a server's socket, an editor around the page, or what a file carries.

import { door, Host } from './host'
import { type Link, SocketLink, StillLink } from './link'
import { LivingLink, WorkerEngine } from './living'

export interface Connection {
  link: Link & { start(): Promise<void> }
  /** The editor that the page is inside of, if any: the text is there. */
  host: Host | null
  /** Whether a notebook's cell shows the page, which follows its text. */
  inCell: boolean
}

/** A server has an engine; a file carries its last scene, and an engine where the package has one. */
export function connected(onReady: () => void): Connection {
  const carried = document.getElementById('moldloft-model')
  if (!carried?.textContent) return { link: new SocketLink(), host: null, inCell: false }
  const { hello, frames, files, host: where, cell } = JSON.parse(carried.textContent)
  const inCell = cell === true
  const ready = () => {
    document.body.dataset.engine = 'ready'
    onReady()
  }
  const api = where ? door() : null
  if (api) {
    const host = new Host(api, hello, where)
    document.body.dataset.host = 'editor'
    host.link.onReady = ready
    return { link: host.link, host, inCell }
  }
  const bytes = (text: string) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer as ArrayBuffer
  const first: Record<string, ArrayBuffer> = Object.fromEntries(
    Object.entries(frames as Record<string, string>).map(([k, v]) => [k, bytes(v)]),
  )
  const part = (id: string) => document.getElementById(id)?.textContent ?? ''
  if (!document.getElementById('moldloft-worker')) return { link: new StillLink(hello, first), host: null, inCell }
  // A file may start a worker of a blob only.
  const make = () =>
    new Worker(URL.createObjectURL(new Blob([JSON.parse(part('moldloft-worker'))], { type: 'text/javascript' })))
  const beginning = async () => {
    // The engine comes last in the file: what is seen does not wait for it.
    if (document.readyState === 'loading')
      await new Promise((r) => document.addEventListener('DOMContentLoaded', r, { once: true }))
    return { packed: part('moldloft-engine'), name: hello.name, files }
  }
  const link = new LivingLink(hello, first.open ?? null, new WorkerEngine(make, beginning), !inCell)
  link.onReady = ready
  return { link, host: null, inCell }
}
