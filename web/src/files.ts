// Files and links that leave the page, and files that are dropped on it.

import type { App } from './app'
import { h } from './dom'
import { inBase64 } from './foreign'
import type { RemarkFact } from './protocol'
import { LONGEST_LINK, packed, unpacked } from './share'
import { changed, model } from './state'

/** Endings of programs and model files, whose text replaces the program. */
const PROGRAM = /\.(sdl|skt|ms2)$/i

/** Endings of CAD files, which are read by the server. */
const CAD = /\.(step|stp|stpz|iges|igs|3dm|brep|brp)$/i

/** Endings of files that are opened from an empty program. */
export const OPENED = '.sdl,.ms2,.step,.stp,.stpz,.iges,.igs,.3dm,.brep,.brp'

/** Endings of files that are laid over a model. */
const LAID = '.stl,.obj,.ply,.off,.gdf,.csv,.txt,.dat,.xyz,.step,.stp,.stpz,.iges,.igs,.3dm,.brep,.brp'

/** Formats that hold no surfaces. */
const FLAT = new Set(['svg', 'png', 'sdl', 'ms2'])

/** Offers a file for download. */
export function give(app: Pick<App, 'host'>, blob: Blob, name: string): void {
  if (app.host) return void app.host.give(blob, name)
  const a = h('a', { download: name })
  a.href = URL.createObjectURL(blob)
  a.click()
  setTimeout(() => URL.revokeObjectURL(a.href), 10_000)
}

/** Makes a file of the model in a format of the engine, or of the picture as it is seen. */
export async function download(app: App, kind: string): Promise<void> {
  try {
    const stem = model.name.replace(/\.\w+$/, '')
    if (kind === 'picture') {
      const blob = await app.view.picture()
      if (blob) give(app, blob, `${stem}.png`)
      return
    }
    app.shell.say(`Making ${kind}…`)
    await app.changes.settled()
    const frame = await app.link.ask('export', { format: kind, stem, values: app.changes.values })
    const names = frame.head.files.map((part: any) => {
      const name = String(part.name).split(/[/\\]/).pop() ?? stem
      give(app, new Blob([frame.bytes(part).slice()]), name)
      return name
    })
    const { mirrored } = app.view
    const half = mirrored && !FLAT.has(kind) ? `: the model's own side, which is mirrored in ${mirrored}` : ''
    const remarks: RemarkFact[] = frame.head.remarks ?? []
    model.made = { file: names[0] ?? kind, remarks }
    changed('made')
    const count = remarks.length === 1 ? 'a remark is' : `${remarks.length} remarks are`
    const more = remarks.length ? `; ${count} among the messages` : ''
    app.shell.say(names.length ? `${names.join(', ')} made${half}${more}` : `${kind}: the model has nothing to write`)
  } catch (error) {
    app.shell.say((error as Error).message)
  }
}

export async function copyLink(app: App): Promise<void> {
  try {
    const address = `${location.href.split('#')[0]}#${await packed({ name: model.name, text: app.editor.text })}`
    if (address.length > LONGEST_LINK) {
      const [is, may] = [address.length, LONGEST_LINK].map((n) => Math.ceil(n / 1000))
      return app.shell.say(`The link would have ${is} 000 characters, and may have ${may} 000: export the file instead`)
    }
    try {
      await navigator.clipboard.writeText(address)
      app.shell.say(`Link copied: ${address.length} characters hold the text, but not the files that it reads`)
    } catch {
      // Without leave to use the clipboard the address is shown, chosen.
      const field = h('input', { type: 'text', readonly: true, 'aria-label': 'link', size: 40 })
      field.value = address
      const close = h('button', { onclick: () => app.shell.warn('') }, 'Close')
      app.shell.warn('The link that holds the model: ', field, close)
      field.select()
    }
  } catch (error) {
    app.shell.say((error as Error).message)
  }
}

/** Takes the model of the address that the page was opened with, if it holds one: a step of the history. */
export async function openLink(app: App): Promise<void> {
  try {
    const held = await unpacked(location.hash)
    if (!held) return
    history.replaceState(null, '', location.pathname + location.search)
    if (held.text === app.editor.text || app.link.still) return
    const take = () => {
      app.editor.replace(held.text, false, false, `Open the link of ${held.name}`)
      app.shell.warn('')
    }
    const empty = app.editor.text.trim() === ''
    if (app.link.local || empty) return take()
    app.shell.warn(
      `The link holds ${held.name}. It replaces the program here; Ctrl+Z brings that back. `,
      h('button', { class: 'primary', onclick: take }, 'Open it'),
      h('button', { onclick: () => app.shell.warn('') }, 'Keep the program'),
    )
  } catch (error) {
    app.shell.warn((error as Error).message, h('button', { onclick: () => app.shell.warn('') }, 'Close'))
  }
}

/** A CAD file becomes the program where there is none yet; else its panels are laid over the model. */
async function openCad(app: App, name: string, bytes: Uint8Array): Promise<void> {
  if (app.link.local)
    return app.shell.say(`${name}: STEP and IGES files are read by moldloft view, not by a page in a file`)
  app.shell.say(`Reading ${name}…`)
  const request = { name, data: inBase64(name, bytes), units: model.unit || 'mm' }
  const frame = await app.link.ask('import', request)
  const remark = (message: string): RemarkFact => ({ severity: 'warning', message, help: [], object: null })
  model.made = { file: name, remarks: frame.head.remarks.map(remark) }
  changed('made')
  const take = () => {
    app.editor.replace(frame.head.text, false, false, `Open ${name}`)
    app.shell.warn('')
    app.shell.say(`${name} has replaced the program; Ctrl+Z brings it back`)
  }
  if (app.editor.text.trim() === '' && /\.sdl$/i.test(model.name)) return take()
  for (const part of frame.head.files) await app.foreign.lay(part.name, frame.bytes(part))
  if (!/\.sdl$/i.test(model.name)) return
  app.shell.warn(
    `${name} is laid over the model. `,
    h('button', { onclick: take }, 'Open it instead'),
    h('button', { onclick: () => app.shell.warn('') }, 'Close'),
  )
}

/** Lets a person choose files to lay over the model. */
export function chooseLaid(app: App): void {
  const input = h('input', { type: 'file', accept: LAID, multiple: true })
  input.addEventListener('change', () => openFiles(app, input.files))
  input.click()
}

/** Opens files one after the other. */
export function openFiles(app: App, files: Iterable<File> | null): void {
  let opening = Promise.resolve()
  for (const file of files ?? [])
    opening = opening.then(() => openFile(app, file)).catch((error) => app.shell.say((error as Error).message))
}

/** A file that was chosen or dropped: a program is opened, another one is laid over the model. */
async function openFile(app: App, file: File): Promise<void> {
  if (!PROGRAM.test(file.name)) {
    const bytes = new Uint8Array(await file.arrayBuffer())
    return CAD.test(file.name) ? openCad(app, file.name, bytes) : app.foreign.lay(file.name, bytes)
  }
  const ending = (name: string) => name.split('.').pop()!.toLowerCase()
  if (ending(file.name) !== ending(model.name))
    return app.shell.say(`${file.name} is another kind of model than ${model.name}: moldloft view ${file.name}`)
  const text = await file.text()
  app.editor.replace(text, false, false, `Open ${file.name}`)
  app.shell.say(`${file.name} has replaced the program; Ctrl+Z brings it back`)
}

export function installDrop(app: App, host: HTMLElement): void {
  host.addEventListener('dragover', (e) => {
    e.preventDefault()
    host.classList.add('dropping')
  })
  for (const end of ['dragleave', 'drop']) host.addEventListener(end, () => host.classList.remove('dropping'))
  host.addEventListener('drop', (e) => {
    e.preventDefault()
    if (!app.link.still) openFiles(app, e.dataTransfer?.files ?? null)
  })
}
