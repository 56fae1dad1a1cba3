import * as state from "../state";
import { Icon } from "./icons";

export function Notices() {
  return (
    <div class="notices" role="status" aria-live="polite">
      {state.notices.value.map((one) => (
        <div key={one.id} class={`notice ${one.kind}`}>
          {one.text}
          <button class="button icon plain" aria-label="Dismiss" onClick={() => state.dismiss(one.id)}>
            <Icon name="close" />
          </button>
        </div>
      ))}
    </div>
  );
}
