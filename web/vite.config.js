import { readFileSync } from 'node:fs'
import { defineConfig } from 'vitest/config'

const colours = JSON.parse(readFileSync(new URL('../python/moldloft/colours.json', import.meta.url), 'utf8'))

/** Colours of styles by their names in the one file of colours: var(--colour-NAME). */
const coloured = {
  name: 'colours',
  enforce: 'pre',
  transform(code, id) {
    if (!id.endsWith('.css')) return null
    return code.replace(/var\(--colour-([\w-]+)\)/g, (_, name) => {
      if (typeof colours[name] !== 'string') throw new Error(`${id}: no colour is called ${name}`)
      return colours[name]
    })
  },
}

const outDir = '../python/moldloft/workbench/page'
const target = 'es2022'

// The page of the server: a base with the picture, the program's editor beside it, and rooms that are loaded when they are shown.
const page = {
  plugins: [coloured],
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
  plugins: [coloured],
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
