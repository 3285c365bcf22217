// The few words in which the page is spoken to.

export const find = <T extends HTMLElement = HTMLElement>(id: string) => document.getElementById(id) as T;

export function button(text: string, press: () => void, pressed?: boolean): HTMLButtonElement {
  const made = document.createElement("button");
  made.textContent = text;
  if (pressed !== undefined) made.ariaPressed = String(pressed);
  made.onclick = press;
  return made;
}

/** Options of a list, with what they are called; left alone while they are the same. */
export function choices(select: HTMLSelectElement, options: [value: string, text: string][], chosen: string): void {
  const same = select.options.length === options.length
    && options.every(([value, text], i) => select.options[i]?.value === value && select.options[i]?.text === text);
  if (!same) select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
  select.value = chosen;
}

export const plain = (names: string[]): [string, string][] => names.map((name) => [name, name]);

/** "brows_up" as a person would say it. */
export const spoken = (name: string) => name.replaceAll("_", " ");

type Level = "info" | "error" | "busy";

/** Says something for a while; what keeps the person waiting stays until it is taken away. */
export function note(text: string, level: Level = "info"): HTMLElement {
  const line = document.createElement("p");
  line.className = level;
  line.textContent = text;
  // A dialog lies over everything that is not in it.
  (document.querySelector("dialog[open] .notes") ?? find("notes")).append(line);
  if (level !== "busy") setTimeout(() => line.remove(), level === "error" ? 9000 : 5000);
  return line;
}

/** A file the person chooses, or nothing. */
export function choose(accept: string): Promise<File | undefined> {
  const input = document.createElement("input");
  input.type = "file";
  input.accept = accept;
  return new Promise((told) => {
    input.onchange = () => told(input.files?.[0]);
    input.oncancel = () => told(undefined);
    input.click();
  });
}

/** A file's name, as the server takes it. */
export const tame = (name: string) => name.replace(/[^\w .()+-]/g, "_").replace(/^\W+/, "").slice(-90);

/** Brings something to the server, and says what is done meanwhile; what it answers, or nothing where
 *  it refuses, which is told. */
export async function bring<T>(address: string, body: BodyInit, meanwhile = ""): Promise<T | undefined> {
  const busy = meanwhile ? note(meanwhile, "busy") : undefined;
  try {
    const answer = await fetch(address, { method: "PUT", body });
    const said = (await answer.json()) as T & { error?: string };
    if (answer.ok) return said;
    note(said.error ?? "the server refused it", "error");
  } catch {
    note("the server could not be reached", "error");
  } finally {
    busy?.remove();
  }
  return undefined;
}

/** Has the browser save what is at an address. */
export function save(address: string): void {
  const link = document.createElement("a");
  link.href = address;
  link.download = "";
  link.click();
}
