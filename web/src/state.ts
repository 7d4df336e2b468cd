// What the page knows of the model, and who wants to know when it changes.

import type { FaultFact, ObjectFact, ParamFact, RemarkFact, ValueFact } from './protocol'

export const model = {
  name: 'model',
  params: [] as ParamFact[],
  objects: [] as ObjectFact[],
  /** The files that it reads, by their full names. */
  files: [] as string[],
  faults: [] as FaultFact[],
  printed: [] as string[],
  /** The last file that was made, and remarks about it. */
  made: { file: '', remarks: [] as RemarkFact[] },
  watched: [] as ValueFact[],
  unit: '',
  program: true,
  /** Whether its hydrostatics mean something. */
  floats: false,
  /** The axes across which the model is mirrored. */
  mirror: '',
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
