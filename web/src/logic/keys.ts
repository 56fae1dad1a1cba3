// The keys of the page, in one table: what they do and what the help shows.

export interface KeyBinding {
  /** KeyboardEvent.key; letters in lower case */
  keys: readonly string[];
  label: string;
  what: string;
  group: "Review" | "Move" | "Video" | "Page";
}

export const BINDINGS = {
  next: { keys: ["j"], label: "J", what: "Next object", group: "Move" },
  previous: { keys: ["k"], label: "K", what: "Previous object", group: "Move" },
  nextMoment: { keys: ["l"], label: "L", what: "Next moment of the object", group: "Move" },
  previousMoment: { keys: ["h"], label: "H", what: "Previous moment of the object", group: "Move" },
  nextSighting: { keys: ["L", "]"], label: "Shift+L or ]", what: "Next sighting, frame by frame", group: "Move" },
  previousSighting: { keys: ["H", "["], label: "Shift+H or [", what: "Previous sighting", group: "Move" },
  accept: { keys: ["a"], label: "A", what: "Accept, and go on", group: "Review" },
  reject: { keys: ["x"], label: "X", what: "Reject, and go on", group: "Review" },
  reason: { keys: ["2", "3", "4", "5"], label: "2 to 5", what: "Why it was rejected, while the message stands", group: "Review" },
  note: { keys: ["n"], label: "N", what: "Write a note", group: "Review" },
  why: { keys: ["w"], label: "W", what: "Why it was found: its matches", group: "Review" },
  turn: { keys: ["t"], label: "T", what: "Turn the model, and show which of its views matched", group: "Review" },
  mark: { keys: ["m"], label: "M", what: "Mark for a decision together; Shift+click: from the last mark on", group: "Review" },
  unmark: { keys: ["M"], label: "Shift+M", what: "Take all marks back", group: "Review" },
  join: { keys: ["g"], label: "G", what: "Join the marked objects: they are one", group: "Review" },
  undo: { keys: ["u"], label: "U", what: "Take the last decision back", group: "Review" },
  play: { keys: [" "], label: "Space", what: "Play or pause", group: "Video" },
  frameBack: { keys: [",", "ArrowLeft"], label: ", or ←", what: "One frame back (Shift: ten)", group: "Video" },
  frameOn: { keys: [".", "ArrowRight"], label: ". or →", what: "One frame on (Shift: ten)", group: "Video" },
  box: { keys: ["b"], label: "B", what: "Box an object in the frame, to search for it or to follow it", group: "Video" },
  zoomIn: { keys: ["+", "="], label: "+ or wheel", what: "Zoom in, where the pointer is; a drag moves the frame", group: "Video" },
  zoomOut: { keys: ["-", "_"], label: "− or wheel", what: "Zoom out", group: "Video" },
  whole: { keys: ["0"], label: "0", what: "The whole frame", group: "Video" },
  native: { keys: ["1"], label: "1", what: "Native pixels: one of the video is one of the screen", group: "Video" },
  closeUp: { keys: ["Z"], label: "Shift+Z", what: "Zoom in to the selected object", group: "Video" },
  lens: { keys: ["z"], label: "Z", what: "Magnifier under the pointer", group: "Video" },
  full: { keys: ["f"], label: "F", what: "The video alone, in full screen", group: "Video" },
  hide: { keys: ["o"], label: "O held", what: "Hide boxes and names", group: "Video" },
  area: { keys: ["d"], label: "D", what: "Draw an area on the map, to filter by it", group: "Page" },
  measure: { keys: ["r"], label: "R", what: "Measure distances and areas on the map", group: "Page" },
  search: { keys: ["/"], label: "/", what: "Search and filter", group: "Page" },
  help: { keys: ["?"], label: "?", what: "Show these keys", group: "Page" },
  close: { keys: ["Escape"], label: "Esc", what: "Close, or leave a field", group: "Page" },
} as const satisfies Record<string, KeyBinding>;

export type Action = keyof typeof BINDINGS;

interface KeyPress {
  key: string;
  ctrlKey: boolean;
  metaKey: boolean;
  altKey: boolean;
}

/** The action of a key; null for a combination of the browser's or the system's. */
export function actionOf(press: KeyPress): Action | null {
  if (press.ctrlKey || press.metaKey || press.altKey) return null;
  // A capital letter is a binding of its own, or that of the letter.
  const isBound = Object.values(BINDINGS).some((one) => (one.keys as readonly string[]).includes(press.key));
  const key = press.key.length === 1 && !isBound ? press.key.toLowerCase() : press.key;
  // Shift changes these two on many keyboards; ten frames are asked for with it.
  const plain = key === "<" ? "," : key === ">" ? "." : key;
  for (const action of Object.keys(BINDINGS) as Action[]) {
    if ((BINDINGS[action].keys as readonly string[]).includes(plain)) return action;
  }
  return null;
}
