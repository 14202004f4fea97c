
/* ---- maps: height samples, packed by scripts/live.py ---- */

async function inflate(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/* The samples as floats: sums of differences, along columns and rows. */
async function readMap(name) {
  const { columns, rows, unit } = maps[name], n = columns * rows;
  const bytes = await inflate($("map-" + name).textContent.trim().split(",")[1]);
  const v = new Uint16Array(n), out = new Float32Array(n);
  for (let i = 0; i < n; i++) {
    const z = bytes[i] * 256 + bytes[n + i], d = z % 2 ? -(z + 1) / 2 : z / 2, x = i % columns;
    const left = x ? v[i - 1] : 0, above = i >= columns ? v[i - columns] : 0;
    v[i] = d + left + above - (x && i >= columns ? v[i - columns - 1] : 0);
    out[i] = v[i] * unit;
  }
  return { columns, rows, samples: out };
}
