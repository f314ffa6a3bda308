// Elements without markup: text is always text.

/// An element: el("p", {class: "hint", onclick: f}, "text", child).
export function el(name, attributes = {}, ...children) {
  return filled(document.createElement(name), attributes, children);
}

/// The same in SVG.
export function svg(name, attributes = {}, ...children) {
  return filled(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);
}

function filled(element, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (value === true) element.setAttribute(key, "");
    else if (value !== false && value != null) element.setAttribute(key, value);
  }
  element.append(...children.filter((child) => child != null));
  return element;
}

export const $ = (id) => document.getElementById(id);

/// The page's colours of the moment.
export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export const reducedMotion = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

/// Says it to screen readers.
export function announce(text) {
  $("live").textContent = text;
}

/// Puts text on the clipboard; where the browser refuses, by way of a selection.
export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const area = el("textarea", { class: "hidden", "aria-hidden": "true" });
    const before = document.activeElement;
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    before?.focus();
    return done;
  }
}

/// A button that copies what `text()` gives, and says so.
export function copyButton(label, text) {
  const button = el("button", { type: "button", class: "copy" }, label);
  button.addEventListener("click", async () => {
    const done = await copy(text());
    button.textContent = done ? "Copied" : "Copying failed";
    announce(done ? "Copied to the clipboard." : "The browser did not allow copying.");
    setTimeout(() => (button.textContent = label), 1600);
  });
  return button;
}

/// Gives a <select> its entries, [value, label] each.
export function options(select, entries, chosen) {
  select.replaceChildren(...entries.map(([value, label]) => el("option", { value }, label)));
  select.value = chosen;
}
