// The requests of the engine by their kinds, and facts of its replies. Made by `crates/registry-derive/tests/protocol.rs`.

/** Options of a number that may change. */
export interface Adjusted {
  /** Weight of its change. */
  weight?: number
  /** The value from which changes are measured. */
  home?: number | null
}

/** The requests. Offsets in the text are UTF-16 units. */
export interface Requests {
  /** The complete state, for a new viewer. */
  open: Record<never, never>
  /** Changes since the last reply to this viewer. */
  sync: Record<never, never>
  /** Makes bodies exact that a change with `coarser` has made coarser. */
  settle: Record<never, never>
  /** Ends the viewer. */
  close: Record<never, never>
  /** Replaces the text. */
  text: {
    /** The text. */
    text: string
  }
  /** Replaces the text of a file beside the document. */
  text_beside: {
    /** The file's name, as in the fact `reads`. */
    name: string
    /** The text; without one the file counts again. */
    text?: string | null
  }
  /** The files that the text reads, directly or through other files. */
  reads: Record<never, never>
  /** Applies one or several change sets to the text. */
  splice: {
    /** Change sets of CodeMirror: lists of retained lengths and of `[removed, line, line ...]`. */
    changes: unknown[]
  }
  /** Sets parameters and numbers of objects without writing them to the text. */
  set: {
    /** Values by name. */
    values: Record<string, number>
  }
  /** Adjusts numbers by the least change that gives expressions the stated values, without writing them to the text. */
  solve_for: {
    /** Target values by expression. */
    targets: Record<string, number>
    /** Names of the numbers that may change. */
    by: Record<string, Adjusted>
  }
  /** Writes the set values to the text; the reply has the edits. */
  commit: Record<never, never>
  /** Reverts set values that are not written to the text. */
  reset: Record<never, never>
  /** Sets parameters and numbers of objects and writes them to the text; the reply has the edits. */
  write: {
    /** Values by name. */
    values: Record<string, number>
  }
  /** Starts a drag; the reply has the numbers that move the point. */
  drag_begin: {
    /** The object. */
    object: string
    /** Parameters of the point on the object: none for a point, t for a curve, u and v for a surface. */
    at?: number[]
  }
  /** Moves the dragged point as near to a target as possible. */
  drag_to: {
    /** The target position. */
    target: [number, number, number]
    /** Orthonormal vectors; only distances along these are minimised. */
    basis: [number, number, number][]
    /** Numbers to adjust in addition to the object's own; by default those that the motion requires. */
    names?: string[]
    /** Rounding unit of numbers, as a length, such as the size of a pixel. */
    grain?: number
  }
  /** Ends a drag; the reply has the edits. */
  drag_end: {
    /** False to revert the drag. */
    commit: boolean
  }
  /** Details of an object. */
  inspect: {
    /** Its name. */
    name: string
    /** A parameter with respect to which its numbers are differentiated. */
    by?: string | null
  }
  /** Expressions to watch; the reply has their values. */
  watch: {
    /** The expressions. */
    expressions: string[]
  }
  /** Values of the watched expressions. */
  measure: Record<never, never>
  /** Values of expressions, without watching them. */
  evaluate: {
    /** The expressions. */
    expressions: string[]
    /** A parameter with respect to which they are differentiated. */
    by?: string | null
  }
  /** Selects additional items of the scene. */
  show: {
    /** True to draw sections. */
    contours?: boolean | null
    /** Hidden objects to draw. */
    revealed?: string[] | null
  }
  /** A field at the vertices of all patches. */
  field: {
    /** A name of [`crate::FIELDS`], or `derivative`. */
    field: string
    /** The parameter of `derivative`. */
    by?: string | null
  }
  /** Curvature combs of curves. */
  combs: {
    /** The curves. */
    names: string[]
  }
  /** Volume blocks with their quality, folded cells, and one grid plane. */
  blocks: {
    /** The block of the grid plane, if one is requested. */
    block?: string | null
    /** The axis of constant index: 0, 1 or 2. */
    axis?: number
    /** The index, from 0. */
    index?: number
  }
  /** Lays a mesh or a table of points over the model; the reply has the overlays. */
  overlay: {
    /** File name; its extension gives the format. */
    name: string
    /** File content in base64. */
    data: string
  }
  /** Removes an overlay, or all; the reply has the remaining ones. */
  remove_overlay: {
    /** Its name; all without one. */
    name?: string | null
  }
  /** Distances of the overlays from the surfaces. */
  deviation: Record<never, never>
  /** The curve of immersed section areas along x. */
  section_areas: {
    /** Number of sections. */
    count: number
  }
  /** The lines plan on one sheet, as SVG. */
  lines_plan: {
    /** Its title. */
    title?: string
  }
  /** Closure and quality of the mesh. */
  mesh: Record<never, never>
  /** The hydrostatics. */
  hydrostatics: Record<never, never>
  /** Exports the model. */
  export: {
    /** Its name. */
    format: string
    /** File name without extension. */
    stem: string
  }
  /** The names of the formats. */
  formats: Record<never, never>
  /** Completions at an offset. */
  complete: {
    /** The offset. */
    offset: number
  }
  /** Description of the name at an offset. */
  hover: {
    /** The offset. */
    offset: number
  }
  /** Declaration of the name at an offset. */
  definition: {
    /** The offset. */
    offset: number
  }
  /** Declaration of an object. */
  locate: {
    /** Its name. */
    name: string
  }
  /** Edits that rename all uses of the name at an offset. */
  rename: {
    /** The offset. */
    offset: number
    /** The new name. */
    new: string
  }
  /** The kinds of objects, with their arguments. */
  kinds: Record<never, never>
  /** Inserts a statement; the reply has the edits. */
  add: {
    /** A statement that declares one object or parameter. */
    statement: string
  }
  /** Deletes an object and its statement; the reply has the edits. */
  delete: {
    /** Its name. */
    name: string
  }
  /** Copies the statement of an object; the reply has the edits and the new name. */
  duplicate: {
    /** The object. */
    name: string
  }
  /** Moves the statement of an object before that of another one; the reply has the edits. */
  reorder: {
    /** The object. */
    name: string
    /** The object beside which it comes. */
    beside: string
    /** True for behind it. */
    behind?: boolean
  }
  /** Renames an object and all its uses; the reply has the edits. */
  rename_object: {
    /** Its name. */
    name: string
    /** The new name. */
    new: string
  }
  /** The edit that formats the text. */
  format: Record<never, never>
  /** The words of the language, for highlighting. */
  words: Record<never, never>
  /** Does nothing; the reply shows that the engine is running. */
  ping: Record<never, never>
}

/** Offsets of a part of the text. */
export type TextRange = [number, number]

/** A parameter of the model. */
export interface ParamFact {
  /** Its name. */
  name: string
  /** Its value. */
  value: number
  /** The value that the text gives it. */
  default: number
  /** Its range. */
  range: [number, number] | null
  /** True for whole numbers. */
  whole: boolean
  /** True when the text, or a file beside it, has it as a number. */
  written: boolean
  /** Its declaration. */
  place: TextRange | null
}

/** State of an object. */
export type ObjectState = 'ok' | 'failed' | 'blocked'

/** An object of the model. */
export interface ObjectFact {
  /** Its name. */
  name: string
  /** Its kind. */
  kind: string
  /** The class of its value. */
  class: string
  /** Its state. */
  state: ObjectState
  /** True unless it is hidden by the text. */
  shown: boolean
  /** The names of the objects that it is made of. */
  parents: string[]
}

/** A correction of the text. */
export interface CorrectionFact {
  /** What is replaced. */
  place: TextRange
  /** The replacement. */
  insert: string
  /** Its title. */
  title: string
}

/** A diagnostic. */
export interface FaultFact {
  /** Stable name of the kind of fault. */
  id: string
  /** `error`, `warning` or `note`. */
  severity: string
  /** The message. */
  message: string
  /** Its place in the main text. */
  place: TextRange | null
  /** Its line, from 1. */
  line: number | null
  /** The file, if it is not the main one. */
  file: string | null
  /** Its place in that file. */
  elsewhere: TextRange | null
  /** Expected input. */
  expected: string | null
  /** Found input. */
  found: string | null
  /** Background. */
  notes: string[]
  /** Ways to fix it. */
  help: string[]
  /** The object at fault. */
  object: string | null
  /** A change of the main text that fixes it. */
  edit: CorrectionFact | null
}

/** A remark of the writer of a file. */
export interface RemarkFact {
  /** `error`, `warning` or `note`. */
  severity: string
  /** The message. */
  message: string
  /** What was expected and found, background and remedies. */
  help: string[]
  /** The object. */
  object: string | null
}

/** The value of an expression: a number, numbers, a text, the name of a class, or a summary of an array. */
export interface ValueFact {
  /** The expression. */
  expression: string
  /** Its value. */
  value?: unknown
  /** The reason why it has none. */
  error?: string
  /** Its derivative, if one was requested. */
  derivative?: unknown
  /** The reason why it has none. */
  no_derivative?: string
}

/** An argument of a kind, for a form. */
export interface ArgumentFact {
  /** Its name. */
  name: string
  /** A line of help. */
  help: string
  /** Its class. */
  class: string
  /** The classes of objects that it accepts. */
  accepts: string[]
  /** True for a list. */
  many: boolean
  /** Least length of a list. */
  least: number
  /** True without a default. */
  required: boolean
  /** Its default. */
  default: unknown
  /** The permitted words of a text. */
  words: string[]
}

/** A kind of objects. */
export interface KindFact {
  /** Its name. */
  name: string
  /** The class of its value. */
  class: string
  /** Its first sentence. */
  about: string
  /** Other words by which it is looked for. */
  also: string | null
  /** Its arguments. */
  fields: ArgumentFact[]
}

/** A change of the text. */
export interface EditFact {
  /** Where the replaced text begins. */
  from: number
  /** Where it ends. */
  to: number
  /** The replacement. */
  insert: string
}

/** A number of a parameter in a file beside the text, and its new value. */
export interface BesideFact {
  /** The parameter. */
  name: string
  /** The file. */
  file: string
  /** Where the number begins. */
  from: number
  /** Where it ends. */
  to: number
  /** What is there. */
  found: string
  /** The replacement. */
  insert: string
}

/** A number that moves a dragged point. */
export interface HandleFact {
  /** Its name. */
  name: string
  /** True for a number of the object itself. */
  own: boolean
  /** True for a parameter of the model. */
  parameter: boolean
  /** Derivative of the point by the number. */
  direction: [number, number, number]
  /** Its value. */
  value: number
  /** Its range. */
  range: [number, number] | null
}

/** A number that was adjusted to reach a target. */
export interface AdjustmentFact {
  /** Its name. */
  name: string
  /** Its value before. */
  before: number
  /** Its value now. */
  after: number
  /** Its fraction of the weighted change, 0 to 1. */
  share: number
}
