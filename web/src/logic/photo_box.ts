// The box around the object in a photo: by the pointer or by keys.

/** x, y, width, height, px */
export type PhotoBox = readonly [number, number, number, number];
export interface Size {
  width: number;
  height: number;
}

/** px; a smaller object has no features. */
const MIN_SIDE = 12;
/** Of the longer side of the picture. */
const STEP = 0.02;

const clamp = (value: number, low: number, high: number) => Math.min(Math.max(value, low), Math.max(low, high));

/** Half of the picture, in its middle: what the keys begin with. */
export const middleBox = ({ width, height }: Size): PhotoBox =>
  [width / 4, height / 4, width / 2, height / 2].map(Math.round) as unknown as PhotoBox;

/**
 * The box after an arrow key: moved, or with another size (`isSize`); the first one makes the box. Null: the key does nothing.
 */
export function boxAfterKey(box: PhotoBox | null, key: string, isSize: boolean, size: Size): PhotoBox | null {
  const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[key];
  if (by === undefined) return null;
  if (box === null) return middleBox(size);
  const step = Math.max(1, Math.round(STEP * Math.max(size.width, size.height)));
  const [right, down] = by.map((one) => one * step) as [number, number];
  const [x, y, width, height] = box;
  if (isSize) return [x, y, clamp(width + right, MIN_SIDE, size.width - x), clamp(height + down, MIN_SIDE, size.height - y)];
  return [clamp(x + right, 0, size.width - width), clamp(y + down, 0, size.height - height), width, height];
}

/** The boxes for the server; null: no photo has one. Of a photo without a box, all of it is the object. */
export function boxesToSend(boxes: readonly (PhotoBox | null)[], sizes: readonly (Size | null)[]): number[][] | null {
  if (boxes.every((one) => one === null)) return null;
  const whole = boxes.map((one, i): readonly number[] | null => {
    const size = sizes[i];
    return one ?? (size ? [0, 0, size.width, size.height] : null);
  });
  return whole.some((one) => one === null) ? null : whole.map((one) => [...(one ?? [])]);
}
