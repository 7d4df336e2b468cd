import { defineConfig } from 'vitest/config'

const outDir = '../python/moldloft/workbench/page'
const target = 'es2022'

// The page of the server: a base with the picture, the program's editor beside it, and rooms that are loaded when they are shown.
const page = {
  base: '/',
  build: {
    target,
    outDir,
    emptyOutDir: true,
    assetsInlineLimit: 0,
    cssCodeSplit: false,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 700,
    rolldownOptions: {
      output: {
        codeSplitting: {
          groups: [
            { name: 'editor', test: /node_modules[\\/](@codemirror|@lezer|@marijn|crelt|style-mod|w3c-keyname)[\\/]/ },
            { name: 'three', test: /node_modules[\\/]three[\\/]/ },
          ],
        },
      },
    },
  },
}

/** One script without imports: a file that is opened from the disk may start no other. */
const single = (entry, name) => ({
  build: {
    target,
    outDir,
    emptyOutDir: false,
    cssCodeSplit: false,
    lib: { entry: `src/${entry}`, formats: ['iife'], name, fileName: () => `${name}.js`, cssFileName: name },
  },
})

const modes = { worker: single('worker.ts', 'worker'), file: single('main.ts', 'page') }

export default defineConfig(({ mode }) => modes[mode] ?? { ...page, test: { include: ['test/**/*.test.ts'] } })
