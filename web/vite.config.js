import { defineConfig } from 'vite'

// One script and one style: the page of the server and the file of `export --html` are made of the same two.
export default defineConfig({
  base: '/',
  build: {
    target: 'es2022',
    outDir: '../python/moldloft/workbench/page',
    emptyOutDir: true,
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 2000,
  },
})
