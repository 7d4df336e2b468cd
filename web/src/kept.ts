// What the browser keeps for an address beside the small settings: pictures are too large for those.

const [BASE, TABLE] = ['moldloft', 'kept']

function within(mode: IDBTransactionMode, run: (table: IDBObjectStore) => IDBRequest): Promise<any> {
  return new Promise((resolve) => {
    // A page without storage forgets.
    const nothing = () => resolve(undefined)
    try {
      const opening = indexedDB.open(BASE, 1)
      opening.onupgradeneeded = () => opening.result.createObjectStore(TABLE)
      opening.onerror = opening.onblocked = nothing
      opening.onsuccess = () => {
        const base = opening.result
        const change = base.transaction(TABLE, mode)
        const asked = run(change.objectStore(TABLE))
        change.oncomplete = () => resolve(asked.result)
        change.onerror = change.onabort = nothing
        base.close()
      }
    } catch {
      nothing()
    }
  })
}

export const kept = <T>(key: string): Promise<T | undefined> => within('readonly', (table) => table.get(key))

/** Keeps a value under a key; without one the key is free again. */
export const keep = (key: string, value?: unknown): Promise<unknown> =>
  within('readwrite', (table) => (value === undefined ? table.delete(key) : table.put(value, key)))
