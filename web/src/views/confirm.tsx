import { useEffect, useRef } from "preact/hooks";

import { question } from "../confirm";

/** A question before something is deleted; Cancel has the focus. */
export function ConfirmDialog() {
  const dialog = useRef<HTMLDialogElement>(null);
  const cancel = useRef<HTMLButtonElement>(null);
  const asked = question.value;
  useEffect(() => {
    if (!asked) return dialog.current?.close();
    dialog.current?.showModal();
    cancel.current?.focus();
  }, [asked]);
  // Told a moment after it has closed, when the next question may be asked.
  const close = () => {
    if (dialog.current?.open === false) question.value = null;
  };
  return (
    <dialog class="help confirm" ref={dialog} role="alertdialog" aria-labelledby="confirm-title" aria-describedby="confirm-text" onClose={close}>
      <h2 id="confirm-title">{asked?.title}</h2>
      <p id="confirm-text">{asked?.text}</p>
      <div class="actions">
        <button class="button" ref={cancel} onClick={() => (question.value = null)}>
          Cancel
        </button>
        <button
          class="button primary"
          onClick={() => {
            question.value = null;
            asked?.run();
          }}
        >
          {asked?.label}
        </button>
      </div>
    </dialog>
  );
}
