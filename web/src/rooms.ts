// The drawing board, the fairing desk and the studies: loaded when they are first shown.

import type { Board } from './board'
import type { Desk } from './desk'
import type { Editor } from './editor'
import type { Link } from './link'
import type { Studies, StudyActions } from './studies'

export type RoomName = 'board' | 'desk' | 'studies'

export class Rooms {
  private board: Promise<Board> | null = null
  private desk: Promise<Desk> | null = null
  private studies: Promise<Studies> | null = null
  private shown: RoomName | null = null
  /** Those that are there. */
  readonly loaded: { board?: Board; desk?: Desk; studies?: Studies } = {}

  constructor(
    private readonly stage: HTMLElement,
    private readonly link: Link,
    private readonly editor: Editor,
    /** The sketch that the board draws: the model itself, or a file that it reads. */
    private readonly sketch: () => Promise<Editor>,
    private readonly say: (words: string) => void,
    private readonly give: (blob: Blob, name: string) => void,
    private readonly studying: StudyActions,
  ) {}

  private place<R extends { element: HTMLElement }>(room: R): R {
    this.stage.append(room.element)
    return room
  }

  load(name: 'board'): Promise<Board>
  load(name: 'desk'): Promise<Desk>
  load(name: 'studies'): Promise<Studies>
  load(name: RoomName): Promise<Board | Desk | Studies>
  load(name: RoomName): Promise<Board | Desk | Studies> {
    if (name === 'board') {
      this.board ??= import('./board').then(async ({ Board }) => {
        this.loaded.board = this.place(new Board(this.link, await this.sketch(), this.say))
        return this.loaded.board
      })
      return this.board
    }
    if (name === 'studies') {
      this.studies ??= import('./studies').then(({ Studies }) => {
        this.loaded.studies = this.place(new Studies(this.link, this.studying))
        return this.loaded.studies
      })
      return this.studies
    }
    this.desk ??= import('./desk').then(({ Desk }) => {
      this.loaded.desk = this.place(new Desk(this.link, this.editor, this.say, this.give))
      return this.loaded.desk
    })
    return this.desk
  }

  /** Shows one room, or none. */
  async show(name: RoomName | null): Promise<void> {
    this.shown = name
    if (name) await this.load(name)
    if (name === 'board') (await this.load(name)).open(await this.sketch())
    // Meanwhile another one may have been chosen.
    if (this.board) (await this.board).show(this.shown === 'board')
    if (this.desk) (await this.desk).show(this.shown === 'desk')
    if (this.studies) (await this.studies).show(this.shown === 'studies')
  }

  /** The text is another one. */
  refresh(): void {
    void this.board?.then((b) => b.refresh())
  }
}
