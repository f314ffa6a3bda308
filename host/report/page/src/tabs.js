// Tabs after the pattern of the ARIA guide: arrows, Home and End move between them; a panel is filled when first shown.
import { $, el } from "./dom.js";

/// `tabs`: {id, label, fill(panel)}. Returns {refresh(id)}, which fills a panel again.
export function makeTabs(tabs) {
  const filled = new Set();
  const buttons = tabs.map((tab, i) => {
    const button = el(
      "button",
      { type: "button", role: "tab", id: `tab-${tab.id}`, "aria-controls": `panel-${tab.id}` },
      tab.label,
    );
    button.addEventListener("click", () => show(i));
    button.addEventListener("keydown", (event) => {
      const to = { ArrowRight: i + 1, ArrowLeft: i - 1, Home: 0, End: tabs.length - 1 }[event.key];
      if (to === undefined) return;
      event.preventDefault();
      const next = (to + tabs.length) % tabs.length;
      show(next);
      buttons[next].focus();
    });
    return button;
  });
  const panels = tabs.map((tab) =>
    el("div", { role: "tabpanel", id: `panel-${tab.id}`, "aria-labelledby": `tab-${tab.id}`, tabindex: "0", hidden: true }),
  );
  const fill = (i) => {
    panels[i].replaceChildren();
    tabs[i].fill(panels[i]);
    filled.add(i);
  };
  let current = 0;
  const show = (i) => {
    current = i;
    buttons.forEach((button, k) => {
      button.setAttribute("aria-selected", String(k === i));
      button.tabIndex = k === i ? 0 : -1;
      panels[k].hidden = k !== i;
    });
    if (!filled.has(i)) fill(i);
  };
  $("tabs").append(...buttons);
  $("tab-panels").append(...panels);
  show(0);
  return {
    refresh(id) {
      const i = tabs.findIndex((tab) => tab.id === id);
      filled.delete(i);
      if (i === current) fill(i);
    },
  };
}
