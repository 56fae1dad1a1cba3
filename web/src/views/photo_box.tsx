// The photos of a new model, in each of which the object is boxed: what lies around it is not part of the model.
import { useEffect, useRef, useState } from "preact/hooks";

import { boxBetween, fit } from "../logic/overlay";
import { type PhotoBox, type Size, boxAfterKey } from "../logic/photo_box";

/** px */
const AREA = { width: 480, height: 300 };

export interface BoxedPhoto {
  /** Null: the browser cannot show it. */
  size: Size | null;
  /** A transparent background marks the object. */
  hasOutline: boolean;
  box: PhotoBox | null;
  /** The reader says that the object fills the photo. */
  isWhole: boolean;
}

/** Whether it is known of a photo what in it is the object. */
export const isMarked = (one: BoxedPhoto) => one.box !== null || one.isWhole || one.hasOutline || one.size === null;

/** Whether some pixel is transparent, of a small copy. */
function hasTransparency(picture: ImageBitmap): boolean {
  const copy = new OffscreenCanvas(64, 64);
  const context = copy.getContext("2d");
  if (!context) return false;
  context.drawImage(picture, 0, 0, 64, 64);
  const { data } = context.getImageData(0, 0, 64, 64);
  return data.some((value, i) => i % 4 === 3 && value < 128);
}

const shownSize = ({ width, height }: Size): Size => {
  const scale = Math.min(AREA.width / width, AREA.height / height);
  return { width: Math.max(1, Math.round(width * scale)), height: Math.max(1, Math.round(height * scale)) };
};

/** A photo in the size in which it is shown; what the browser cannot show stays without a size. */
async function readPhoto(file: File): Promise<{ photo: BoxedPhoto; picture: ImageBitmap | null }> {
  const full = await createImageBitmap(file).catch(() => null);
  if (full === null) return { picture: null, photo: { size: null, hasOutline: false, box: null, isWhole: false } };
  try {
    const size = { width: full.width, height: full.height };
    const { width, height } = shownSize(size);
    const picture = await createImageBitmap(full, { resizeWidth: width, resizeHeight: height, resizeQuality: "medium" });
    return { picture, photo: { size, hasOutline: hasTransparency(full), box: null, isWhole: false } };
  } finally {
    full.close();
  }
}

/** Reads photos one by one: of 200, only one is in memory in full. Their pictures are the caller's to close. */
export async function readPhotos(files: readonly File[], isOver: () => boolean): Promise<{ photo: BoxedPhoto; picture: ImageBitmap | null }[]> {
  const read = [];
  for (const file of files) {
    if (isOver()) break;
    read.push(await readPhoto(file));
  }
  return read;
}

function Photo({ name, picture, size, photo, change }: {
  name: string;
  picture: ImageBitmap;
  size: Size;
  photo: BoxedPhoto;
  change: (next: Partial<BoxedPhoto>) => void;
}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [drag, setDrag] = useState<readonly [number, number] | null>(null);
  const shown = { width: picture.width, height: picture.height };
  useEffect(() => {
    canvas.current?.getContext("2d")?.drawImage(picture, 0, 0);
  }, [picture]);
  /** On the page, the canvas may be smaller than its pixels. */
  const at = (event: PointerEvent): [number, number] => {
    const across = shown.width / Math.max(canvas.current?.clientWidth ?? 1, 1);
    return [event.offsetX * across, event.offsetY * across];
  };
  const percent = (part: number, of: number) => `${(100 * part) / of}%`;
  const { box } = photo;
  return (
    <div class="photo" style={{ aspectRatio: `${shown.width} / ${shown.height}`, maxWidth: `${shown.width}px` }}>
      <canvas
        ref={canvas}
        width={shown.width}
        height={shown.height}
        tabIndex={0}
        role="application"
        aria-label={`${name}: box the object. Arrow keys move the box, with Shift they size it`}
        onPointerDown={(event) => {
          if (event.button !== 0) return;
          canvas.current?.setPointerCapture(event.pointerId);
          setDrag(at(event));
        }}
        onPointerMove={(event) => {
          if (drag) change({ box: boxBetween(drag, at(event), size, fit(size.width, size.height, shown.width, shown.height)) as PhotoBox | null, isWhole: false });
        }}
        onPointerUp={() => setDrag(null)}
        onPointerCancel={() => setDrag(null)}
        onKeyDown={(event) => {
          const next = boxAfterKey(box, event.key, event.shiftKey, size);
          if (next === null) return;
          event.preventDefault();
          change({ box: next, isWhole: false });
        }}
      />
      {box && (
        <div
          class="photo-box"
          style={{ left: percent(box[0], size.width), top: percent(box[1], size.height), width: percent(box[2], size.width), height: percent(box[3], size.height) }}
        />
      )}
    </div>
  );
}

/** All photos of a model, one after the other. */
export function PhotoBoxes({ files, photos, pictures, change }: {
  files: readonly File[];
  photos: readonly BoxedPhoto[];
  pictures: readonly (ImageBitmap | null)[];
  change: (at: number, next: Partial<BoxedPhoto>) => void;
}) {
  const [at, setAt] = useState(0);
  const [photo, picture, name] = [photos[at], pictures[at], files[at]?.name ?? ""];
  if (!photo) return <p class="muted">Reading the photos</p>;
  const open = photos.filter((one) => !isMarked(one)).length;
  return (
    <div class="photo-boxes">
      {picture && photo.size ? (
        <>
          <p>{photo.hasOutline ? "Its transparent background marks the object." : "Draw a box around the object: what lies around it is not searched for."}</p>
          <Photo key={at} name={name} picture={picture} size={photo.size} photo={photo} change={(next) => change(at, next)} />
          {!photo.hasOutline && (
            <label class="check">
              <input
                type="checkbox"
                checked={photo.isWhole}
                onChange={(event) => change(at, { isWhole: event.currentTarget.checked, ...(event.currentTarget.checked ? { box: null } : {}) })}
              />
              The object fills the photo
            </label>
          )}
        </>
      ) : (
        <p class="muted">This browser cannot show {name}: all of the photo is taken as the object.</p>
      )}
      {photos.length > 1 && (
        <div class="photo-steps">
          <button type="button" class="button" disabled={at === 0} onClick={() => setAt(at - 1)}>
            Previous
          </button>
          <span class="muted" role="status">
            Photo {at + 1} of {photos.length}
            {open > 0 ? `, ${open} to box` : ""}
          </span>
          <button type="button" class="button" disabled={at === photos.length - 1} onClick={() => setAt(at + 1)}>
            Next
          </button>
        </div>
      )}
    </div>
  );
}
