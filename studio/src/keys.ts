// Keys: what each does, and the page that tells.

import { find } from "./dom";

export interface Key { key: string; what: string; press: () => void }

/** Listens for `keys`, unless somebody types or a dialog is open. */
export function listen(keys: Key[]): void {
  find("keyList").replaceChildren(...keys.flatMap(({ key, what }) => {
    const [name, told] = [document.createElement("dt"), document.createElement("dd")];
    name.innerHTML = "<kbd></kbd>";
    name.firstElementChild!.textContent = key === " " ? "space" : key.toUpperCase();
    told.textContent = what;
    return [name, told];
  }));
  addEventListener("keydown", (event) => {
    const typing = event.target instanceof HTMLElement && event.target.matches("select, input:not([type=range]):not([type=checkbox])");
    if (typing || event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    // Space on a button presses the button.
    if (event.key === " " && event.target instanceof HTMLElement && event.target.matches("button, a, input")) return;
    const found = keys.find(({ key }) => key === event.key.toLowerCase());
    if (!found || event.repeat) return;
    event.preventDefault();
    found.press();
  });
}
