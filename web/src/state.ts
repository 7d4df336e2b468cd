// What the page knows of the model, and who wants to know when it changes.

export interface Param {
  name: string
  value: number
  default: number
  range: [number, number] | null
  whole: boolean
  written: boolean
  place: [number, number] | null
}

export interface Obj {
  name: string
  kind: string
  class: string
  state: 'ok' | 'failed' | 'blocked'
  shown: boolean
  parents: string[]
}

export interface Fault {
  id: string
  severity: 'error' | 'warning' | 'note'
  message: string
  place: [number, number] | null
  line: number | null
  file: string | null
  /** Its place in that file. */
  elsewhere: [number, number] | null
  expected: string | null
  found: string | null
  notes: string[]
  help: string[]
  object: string | null
  edit: { place: [number, number]; insert: string; title: string } | null
}

/** What the writer of a file has to say about it. */
export interface Remark {
  severity: Fault['severity']
  message: string
  help: string[]
  object: string | null
}

export interface Watched {
  expression: string
  value?: unknown
  error?: string
}

export const model = {
  name: 'model',
  params: [] as Param[],
  objects: [] as Obj[],
  /** The files that it reads, by their full names. */
  files: [] as string[],
  faults: [] as Fault[],
  printed: [] as string[],
  /** The last file that was made, and remarks about it. */
  made: { file: '', remarks: [] as Remark[] },
  watched: [] as Watched[],
  unit: '',
  program: true,
  /** Whether its hydrostatics mean something. */
  floats: false,
  rev: 0,
}

type Topic =
  | 'files'
  | 'shown'
  | 'params'
  | 'objects'
  | 'faults'
  | 'watched'
  | 'scene'
  | 'selection'
  | 'printed'
  | 'rev'
  | 'made'
const listeners = new Map<Topic, Set<() => void>>()

export function on(topics: Topic | Topic[], run: () => void): void {
  for (const topic of Array.isArray(topics) ? topics : [topics]) {
    if (!listeners.has(topic)) listeners.set(topic, new Set())
    listeners.get(topic)!.add(run)
  }
}

export function changed(topic: Topic): void {
  for (const run of listeners.get(topic) ?? []) run()
}
