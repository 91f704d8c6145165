// The numbers of a design for other programs: as JSON and as a table.

// {name, subject, revision, design: {parameter: value}, metrics: {name: {value, error, unit}}}, in SI
// units, of a choice its name; metrics null where the map has no values.
export function designAsJson(map, space, values, answer) {
  const design = {};
  space.parameters.forEach((p, i) => { design[p.name] = p.choices[values[i]] ?? values[i]; });
  for (const { name, value } of map.fixed) design[name] = value;
  const metrics = {};
  map.metrics.forEach((metric, m) => {
    metrics[metric.name] = answer && { value: answer.values[m], error: answer.errors[m], unit: metric.unit };
  });
  return JSON.stringify({ map: map.name, subject: map.subject, revision: map.revision, design, metrics },
    null, 2);
}

function csvCell(text) {
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

// A head line and one of numbers: parameters under their names, then each metric and its error with
// their unit, which `mortise map evaluate --file` passes over.
export function designAsCsv(map, space, values, answer) {
  const cells = space.parameters.map((p, i) => [p.name, p.choices[values[i]] ?? String(values[i])]);
  map.metrics.forEach((metric, m) => {
    cells.push([`${metric.name} [${metric.unit}]`, answer ? String(answer.values[m]) : ""]);
    cells.push([`${metric.name} error [${metric.unit}]`, answer ? String(answer.errors[m]) : ""]);
  });
  return [0, 1].map((row) => cells.map((cell) => csvCell(cell[row])).join(",") + "\r\n").join("");
}

export function download(name, type, text) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// Copies a text; pages that are opened as files may lack the clipboard of others.
export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}
