import { defineConfig } from 'vite'

const outDir = '../python/moldloft/workbench/page'

// One script and one style: the page of the server and the file of `export --html` are made of the same two.
const page = {
  base: '/',
  build: {
    target: 'es2022',
    outDir,
    emptyOutDir: true,
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 2000,
  },
}

// The worker that holds the engine of such a file: a script without imports, since a file may start no other.
const worker = {
  build: {
    target: 'es2022',
    outDir,
    emptyOutDir: false,
    lib: { entry: 'src/worker.ts', formats: ['iife'], name: 'worker', fileName: () => 'worker.js' },
  },
}

export default defineConfig(({ mode }) => (mode === 'worker' ? worker : page))
