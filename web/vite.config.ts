import { defineConfig } from "vitest/config";

// `npm run dev` serves the page from its sources, beside a running `victorious serve`.
const server = "http://127.0.0.1:8080";

export default defineConfig({
  base: "./",
  esbuild: { jsx: "automatic", jsxImportSource: "preact" },
  build: {
    target: "es2022",
    outDir: "../build/web",
    emptyOutDir: true,
    // MapLibre alone is larger than the usual limit.
    chunkSizeWarningLimit: 1500,
    rollupOptions: { output: { manualChunks: { map: ["maplibre-gl"] } } },
  },
  server: { proxy: { "/api": { target: server, changeOrigin: true, headers: { origin: server } } } },
  test: { include: ["src/**/*.test.ts"], environment: "node" },
});
