// What workers do that share the videos of an index in a database: asked for while its panel is open, else now and then.
import { effect, signal } from "@preact/signals";

import { getCluster } from "./api/client";
import type { Cluster } from "./api/types";
import * as jobs from "./jobs";

const OPEN_MS = 3000;
const CLOSED_MS = 60_000;

/** null: the index is in a file, or not known yet. */
export const cluster = signal<Cluster | null>(null);
export const isOpen = signal(false);

let timer: ReturnType<typeof setTimeout> | undefined;

async function look() {
  clearTimeout(timer);
  try {
    const found = await getCluster();
    cluster.value = found.is_shared ? found : null;
    if (!found.is_shared) return;
  } catch {
    // The page says elsewhere that the server, or its database, is away.
  }
  clearTimeout(timer);
  timer = setTimeout(() => void look(), isOpen.peek() ? OPEN_MS : CLOSED_MS);
}

export function startWorkers() {
  void look();
}

export function toggle() {
  isOpen.value = !isOpen.value;
  if (isOpen.value) jobs.isOpen.value = false;
  void look();
}

// Both panels have the same place.
effect(() => {
  if (jobs.isOpen.value) isOpen.value = false;
});
