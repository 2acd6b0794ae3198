"use strict";

const all = (selector, within = document) => Array.from(within.querySelectorAll(selector));
const said = document.getElementById("said");  // read out by a screen reader

// Dark or light: as the system has it, until the button says otherwise.
const root = document.documentElement;
const theme = document.getElementById("theme");
const remembered = {
  read: () => { try { return localStorage.getItem("raypool-theme"); } catch { return null; } },  // may be forbidden
  write: value => { try { localStorage.setItem("raypool-theme", value); } catch { /* then for this page alone */ } },
};
const systemIsDark = matchMedia("(prefers-color-scheme: dark)");
const isDark = () => root.dataset.theme ? root.dataset.theme === "dark" : systemIsDark.matches;
const showTheme = () => {
  theme.textContent = isDark() ? "Light" : "Dark";
  theme.setAttribute("aria-pressed", String(isDark()));
};
if (["dark", "light"].includes(remembered.read())) root.dataset.theme = remembered.read();
theme.addEventListener("click", () => {
  root.dataset.theme = isDark() ? "light" : "dark";
  remembered.write(root.dataset.theme);
  showTheme();
});
systemIsDark.addEventListener("change", showTheme);
showTheme();

// Points of a picture: by mouse the nearest, by keyboard one after the other.
const tip = document.getElementById("tip");
let shown = null;
function hide() {
  if (shown) shown.classList.remove("shown");
  shown = null;
  tip.hidden = true;
}
function show(point) {
  if (shown !== point) hide();
  shown = point;
  point.classList.add("shown");
  tip.textContent = point.getAttribute("aria-label");
  tip.hidden = false;
  const at = point.getBoundingClientRect(), own = tip.getBoundingClientRect();
  const left = Math.min(at.right + 8, innerWidth - own.width - 8);
  const above = at.top - own.height - 8;
  tip.style.left = `${Math.max(8, left)}px`;
  tip.style.top = `${above > 0 ? above : Math.min(at.bottom + 8, innerHeight - own.height - 8)}px`;
}
const REACH = 24;  // CSS pixels: how far the mouse may be from a point
function nearest(points, event) {
  if (event.target.classList.contains("point")) return event.target;
  let best = null, least = REACH;
  for (const point of points) {
    if (point.tagName !== "circle") continue;  // bars answer where they are
    const box = point.getBoundingClientRect();
    const distance = Math.hypot(box.x + box.width / 2 - event.clientX, box.y + box.height / 2 - event.clientY);
    if (distance < least) [best, least] = [point, distance];
  }
  return best;
}
for (const svg of all("svg")) {
  const points = all(".point", svg);
  if (!points.length) continue;
  points[0].tabIndex = 0;  // one stop of the tab key for each picture
  svg.addEventListener("pointermove", event => {
    const point = nearest(points, event);
    if (point) show(point); else hide();
  });
  svg.addEventListener("pointerleave", hide);
  svg.addEventListener("focusin", event => { if (event.target.classList.contains("point")) show(event.target); });
  svg.addEventListener("focusout", hide);
  svg.addEventListener("keydown", event => {
    const at = points.indexOf(event.target);
    if (event.key === "Escape") hide();
    const to = {ArrowRight: at + 1, ArrowDown: at + 1, ArrowLeft: at - 1, ArrowUp: at - 1, Home: 0, End: points.length - 1}[event.key];
    if (at < 0 || to === undefined || to < 0 || to >= points.length) return;
    event.preventDefault();
    points[at].tabIndex = -1;
    points[to].tabIndex = 0;
    points[to].focus();
  });
}
addEventListener("scroll", () => { if (shown && shown !== document.activeElement) hide(); else if (shown) show(shown); }, true);

// Tables. Numbers before words, and cells that hold nothing last, whichever way they are sorted.
const words = new Intl.Collator("en", {numeric: true});
function compare(a, b, sign) {
  const rank = value => value === null || value === "" ? 2 : typeof value === "number" ? 0 : 1;
  if (rank(a) !== rank(b)) return rank(a) - rank(b);
  return sign * (typeof a === "number" ? a - b : words.compare(a, b));
}
function sorted(lines, column, sign) {
  return lines.map((line, i) => [line, i])
    .sort(([a, i], [b, j]) => compare(a.keys[column], b.keys[column], sign) || i - j)
    .map(([line]) => line);
}
function has(line, asked) {
  return asked.every(word => line.text.includes(word));
}
const PART = 100;  // of the rows that are made at a time

/** `lines` have keys to sort by, a text to search, and make() for their row of the table. */
function serve(sheet, lines, part = Infinity, more = null) {
  const body = sheet.querySelector("tbody"), input = sheet.querySelector("input"), output = sheet.querySelector("output");
  const heads = all("th", sheet);
  let order = lines, count = part;
  const fill = () => {
    const asked = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = order.filter(line => has(line, asked));
    body.replaceChildren(...found.slice(0, count).map(line => line.make()));
    const made = Math.min(count, found.length);
    output.value = `${found.length} of ${lines.length} rows${made < found.length ? `, ${made} shown` : ""}`;
    if (more) more.hidden = made === found.length;
  };
  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
    const isRising = head.getAttribute("aria-sort") !== "ascending";
    heads.forEach(other => other.setAttribute("aria-sort", "none"));
    head.setAttribute("aria-sort", isRising ? "ascending" : "descending");
    order = sorted(lines, column, isRising ? 1 : -1);
    fill();
    said.textContent = `sorted by ${head.textContent.trim()}, ${isRising ? "rising" : "falling"}`;
  }));
  input.addEventListener("input", () => { count = part; fill(); });
  if (more) more.addEventListener("click", () => { count += 5 * part; fill(); });
  fill();
}

const keyOf = cell => cell.dataset.number === undefined ? cell.textContent.trim() : Number(cell.dataset.number);
for (const sheet of all(".sheet")) {
  if (sheet.closest(".rows")) continue;
  serve(sheet, all("tbody tr", sheet).map(row => ({
    keys: Array.from(row.cells, keyOf), text: row.textContent.toLowerCase(), make: () => row,
  })));
}
for (const rows of all(".rows")) {
  const cells = JSON.parse(rows.querySelector("script").textContent);
  serve(rows, cells.map(keys => ({
    keys, text: keys.join("\n").toLowerCase(),
    make: () => {
      const row = document.createElement("tr");
      for (const key of keys) {
        const cell = row.insertCell();
        cell.textContent = key === null ? "" : String(key);
        if (typeof key === "number") cell.className = "number";
      }
      return row;
    },
  })), PART, rows.querySelector(".more"));
}

for (const button of all(".copy")) {
  button.addEventListener("click", async () => {
    const code = button.parentElement.querySelector("code");
    try {
      await navigator.clipboard.writeText(code.textContent);
      button.textContent = said.textContent = "Copied";
    } catch {  // forbidden: selected, it takes one key more
      getSelection().selectAllChildren(code);
      button.textContent = said.textContent = "Selected";
    }
  });
}

// On paper all is open.
addEventListener("beforeprint", () => all("details").forEach(details => { details.open = true; }));
