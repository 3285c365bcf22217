import { defineConfig } from "vite";

export default defineConfig({
  base: "./",
  build: {
    outDir: "../src/mien/live/studio/page",
    emptyOutDir: true,
    chunkSizeWarningLimit: 900,
  },
  server: {
    // While the page is worked on: `mien studio --port 8765` beside `npm run dev`.
    proxy: {
      "/live": { target: "ws://127.0.0.1:8765", ws: true },
      "/characters": "http://127.0.0.1:8765",
      "/takes": "http://127.0.0.1:8765",
      "/videos": "http://127.0.0.1:8765",
    },
  },
});
