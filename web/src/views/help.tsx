import { useEffect, useRef } from "preact/hooks";

import { BINDINGS } from "../logic/keys";
import * as state from "../state";
import { Icon } from "./icons";

const GROUPS = ["Review", "Move", "Video", "Page"] as const;

export function Help() {
  const dialog = useRef<HTMLDialogElement>(null);
  const isOpen = state.isHelpOpen.value;
  useEffect(() => {
    if (isOpen) dialog.current?.showModal();
    else dialog.current?.close();
  }, [isOpen]);
  return (
    <dialog class="help" ref={dialog} aria-labelledby="help-title" onClose={() => (state.isHelpOpen.value = false)}>
      <header>
        <h2 id="help-title">Keys</h2>
        <button class="button icon plain" aria-label="Close" onClick={() => (state.isHelpOpen.value = false)}>
          <Icon name="close" />
        </button>
      </header>
      <div class="groups">
        {GROUPS.map((group) => (
          <section key={group}>
            <h3>{group}</h3>
            <ul>
              {Object.values(BINDINGS)
                .filter((one) => one.group === group)
                .map((one) => (
                  <li key={one.label}>
                    {one.what} <kbd>{one.label}</kbd>
                  </li>
                ))}
            </ul>
          </section>
        ))}
      </div>
    </dialog>
  );
}
