import { expect, test } from 'vitest'
import { proof } from '../src/link'

test('a page proves itself as the server expects', async () => {
  // By Python: hmac.new(b"secret", b"8000 challenge", hashlib.sha256).hexdigest()
  expect(await proof('secret', '8000', 'challenge')).toBe(
    'd14a72cd7a8a55f1c08e12fc8a4f173189b1d185d418ee5fb521ef9fefc15da5',
  )
})
