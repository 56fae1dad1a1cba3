import { markOf } from "../state";

/** The colour and shape of a model, beside its name. */
export function Swatch({ model }: { model: string }) {
  const { colour, shape } = markOf(model);
  return (
    <svg class="swatch" viewBox="0 0 10 10" aria-hidden="true">
      <path d={shape} fill={colour} fill-rule="evenodd" />
    </svg>
  );
}
