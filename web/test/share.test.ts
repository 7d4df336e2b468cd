import { expect, test } from 'vitest'
import { packed, unpacked } from '../src/share'

test('a link gives back what it was made of', async () => {
  const texts = ['', 'AbsPoint P(1, 2, 3);\n', '# Größe ≤ 5 µm 🚢\r\n\u2028</script>', 'x'.repeat(200_000)]
  for (const text of texts) {
    const fragment = await packed({ name: 'a b&c=d.sdl', text })
    expect(fragment).toMatch(/^m=[\w-]+$/)
    expect(await unpacked(`#${fragment}`)).toEqual({ name: 'a b&c=d.sdl', text })
  }
})

test('a program of a hundred lines is a link of less than half', async () => {
  const text = Array.from({ length: 100 }, (_, k) => `AbsPoint P${k}(${k}, ${(k * 7) % 11}, ${k / 8});`).join('\n')
  expect((await packed({ name: 'hull.sdl', text })).length).toBeLessThan(text.length / 2)
})

test('no link, and a damaged one', async () => {
  expect(await unpacked('')).toBeNull()
  expect(await unpacked('#t=token')).toBeNull()
  const whole = await packed({ name: 'a.sdl', text: 'AbsPoint P(1, 2, 3);' })
  for (const bad of [whole.slice(0, -4), 'm=', 'm=%%%', 'm=AAAA', `m=${btoa('{}')}`])
    await expect(unpacked(bad)).rejects.toThrow('damaged')
})
