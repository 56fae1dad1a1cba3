// The track of an object that a user boxed, as `victorious track` writes it: JSON Lines, one sighting each.

export interface FollowedRow {
  frame: number;
  /** s */
  time_s: number;
  /** x, y, width, height, px */
  box: readonly [number, number, number, number];
}

export interface Followed {
  job: number;
  /** What it is, as the user said, or "box". */
  name: string;
  rows: readonly FollowedRow[];
  moments: readonly { first: number; last: number; frames: number }[];
  byFrame: ReadonlyMap<number, FollowedRow>;
}

/** s; a longer time out of sight ends a moment. */
const MAX_GAP = 1;

/** Rows by frame. Throws if a line is no sighting. */
export function readTrack(text: string): FollowedRow[] {
  return text
    .split("\n")
    .filter((line) => line.trim() !== "")
    .map((line) => {
      const { frame, time_s, box } = JSON.parse(line) as Record<keyof FollowedRow, unknown>;
      const isBox = Array.isArray(box) && box.length === 4 && box.every((one) => typeof one === "number");
      if (typeof frame !== "number" || typeof time_s !== "number" || !isBox) throw new Error("The track cannot be read.");
      return { frame, time_s, box: box as unknown as FollowedRow["box"] };
    })
    .sort((a, b) => a.frame - b.frame);
}

/** The title of a job is "NAME in VIDEO". */
export const nameOf = (title: string): string => title.replace(/ in .*$/, "");

/** When it was in sight. */
export function momentsOf(rows: readonly FollowedRow[]) {
  const moments: { first: number; last: number; frames: number }[] = [];
  for (const { time_s: time } of rows) {
    const last = moments.at(-1);
    if (last && time - last.last <= MAX_GAP) {
      last.last = time;
      last.frames++;
    } else moments.push({ first: time, last: time, frames: 1 });
  }
  return moments;
}
