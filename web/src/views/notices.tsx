import * as notices from "../notices";
import { Icon } from "./icons";

export function Notices() {
  return (
    <div class="notices" role="status" aria-live="polite">
      {notices.notices.value.map((one) => (
        <div key={one.id} class={`notice ${one.kind}`}>
          <span>{one.text}</span>
          {one.choices.length > 0 && (
            <span class="choices" role="group" aria-label="Reason">
              {one.choices.map((choice) => (
                <button key={choice.key} class="chip" aria-pressed={choice.isChosen} onClick={choice.run}>
                  <kbd>{choice.key}</kbd> {choice.label}
                </button>
              ))}
            </span>
          )}
          {one.actions.map((action) => (
            <button
              key={action.label}
              class="link"
              onClick={() => {
                if (action.keepsNotice !== true) notices.dismiss(one.id);
                action.run();
              }}
            >
              {action.label}
            </button>
          ))}
          <button class="button icon plain" aria-label="Dismiss" onClick={() => notices.dismiss(one.id)}>
            <Icon name="close" />
          </button>
        </div>
      ))}
    </div>
  );
}
