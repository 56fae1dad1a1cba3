// The marks of models: a colour, and where colours repeat another shape.

export interface Mark {
  colour: string;
  /** An SVG path in a square of 10. */
  shape: string;
}

// Okabe and Ito's colours, which people with any colour vision tell apart; a name stands beside each.
// Their sky blue is the accent of the page, and left out.
const COLOURS = ["#e69f00", "#00b98a", "#cc79a7", "#f0e442", "#d55e00", "#9f8cff", "#c2a878"] as const;

const SHAPES = [
  "M2.5 0.5h5a2 2 0 0 1 2 2v5a2 2 0 0 1-2 2h-5a2 2 0 0 1-2-2v-5a2 2 0 0 1 2-2z", // a square
  "M5 0.3 9.9 9.2H0.1z", // a triangle
  "M5 0.2a4.8 4.8 0 1 0 0 9.6 4.8 4.8 0 0 0 0-9.6zM5 3.2a1.8 1.8 0 1 1 0 3.6 1.8 1.8 0 0 1 0-3.6z", // a ring
  "M5 0 10 5 5 10 0 5z", // a diamond
  "M3.4 0.3h3.2v3.1h3.1v3.2H6.6v3.1H3.4V6.6H0.3V3.4h3.1z", // a cross
] as const;

/** Of the model at a place of the list, from 0; 35 differ. */
export function markAt(place: number): Mark {
  const at = Math.max(place, 0);
  return { colour: pick(COLOURS, at), shape: pick(SHAPES, Math.floor(at / COLOURS.length)) };
}

const pick = (all: readonly [string, ...string[]], at: number): string => all[at % all.length] ?? all[0];
