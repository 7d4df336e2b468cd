import { afterEach, beforeEach, expect, test, vi } from 'vitest'
import type { Link } from '../src/link'
import { Preview } from '../src/preview'
import { model } from '../src/state'

/** Requests, with their halvings, of an engine that takes some time for each. */
function engine(takes: (coarser: number) => number): { asked: [string, number][]; link: Link } {
  const asked: [string, number][] = []
  const ask = async (kind: string, fields: { coarser?: number } = {}) => {
    asked.push([kind, fields.coarser ?? 0])
    await new Promise((r) => setTimeout(r, takes(fields.coarser ?? 0)))
    return { head: {} }
  }
  return { asked, link: { ask } as unknown as Link }
}

beforeEach(() => {
  vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'performance'] })
  model.objects = [{ name: 'b', kind: 'SetBody' } as (typeof model.objects)[number]]
})
afterEach(() => void vi.useRealTimers())

async function moves(preview: Preview, count: number): Promise<void> {
  for (let k = 0; k < count; k++) {
    const done = preview.ask('set', { values: { r: k } })
    await vi.advanceTimersByTimeAsync(2000)
    await done
  }
}

test('a slow body is coarser until it follows, and settles once when the hand rests', async () => {
  const { asked, link } = engine((coarser) => 640 / 4 ** coarser)
  const preview = new Preview(link)
  for (let k = 0; k < 8; k++) {
    const done = preview.ask('set', { values: { r: k } })
    await vi.advanceTimersByTimeAsync(700)
    await done
    // The next comes at once.
    expect(asked.filter(([kind]) => kind === 'settle').length).toBeLessThanOrEqual(k)
  }
  expect(asked.filter(([kind]) => kind === 'set').at(-1)).toEqual(['set', 2])
  await vi.advanceTimersByTimeAsync(1000)
  const settled = asked.filter(([kind]) => kind === 'settle').length
  await vi.advanceTimersByTimeAsync(5000)
  expect(asked.filter(([kind]) => kind === 'settle')).toHaveLength(settled)
})

test('a quick body, and a model without bodies of sets, are never coarser', async () => {
  for (const takes of [1, 20, 40]) {
    const { asked, link } = engine(() => takes)
    await moves(new Preview(link), 5)
    expect(asked).toEqual(Array(5).fill(['set', 0]))
  }
  model.objects = []
  const { asked, link } = engine(() => 500)
  await moves(new Preview(link), 5)
  expect(asked).toEqual(Array(5).fill(['set', 0]))
})
