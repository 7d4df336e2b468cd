// The parts of the page that commands, keys and the toolbar act on.

import type { Analysis } from './analysis'
import type { BlockPlanes } from './blocks'
import type { Standard } from './camera'
import type { Changes } from './changes'
import type { SheetName } from './commands'
import type { Editor } from './editor'
import type { FileTabs } from './file_tabs'
import type { Foreign } from './foreign'
import type { Hands } from './hands'
import type { Host } from './host'
import type { Link } from './link'
import type { Making } from './making'
import type { Actions } from './panels'
import type { RoomName, Rooms } from './rooms'
import type { Saving } from './saving'
import type { SectionPlane } from './section'
import type { Shell } from './shell'
import type { OpenedBefore } from './start'
import type { View } from './view'

/** A tab over the picture. */
export type TabName = SheetName | RoomName

export interface App {
  shell: Shell
  link: Link
  host: Host | null
  view: View
  editor: Editor
  files: FileTabs
  hands: Hands
  making: Making
  analysis: Analysis
  section: SectionPlane
  foreign: Foreign
  planes: BlockPlanes
  rooms: Rooms
  actions: Actions & { hidden: Set<string>; selected: () => string }
  changes: Changes
  saving: Saving
  /** The formats of the engine: names, and what they hold. */
  formats: [string, string][]
  /** The models that were opened before. */
  recent: OpenedBefore[]
  reopen(path: string): void
  look(name: Standard): void
  sheet(name: TabName): Promise<void>
  /** Opens the palette with some words typed in it. */
  openPalette(words?: string): void
  download(kind: string): Promise<void>
  copyLink(): Promise<void>
  buildToolbar(): void
}
