
/* ---- the code that runs, and which of its lines make the method ---- */

/* A function of a file, with the comment before it. */
function functionText(file, name) {
  const lines = source[file].split("\n");
  const start = lines.findIndex((line) => new RegExp(`^[a-z]\\w* ${name}\\(`).test(line));
  if (start < 0) throw new Error(`${file}.glsl has no ${name}`);
  let end = start, first = start;
  if (!lines[start].endsWith("}")) while (lines[end] !== "}") end++;
  if (lines[start - 1].endsWith("*/")) do first--; while (!lines[first].startsWith("/*"));
  return lines.slice(first, end + 1);
}

function functionElement(file, name, on) {
  const [title, where, pre] = ["h3", "small", "pre"].map((kind) => document.createElement(kind));
  where.textContent = file === "bumpshadow" ? " include/bumpshadow.glsl" : ` docs/live/parts/${file}.glsl`;
  title.append(name, where);
  let comment = false, marked = 0;
  for (const line of functionText(file, name)) {
    const span = document.createElement("span");
    span.textContent = line || " ";
    comment ||= line.startsWith("/*");
    if (on.some((text) => text && line.includes(text))) {
      span.className = "on";
      marked++;
    } else if (comment || line.startsWith("#"))
      span.className = "quiet";
    if (line.endsWith("*/")) comment = false;
    pre.append(span);
  }
  return { elements: [title, pre], marked };
}

/* [file, function, lines to point at] of a method, the formulas first. */
function functionsOf(method, s) {
  const { formula, around, branch, on } = METHODS[method], bumpshadow = (name) => ["bumpshadow", name, on];
  if (method === "displaced")
    return [["displaced", "displaced_hit", ["float gap = gap_at", "if (gap < -air"]],
      ["displaced", "gap_at", ["return p.z"]], ["trace", "shadow_light", ["displaced_hit(to, 1.0, true)"]]];
  const out = formula.map(bumpshadow);
  out.push(["tau", "tau_find", [branch]]);
  out.push(["trace", "trace", ["g.t0 = g.t + g.tau"]], ["trace", "shadow_light", ["aim(along(x, g.t0))"]]);
  if (s.shade) out.push(["trace", "place_find", ["g.t_shade =", "shape_at("]]);
  if (s.own) out.push(["own_shadow", "bumps_shadow", ["bs_way_below("]]);
  return [...out, ...around.map(bumpshadow)];
}

let shownCode = "";

function showCode(side) {
  const method = state[side], key = [method, state.shade, state.own].join(), to = $("code-text");
  if (key === shownCode) return;
  shownCode = key;
  const shown = functionsOf(method, state).map(([file, name, on]) => functionElement(file, name, on));
  if (!shown.some(({ marked }) => marked)) throw new Error(`no line of ${method} is pointed at`);
  to.replaceChildren(...shown.flatMap(({ elements }) => elements));
  to.scrollTop = to.scrollLeft = 0;
}
