// Why a map has no values, or no shapes, in parts of its space, for people.

const NO_SHAPE = "shapes could not be brought into one mesh";

// Whether its parts without shapes have no metrics either, as of maps that earlier versions built.
function lacksMetricsWithoutShapes(map) {
  return map.unmapped > 0 && map.shapeless === 0;
}

// What came about where it has no values, as the end of "where …".
export function causesOf(map) {
  const causes = [];
  const isOfShapes = lacksMetricsWithoutShapes(map);
  if (map.failures.length > 0 || !isOfShapes) causes.push("evaluations failed");
  if (isOfShapes) causes.push(NO_SHAPE);
  return causes.join(" or ");
}

// What is known of why designs are in no mesh: {count, message} each.
function reasonsOfShapes(map) {
  if (map.unmappedFailures.length > 0) return map.unmappedFailures;
  return [{ count: map.unmapped, message: "in none of the meshes around" }];
}

// What is known of why there are no values: {count, message} each.
export function reasonsOf(map) {
  return lacksMetricsWithoutShapes(map) ? [...map.failures, ...reasonsOfShapes(map)] : map.failures;
}

// What is told of a design that has no values.
export function whyNoValues(map) {
  const [reason] = reasonsOf(map);
  return `Around this design ${causesOf(map)}${reason ? `, as: ${reason.message}` : "."}`;
}

// What is told of a design that has metrics and no shape.
export function whyNoShape(map) {
  return `Around this design ${NO_SHAPE}, as: ${reasonsOfShapes(map)[0].message}. The metrics are valid.`;
}

// What is told of all such parts of the space, a line each.
export function notesOnShapes(map) {
  if (map.shapeless === 0) return [];
  return [`No shape in ${map.shapeless} of ${map.elements} parts of the space, where ${NO_SHAPE}; ` +
    "metrics are valid there:", ...reasonsOfShapes(map).map(({ count, message }) => `${count} × ${message}`)];
}
